"""LIGGGHTS 3.8: spheres and plane walls; its threads are MPI ranks, which halve the box along x.

Its input is as its manual recommends: granular pairs with tangential history, primitive walls, a
neighbour skin with checked rebuilds, no output within the loop. Its dashpot is per effective mass;
walls are a type of their own, so that it is ours. Time is its own "Loop time" of the last ``run``;
CPU time is the process's, by the share of that run's steps.
"""

from __future__ import annotations

import re
import resource
from typing import TYPE_CHECKING

from speed.packings import run
from speed.peers import Peer, Run, Timing, without

if TYPE_CHECKING:
    from speed.problem import Problem, Wall

SKIN = 0.15
"""Neighbour skin over the diameter."""
LOOP = re.compile(r"Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms")
MODEL = "model hooke/stiffness tangential history"
SETTINGS = "limitForce on tangential_damping off"


def data(problem: Problem) -> str:
    """The bodies, as a data file."""
    radius = problem.solid.rounding
    low = problem.position.min(axis=0) - 1.5 * radius
    high = problem.position.max(axis=0) + 1.5 * radius
    sides = zip(low.tolist(), high.tolist(), "xyz", strict=True)
    bounds = "\n".join(f"{a!r} {b!r} {axis}lo {axis}hi" for a, b, axis in sides)
    kind = f"1 {2.0 * radius!r} {problem.density!r}"
    rows = enumerate(problem.position.tolist(), 1)
    atoms = "\n".join(f"{i} {kind} {x!r} {y!r} {z!r}" for i, (x, y, z) in rows)
    return f"start\n\n{problem.count} atoms\n2 atom types\n{bounds}\n\nAtoms\n\n{atoms}\n"


def text(problem: Problem, warm: int, steps: int) -> str:
    """Input of a run that reads ``start.data`` beside it."""
    return "\n".join(
        [
            "atom_style granular\natom_modify map array\nboundary m m m\nnewton off",
            "communicate single vel yes\nunits si\nprocessors * 1 1\nread_data start.data",
            f"neighbor {SKIN * 2.0 * problem.solid.rounding!r} bin",
            "neigh_modify delay 0 every 1 check yes",
            *_law(problem),
            f"pair_style gran {MODEL} {SETTINGS}\npair_coeff * *",
            f"timestep {problem.dt!r}",
            f"fix weight all gravity {-problem.gravity[2]!r} vector 0 0 -1",
            *(f"fix wall{i} all {_wall(wall)}" for i, wall in enumerate(problem.walls)),
            "fix move all nve/sphere\ncompute of_each all contact/atom",
            "compute touching all reduce sum c_of_each",
            "thermo_style custom step atoms ke c_touching\nthermo 1000000000",
            f"thermo_modify norm no lost error\nrun {warm}\nrun {steps}\n",
        ]
    )


def _law(problem: Problem) -> list[str]:
    pair = problem.dashpot(wall=False) / (0.5 * problem.mass)
    wall = problem.dashpot(wall=True) / problem.mass
    values = {
        "kn": [problem.law.kn] * 4,
        "kt": [problem.law.kt] * 4,
        "gamman": [pair, wall, wall, wall],
        "gammat": [0.0] * 4,
        "coefficientFriction": [problem.law.mu] * 4,
    }
    return [
        f"fix {name} all property/global {name} peratomtypepair 2 {' '.join(map(repr, each))}"
        for name, each in values.items()
    ]


def _wall(wall: Wall) -> str:
    axis = next(k for k in range(3) if wall.normal[k])
    return f"wall/gran {MODEL} primitive type 2 {'xyz'[axis]}plane {wall.point[axis]!r} {SETTINGS}"


def timed(asked: Run) -> Timing:
    """One run."""
    (asked.folder / "start.data").write_text(data(asked.problem), encoding="utf-8")
    words = text(asked.problem, asked.warm, asked.steps)
    (asked.folder / "in.txt").write_text(words, encoding="utf-8")
    command = ["liggghts", "-in", "in.txt", "-log", "none"]
    if asked.threads > 1:
        ranks = ["-np", str(asked.threads), "--oversubscribe", "--allow-run-as-root"]
        command = ["mpirun", *ranks, *command]
    before = _children()
    said = run(command, cwd=asked.folder)
    return _read(said, (_children() - before) * asked.steps / (asked.warm + asked.steps))


def _children() -> float:
    """CPU time of all processes that were started and have ended [s]."""
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    return spent.ru_utime + spent.ru_stime


def _read(said: str, cpu: float) -> Timing:
    wall, steps, bodies = LOOP.findall(said)[-1]
    row = said[: said.rindex("Loop time")].strip().splitlines()[-1].split()
    facts = {"pair_contacts": round(float(row[3]) / 2.0), "kinetic": float(row[2])}
    facts["rebuilds"] = int(re.findall(r"Neighbor list builds = (\d+)", said)[-1])
    return Timing(float(wall), int(steps), int(bodies), cpu, facts)


LIGGGHTS = Peer("LIGGGHTS", "apt-get install liggghts", lambda: without("liggghts"), timed)
