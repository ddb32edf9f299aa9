"""A process of warpdem in one precision: prepares runs, and times them when it is told.

    python worker.py PRECISION

Reads lines of JSON: {"do": "prepare", "case", "run", "steps"} answers with what was measured at the
end of a first run, null where it failed; {"do": "time", "number"} with the seconds of another run
of the so many-th prepared; {"do": "forget"} drops all.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

BENCH = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(BENCH.parents[1]), str(BENCH)]
if __name__ == "__main__" and find_spec("warpdem.precision"):
    # a process has one, bound before its kernels are imported
    import_module("warpdem.precision").bind(sys.argv[1])

import numpy as np  # noqa: E402 - found through the path above

from precision_cases import CASES  # noqa: E402
from warpdem.errors import WarpdemError  # noqa: E402
from warpdem.input.scene import Scene  # noqa: E402
from warpdem.simulation import Simulation  # noqa: E402

if TYPE_CHECKING:
    from precision_cases.case import Case

WARM = 3
"""Steps before the clock starts: the loop is recorded in them."""


class SceneRun:
    """A scene that can be run again and again from its start."""

    def __init__(self, case: Case, run: dict[str, Any], steps: int) -> None:
        assert case.scene is not None
        assert case.measured is not None
        self._until = case.until
        dt = case.until / steps
        scene, clock = case.scene(), {"duration": 2.0 * case.until, "dt": dt}
        scene = {**scene, "run": {**scene.get("run", {}), **clock, **run}}
        self._simulation = Simulation(Scene.model_validate(scene), device="cpu", threads=1)
        self._start = self._simulation.checkpoint()
        self._simulation.advance(case.until)
        self.values = case.measured(self._simulation.snapshot())

    def again(self) -> float:
        """Seconds of another run."""
        simulation = self._simulation
        simulation.restore(self._start)
        simulation.advance(WARM * simulation.dt)
        begin, first = time.process_time(), simulation.step_count
        simulation.advance(self._until)
        spent = time.process_time() - begin
        return spent * simulation.step_count / (simulation.step_count - first)


def prepared(case: Case, run: dict[str, Any], steps: int) -> Any:
    """A run that has been through once; None where it failed."""
    special = case.hard if run.get("method") == "nonsmooth" else case.prepared
    try:
        made = special(run, steps) if special else SceneRun(case, run, steps)
    except WarpdemError as error:
        print(f"{case.name} {run} {steps}: {error}", file=sys.stderr)
        return None
    return made if np.isfinite(made.values).all() else None


def main() -> None:
    answers, sys.stdout = sys.stdout, sys.stderr
    runs: list[Any] = []
    for line in sys.stdin:
        asked = json.loads(line)
        answer: Any = None
        if asked["do"] == "prepare":
            made = prepared(CASES[asked["case"]], asked["run"], asked["steps"])
            runs.append(made)
            answer = made and np.asarray(made.values).tolist()
        elif asked["do"] == "time":
            answer = runs[asked["number"]].again()
        else:
            runs.clear()
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
