"""Known answers of rockfall: errors at a ladder of fixed steps, their order, and their gates.

    python tools/bench/rockfall_answers.py [FOLDER] [--family NAME ...]

FOLDER holds the JSON files of ../shared/reference/analytic (default, where it is); without it the
families that need none are shown. A gate without a step is met by some step of the ladder, and the
column "from" says by which; with one it is that step's. Exits with 1 where one fails.

Impacts make the scheme one of order 1: contacts are those closed in the middle of a step, so each
impact comes up to half a step too late or too early, and the speed then misses g dt / 2. Sliding,
rolling and free turning are of order 2.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "rockfall"), str(Path(__file__).parent)]

from rockfall_truths import FAMILIES  # noqa: E402 - found through the path above

if TYPE_CHECKING:
    from rockfall_truths import Answer

DEFAULT = ROOT.parent / "shared" / "reference" / "analytic"


def line(answer: Answer) -> str:
    errors = "  ".join(f"{dt:.2g}: {error:.1e}" for dt, error in answer.errors.items())
    order = "" if answer.order != answer.order else f"{answer.order:5.2f}"
    gate = verdict = ""
    if answer.gate is not None:
        gate = f"{answer.gate:.1e}" + (f" at {answer.at:.2g}" if answer.at else "")
        verdict = "PASS" if answer.passed else "FAIL"
        if answer.passed and not answer.at:
            verdict += f" from {answer.met:.2g}"
    return (
        f"{answer.case:25} {answer.quantity:36} {errors:72} {order:5}  {gate:16} {verdict:15} "
        f"{answer.note}"
    ).rstrip()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    there = DEFAULT if DEFAULT.is_dir() else None
    parser.add_argument("folder", nargs="?", type=Path, default=there)
    parser.add_argument("--family", nargs="*", choices=FAMILIES, default=list(FAMILIES))
    options = parser.parse_args()
    print(f"{'case':25} {'quantity':36} {'error by dt [s]':72} {'order':5}  {'gate':16}")
    failed = 0
    for family in options.family:
        since = time.perf_counter()
        for answer in FAMILIES[family](options.folder):
            failed += not answer.passed
            print(line(answer), flush=True)
        print(f"# {family}: {time.perf_counter() - since:.1f} s", flush=True)
    print(f"{failed} FAIL")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
