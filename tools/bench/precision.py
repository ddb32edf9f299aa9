"""Run time against error: what accuracy costs, by case and setting, beside other programs.

    python tools/bench/precision.py [CASE ...] [--quick] [--proof] [--plots DIR] [--json FILE]
                                    [--peers] [--peers-python PYTHON]

Each case is run with a ladder of steps in every setting that applies; the error is that of the
state at its end, against a closed form or a far finer run. Seconds are CPU time of the loop alone
(LIGGGHTS: its own clock), one thread, warm, the best of three that take turns; many copies share a
scene, so that they are physics and not launches. The table tells the order, and seconds and steps
at an error of 1e-3 and 1e-6; the plots have run time on x and error on y. --quick: the first four
steps of each ladder, once. --peers: other programs too, where installed; PYTHON has mujoco,
pybullet, KratosDEMApplication. --proof prints what is to be met; exit status 1 if something is not.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from precision_cases import CASES
from precision_cases.measuring import Workers, measured
from precision_cases.peers import programs
from precision_cases.proof import proofs
from precision_cases.report import HEAD, draw, row

QUICK = 4
"""Rungs of a ladder that --quick runs."""


def asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="*", help=f"of {', '.join(CASES)}; default: all")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--proof", action="store_true")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--peers", action="store_true")
    parser.add_argument("--peers-python")
    parser.add_argument("--plots", type=Path)
    parser.add_argument("--json", type=Path)
    found = parser.parse_args()
    if unknown := {*found.case} - {*CASES}:
        parser.error(f"no case {', '.join(unknown)}; there are: {', '.join(CASES)}")
    return found


def main() -> int:
    options = asked()
    curves = []
    how = {"rungs": QUICK, "repeats": 1} if options.quick else {"rungs": None}
    how = {"repeats": options.repeats} | how
    others = []
    if options.peers or options.peers_python:
        for program in programs(options.peers_python or sys.executable).values():
            if why := program.missing():
                print(f"# without {program.name}: {why}")
            else:
                others.append(program)
    print(HEAD)
    with Workers() as workers:
        for name in options.case or CASES:
            begin = time.perf_counter()
            case = CASES[name]
            found = measured(case, workers, others, **how)
            curves += found
            print("\n".join(row(curve) for curve in found))
            print(f"# {name}: {case.what}; {time.perf_counter() - begin:.0f} s", flush=True)
            if options.plots:
                options.plots.mkdir(parents=True, exist_ok=True)
                draw(case, found, options.plots / f"{name}.png")
            if options.json:
                text = json.dumps([curve.as_dict() for curve in curves], indent=1)
                options.json.write_text(text + "\n", encoding="utf-8")
    lines = list(proofs(curves)) if options.proof else []
    print("\n".join(str(line) for line in lines))
    return 0 if all(line.passes for line in lines) else 1


if __name__ == "__main__":
    sys.exit(main())
