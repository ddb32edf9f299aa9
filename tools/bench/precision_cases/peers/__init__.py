"""Other programs in the same diagrams: balls or blocks over a plane, a ladder of steps.

Each reads a problem and writes rows of steps, seconds of its loop, and the state at the end.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from precision_cases.peers import liggghts

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

HERE = Path(__file__).parent
LONGEST = 120.0
"""Seconds after which a ladder is given up."""


@dataclass(frozen=True)
class Program:
    """One of them.

    Attributes:
        name: In tables.
        hard: Its contacts are rigid: what it should give is that of hard contacts.
        springs: All the same its balls need steps as short as those of springs.
        missing: Why it cannot run; None if it can.
        rows: Runs a problem at each number of steps.
        note: What differs from the case.
    """

    name: str
    hard: bool
    springs: bool
    missing: Callable[[], str | None]
    rows: Callable[[dict[str, Any], Sequence[int]], list[dict[str, Any]]]
    note: str


def _by(command: Sequence[str], problem: dict[str, Any], steps: Sequence[int]) -> list[Any]:
    """Rows of a script that reads a file and prints a line of JSON."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "problem.json"
        file.write_text(json.dumps(problem | {"steps": list(steps)}), encoding="utf-8")
        ran = subprocess.run(
            [*command, str(file)],
            capture_output=True,
            text=True,
            check=False,
            timeout=LONGEST,
            cwd=folder,
        )
    lines = [line for line in ran.stdout.splitlines() if line.startswith("[")]
    if not lines:
        raise RuntimeError(f"{command[0]} gave nothing: {ran.stderr[-500:]}")
    return json.loads(lines[-1])


def _without(program: str) -> str | None:
    return None if shutil.which(program) else f"no command {program}"


def _cannot_import(python: str, module: str) -> str | None:
    try:
        ran = subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False)
    except OSError:
        return f"no Python {python}"
    return f"{python} has no module {module}" if ran.returncode else None


def programs(python: str = sys.executable) -> dict[str, Program]:
    """All of them; ``python`` has those that are modules."""
    yade = ["yade", "-j1", "-x", "-n", str(HERE / "yade_balls.py")]
    lammps_like = partial(_without, "liggghts")
    found = [
        Program("YADE", False, True, partial(_without, "yade"), partial(_by, yade), "balls"),
        Program("LIGGGHTS", False, True, lammps_like, liggghts.rows, "balls"),
    ]
    kratos = [python, str(HERE / "kratos_balls.py")]
    missing = partial(_cannot_import, python, "KratosMultiphysics.DEMApplication")
    found.append(Program("Kratos", False, True, missing, partial(_by, kratos), "balls"))
    for name, module, springs in (("MuJoCo", "mujoco", True), ("PyBullet", "pybullet", False)):
        command = [python, str(HERE / f"{module}_bodies.py")]
        missing = partial(_cannot_import, python, module)
        found.append(Program(name, True, springs, missing, partial(_by, command), "hard contact"))
    return {program.name: program for program in found}
