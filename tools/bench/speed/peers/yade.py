"""YADE (Debian): spheres by its viscoelastic law or polyhedra by overlap volume; OpenMP threads."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path

from speed.packings import run
from speed.peers import Peer, Run, Timing, without

SCRIPTS = Path(__file__).parent


def timed(asked: Run, script: str) -> Timing:
    """One run of a script in YADE's own Python."""
    file = asked.folder / "problem.json"
    asked.problem.write(file, warm=asked.warm, steps=asked.steps)
    command = ["yade", f"-j{asked.threads}", "-x", "-n", str(SCRIPTS / script), str(file)]
    said = run(command, cwd=asked.folder)
    row = json.loads(next(line for line in said.splitlines() if line.startswith("{")))
    return Timing(row.pop("wall"), row.pop("steps"), row.pop("bodies"), row.pop("cpu"), row)


YADE = Peer(
    "YADE",
    "apt-get install yade",
    lambda: without("yade"),
    partial(timed, script="yade_spheres.py"),
)
