"""YADE (Debian): spheres by its viscoelastic law, polyhedra by overlap volume; OpenMP threads."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from speed.packings import run
from speed.peers import Peer, Run, Timing, without
from speed.peers.engines import timing_of


def timed(asked: Run, script: str) -> Timing:
    """One run of a script in YADE's own Python."""
    file = asked.folder / "problem.json"
    asked.problem.write(file, warm=asked.warm, steps=asked.steps)
    program = str(Path(__file__).with_name(script))
    return timing_of(
        run(["yade", f"-j{asked.threads}", "-x", "-n", program, str(file)], cwd=asked.folder)
    )


YADE, YADE_POLYHEDRA = (
    Peer(name, "apt-get install yade", partial(without, "yade"), partial(timed, script=script))
    for name, script in (("YADE", "yade_spheres.py"), ("YADE polyhedra", "yade_polyhedra.py"))
)
