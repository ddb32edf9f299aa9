"""Runs of all settings of a case: errors once, times in turn."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any

import numpy as np

from precision_cases.curves import Curve
from precision_cases.settings import SETTINGS

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import Self

    from precision_cases.case import Case
    from precision_cases.peers import Program
    from precision_cases.settings import Setting


RUNGS = 6
"""Of a ladder that other programs run."""
LONG = 4.0
"""Seconds of such a ladder beyond which it is run once."""


class Worker:
    """A process of warpdem that prepares and times runs; see worker."""

    def __init__(self, precision: str) -> None:
        command = [sys.executable, str(Path(__file__).with_name("worker.py")), precision]
        pipe, self._said = subprocess.PIPE, TemporaryFile()  # noqa: SIM115 - as long as the process
        self._process = subprocess.Popen(
            command, stdin=pipe, stdout=pipe, stderr=self._said, text=True
        )
        self._count = 0

    def prepare(self, case: str, run: dict[str, Any], steps: int) -> tuple[int, Any]:
        """Number of a new run, and what was measured at its end."""
        values = self._ask(do="prepare", case=case, run=run, steps=steps)
        self._count += 1
        return self._count - 1, values

    def time(self, number: int) -> float:
        """Seconds of one more run."""
        return self._ask(do="time", number=number)

    def forget(self) -> None:
        """Drop all runs."""
        self._ask(do="forget")
        self._count = 0

    def close(self) -> None:
        """End the process."""
        self._process.communicate(timeout=60)
        self._said.close()

    def _ask(self, **words: Any) -> Any:
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(json.dumps(words) + "\n")
        process.stdin.flush()
        if not (line := process.stdout.readline()):
            self._said.seek(0)
            last = self._said.read()[-1000:].decode(errors="replace")
            status = process.wait(timeout=60)
            raise RuntimeError(f"the worker ended with {status} on {words}\n{last}")
        return json.loads(line)


class Workers:
    """One process a precision."""

    def __init__(self) -> None:
        self._each: dict[str, Worker] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._each.values():
            worker.close()

    def of(self, precision: str) -> Worker:
        """The process for a precision."""
        if precision not in self._each:
            self._each[precision] = Worker(precision)
        return self._each[precision]

    def forget(self) -> None:
        """Drop all runs."""
        for worker in self._each.values():
            worker.forget()


def applicable(case: Case) -> list[Setting]:
    """Settings of a case that this version has."""
    return [SETTINGS[name] for name in case.settings if SETTINGS[name].known]


def truths(
    case: Case, settings: Sequence[Setting], worker: Worker, rungs: int | None
) -> dict[str, Any]:
    """What should be measured, by law; finer runs are so by the last of the rungs."""
    found: dict[str, Any] = {}
    for setting in settings:
        if setting.law in found:
            continue
        if setting.law == "hard":
            assert case.rigid is not None
            found[setting.law] = case.rigid()
        elif case.exact:
            found[setting.law] = case.exact(setting.law)
        else:
            steps = case.steps[:rungs][-1] * case.finer
            found[setting.law] = worker.prepare(case.name, setting.truth, steps)[1]
    return found


class Others:
    """Other programs that run a case.

    Args:
        case: Which.
        programs: Those that are installed.
        rungs: Of the ladder, from the coarsest.
        truth: What the law of the case should give; they may have hard contacts instead.
    """

    def __init__(
        self, case: Case, programs: Sequence[Program], rungs: int | None, truth: Any
    ) -> None:
        self._case, self._truth = case, truth
        self._smooth = case.problem is not None and case.problem()["mu"] == 0.0
        self._programs = [one for one in programs if one.name in case.programs]
        self._ladder = {one.name: self._steps(one)[: rungs or RUNGS] for one in self._programs}
        self._error: dict[str, list[float]] = {}
        self._seconds: dict[str, list[float]] = {}
        self._failed: dict[str, str] = {}

    def _steps(self, one: Program) -> tuple[int, ...]:
        """Those of hard contacts for programs that have such."""
        case = self._case
        assert case.problem is not None
        springs = one.springs and (not one.hard or "block" not in case.problem())
        return case.ladder("own" if springs or not case.hard_steps else "hard")

    def go(self) -> None:
        """Run all of them once more."""
        for one in self._programs:
            if one.name in self._failed or sum(self._seconds.get(one.name, [])) > LONG:
                continue
            assert self._case.problem is not None
            try:
                rows = one.rows(self._case.problem(), self._ladder[one.name])
            except (RuntimeError, OSError, subprocess.SubprocessError) as error:
                self._failed[one.name] = str(error)
                continue
            seconds = [row["seconds"] for row in rows]
            before = self._seconds.get(one.name, seconds)
            self._seconds[one.name] = [min(pair) for pair in zip(before, seconds, strict=True)]
            self._error[one.name] = [self._off(one, row) for row in rows]

    def _off(self, one: Program, row: dict[str, Any]) -> float:
        case = self._case
        assert case.seen is not None
        assert case.rigid is not None
        values = case.seen(*(np.array(row[key]) for key in ("velocity", "spin", "position")))
        # springs along the contact are what such programs lack
        elastic = not one.hard or (one.springs and self._smooth)
        return case.error(values, self._truth if elastic else case.rigid())

    def curves(self) -> list[Curve]:
        """Of those that ran."""
        return [
            Curve(
                self._case.name,
                one.name,
                self._ladder[one.name],
                tuple(self._seconds[one.name]),
                tuple(self._error[one.name]),
                one.note,
            )
            for one in self._programs
            if one.name not in self._failed
        ]


def measured(
    case: Case,
    workers: Workers,
    programs: Sequence[Program] = (),
    *,
    rungs: int | None,
    repeats: int,
) -> list[Curve]:
    """Curves of all settings and programs; ``rungs``: of the ladder, from the coarsest.

    Every repeat goes through all settings in turn, every other one backwards.
    """
    settings = applicable(case)
    ladder = {setting.name: case.ladder(setting.law)[:rungs] for setting in settings}
    known = truths(case, settings, workers.of("float64"), rungs)
    errors: dict[tuple[str, int], float] = {}
    runs: dict[tuple[str, int], tuple[Worker, int]] = {}
    for setting in settings:
        worker = workers.of(setting.precision)
        for count in ladder[setting.name]:
            number, values = worker.prepare(case.name, setting.run, count)
            errors[setting.name, count] = case.error(values, known[setting.law])
            if values is not None:
                runs[setting.name, count] = worker, number
    seconds = dict.fromkeys(errors, float("inf"))
    others = Others(case, programs, rungs, known.get("own"))
    for turn in range(repeats):
        others.go()
        for key in list(runs)[:: -1 if turn % 2 else 1]:
            worker, number = runs[key]
            seconds[key] = min(seconds[key], worker.time(number))
    workers.forget()
    curves = [
        Curve(
            case.name,
            setting.name,
            ladder[setting.name],
            tuple(seconds[setting.name, count] for count in ladder[setting.name]),
            tuple(errors[setting.name, count] for count in ladder[setting.name]),
        )
        for setting in settings
    ]
    return [*curves, *others.curves()]
