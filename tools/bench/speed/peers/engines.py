"""MuJoCo and PyBullet (PyPI), run by a Python that has them; one thread."""

from __future__ import annotations

import json
import subprocess
from functools import partial
from pathlib import Path

from speed.packings import run
from speed.peers import Peer, Run, Timing


def timed(asked: Run, python: str, script: str) -> Timing:
    """One run of a script by that Python."""
    file = asked.folder / "problem.json"
    asked.problem.write(file, warm=asked.warm, steps=asked.steps)
    said = run([python, str(Path(__file__).with_name(script)), str(file)], cwd=asked.folder)
    return timing_of(said)


def timing_of(said: str) -> Timing:
    """From the line of JSON that a script prints among others."""
    row = json.loads(next(line for line in said.splitlines() if line.startswith("{")))
    return Timing(row.pop("wall"), row.pop("steps"), row.pop("bodies"), row.pop("cpu"), row)


def _missing(python: str, module: str) -> str | None:
    try:
        ran = subprocess.run([python, "-c", f"import {module}"], capture_output=True, check=False)
    except OSError:
        return f"no Python {python}"
    return f"{python} has no module {module}" if ran.returncode else None


def engines(python: str) -> tuple[Peer, Peer]:
    """Both, run by ``python``."""
    return tuple(
        Peer(
            name,
            f"pip install {module} and give --peers-python",
            partial(_missing, python, module),
            partial(timed, python=python, script=f"{module}_bodies.py"),
        )
        for name, module in (("MuJoCo", "mujoco"), ("PyBullet", "pybullet"))
    )
