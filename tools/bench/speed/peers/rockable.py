"""Rockable, where a path to its command is given: from the same start, by an input of its format.

It is in no package. Walls are thick boxes there, of the rounding of a cube or of a sphere. It says
no loop time: that is the difference of a run of all steps and one of the first ones.
"""

from __future__ import annotations

import shutil
import time
from functools import partial
from typing import TYPE_CHECKING

from speed.packings import run
from speed.peers import Peer, Run, Timing
from speed.scenes import TURNS

if TYPE_CHECKING:
    from speed.problem import Problem, Solid

SKIN = 0.1
"""Distance of its lists over the size of a body."""
STILL = "0 0 0 0 0 0"


def shapes(problem: Problem) -> str:
    """Library of the body and of the wall: a box ten times as wide as the packing."""
    solid = problem.solid
    wide = 10.0 * float(abs(problem.position).max() + solid.bound)
    wall = _box("wall", (wide, wide, solid.size), solid.rounding)
    if solid.kind == "cube":
        return _box("grain", (0.5 * solid.size,) * 3, solid.rounding) + wall
    return _ball(solid) + wall


def _ball(solid: Solid) -> str:
    moment = f"{0.4 * solid.rounding**2!r} " * 3
    head = _head("grain", (0.0, 0.0, 0.0), solid.rounding, solid.volume, moment)
    return f"{head}nv 1\n0 0 0\nne 0\nnf 0\n>\n"


def _box(name: str, half: tuple[float, ...], rounding: float) -> str:
    a, b, c = (edge - rounding for edge in half)
    corners = [(x, y, z) for z in (-c, c) for x, y in ((-a, -b), (a, -b), (a, b), (-a, b))]
    sides = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)]
    sides += [(k, k + 4) for k in range(4)]
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    x, y, z = (edge**2 for edge in half)
    volume = 8.0 * half[0] * half[1] * half[2]
    moment = f"{(y + z) / 3.0!r} {(x + z) / 3.0!r} {(x + y) / 3.0!r}"
    text = _head(name, half, rounding, volume, moment) + "nv 8\n"
    text += "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in corners) + "ne 12\n"
    text += "".join(f"{i} {j}\n" for i, j in sides) + "nf 6\n"
    return text + "".join(f"4 {' '.join(map(str, face))}\n" for face in faces) + ">\n"


def _head(name: str, half: tuple[float, ...], rounding: float, volume: float, moment: str) -> str:
    extent = " ".join(repr(max(edge, rounding)) for edge in half)
    return (
        f"<\nname {name}\nradius {rounding!r}\npreCompDone y\nvolume {volume!r}\n"
        f"I/m {moment}\nobb.extent {extent}\nobb.e1 1 0 0\nobb.e2 0 1 0\nobb.e3 0 0 1\n"
        "obb.center 0 0 0\n"
    )


def conf(problem: Problem, steps: int) -> str:
    """Its input file of so many steps."""
    law, skin = problem.law, SKIN * problem.solid.size
    pairs = [(0, 0), (0, 1)]
    values = {"kn": law.kn, "en2": law.en2, "kt": law.kt, "mu": law.mu, "kr": 0.0, "mur": 0.0}
    laws = [f"{name}Contact {i} {j} {value!r}" for name, value in values.items() for i, j in pairs]
    weight = " ".join(map(repr, problem.gravity))
    walls = [_wall(problem, k) for k in range(len(problem.walls))]
    grains = zip(problem.position.tolist(), problem.orientation.tolist(), strict=True)
    bodies = [f"grain 0 0 1 {_row(p)} {STILL} {_row(q)} {STILL}" for p, q in grains]
    lines = [
        f"Rockable 21-08-2022\nt 0\ntmax {steps * problem.dt!r}\ndt {problem.dt!r}",
        f"interVerlet {50 * problem.dt!r}\ninterConf {1e3 * steps * problem.dt!r}",
        f"DVerlet {2.0 * skin!r}\ndVerlet {skin!r}\ndensity 0 {problem.density!r}",
        f"density 1 {problem.density!r}\ngravity {weight}\nforceLaw Default",
        "AddOrRemoveInteractions OBBtree\nUpdateNL linkCells\nIntegrator velocityVerlet",
        *laws,
        f"iconf 0\nnDriven {len(walls)}\nshapeFile shapes.shp\nprecision 17",
        f"Particles {len(walls) + problem.count}",
        *walls,
        *bodies,
    ]
    return "\n".join(lines) + "\n"


def _wall(problem: Problem, which: int) -> str:
    wall = problem.walls[which]
    depth = problem.solid.size
    place = [p - depth * n for p, n in zip(wall.point, wall.normal, strict=True)]
    return f"wall 1 0 1 {_row(place)} {STILL} {_row(TURNS[wall.normal])} {STILL}"


def _row(values: list[float] | tuple[float, ...]) -> str:
    return " ".join(map(repr, values))


def _seconds(command: str, asked: Run, steps: int) -> float:
    (asked.folder / "shapes.shp").write_text(shapes(asked.problem), encoding="utf-8")
    (asked.folder / "input.txt").write_text(conf(asked.problem, steps), encoding="utf-8")
    begin = time.perf_counter()
    run([command, "input.txt", "-j", str(asked.threads)], cwd=asked.folder)
    return time.perf_counter() - begin


def timed(asked: Run, command: str) -> Timing:
    """One run."""
    first = _seconds(command, asked, max(asked.warm, 1))
    spent = _seconds(command, asked, max(asked.warm, 1) + asked.steps) - first
    return Timing(spent, asked.steps, asked.problem.count)


def rockable(command: str | None) -> Peer:
    """The peer behind a path to its command."""
    found = command and shutil.which(command)
    why = None if found else f"no command {command}" if command else "no path by --rockable"
    install = "build github.com/richefeu/rockable and give --rockable PATH"
    return Peer("Rockable", install, lambda: why, partial(timed, command=found or ""))
