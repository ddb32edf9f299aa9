"""How speed and memory grow with the number of bodies and of threads.

Spheres: a layer ten deep of nearly equal spheres on a tilted floor, periodic sideways, that begins
to flow; its contacts per body do not depend on its size. Cubes: the case's box, settling.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from math import ceil, sqrt
from pathlib import Path
from typing import TYPE_CHECKING

from speed import scenes
from speed.packings import worker
from speed.report import Cell, Table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

COLUMNS = (
    "bodies",
    "scene",
    "threads",
    "contacts/body",
    "candidates/body",
    "body-steps/s",
    "per CPU s",
    "start [s]",
    "bytes/body",
)
DEPTH = 10
"""Layers of both scenes."""
LAYER = """
[run]
duration = 100.0
dt = 1e-4
[gravity]
vector = [2.0, 2.0, -9.39]
[output]
energy = false
[cell]
size = [{width}, {width}, {height}]
periodic = [true, true, false]
[[group]]
name = "grain"
density = 2500.0
[[group]]
name = "wall"
[[contact]]
groups = ["grain", "grain"]
kn = 1e6
kt = 8e5
en2 = 0.1
mu = 0.5
[[contact]]
groups = ["grain", "wall"]
kn = 1e6
kt = 8e5
en2 = 0.1
mu = 0.5
[[shape]]
name = "grain"
kind = "sphere"
radius = 0.05
[[shape]]
name = "plane"
kind = "plane"
[[body]]
shape = "plane"
group = "wall"
fixed = true
position = [0.0, 0.0, 0.0]
[[fill]]
name = "grains"
shapes = ["grain"]
group = "grain"
kind = "lattice"
count = {count}
must_fit = true
region = {{ min = [0.0, 0.0, 0.0], max = [{width}, {width}, {height}] }}
size = {{ kind = "uniform", min = 0.99, max = 1.0 }}
orientation = "aligned"
"""


def layer(count: int) -> str:
    """Scene of so many spheres, or a few more: whole layers."""
    columns = ceil(sqrt(count / DEPTH))
    size = {"width": round(0.1 * columns + 1e-6, 7), "height": 0.1 * (DEPTH + 1)}
    return LAYER.format(count=min(count, DEPTH * columns**2), **size)


def box(count: int) -> str:
    """Scene of so many cubes."""
    return scenes.text(scenes.cubes(count, ceil(sqrt(count / DEPTH))))


@dataclass(frozen=True)
class Series:
    """One scene in many sizes.

    Attributes:
        name: In the table.
        text: Scene of a number of bodies.
        sizes: Numbers of bodies.
        warm: Steps before the clock.
        work: Body-steps under the clock, at least 20 steps.
    """

    name: str
    text: Callable[[int], str]
    sizes: tuple[int, ...]
    warm: int
    work: float


SERIES = (
    Series("spheres", layer, tuple(10**k for k in range(2, 7)), 300, 1e7),
    Series("cubes", box, tuple(10**k for k in range(2, 6)), 300, 1e6),
)


def scaling(threads: Iterable[int] = (1, 2), *, most: int = 10**6) -> Table:
    """The table of all series, up to ``most`` bodies."""
    rows = [
        row(series, count, number)
        for series in SERIES
        for count in series.sizes
        if count <= most
        for number in threads
    ]
    note = (
        "start: from the read scene to the clock, steps before it included; bytes/body: growth of "
        "the process's peak memory from the read scene on, over the bodies; below 1e4 bodies that "
        "of the program itself"
    )
    return Table(
        "Scaling of warpdem", COLUMNS, tuple(rows), (note,), ("bodies", "body-steps/s", "scene")
    )


def row(series: Series, count: int, threads: int) -> tuple[Cell, ...]:
    """One run."""
    steps = max(20, round(series.work / count))
    with tempfile.TemporaryDirectory() as place:
        scene = Path(place) / "scene.toml"
        scene.write_text(series.text(count), encoding="utf-8")
        found = worker(scene, threads=threads, warm=series.warm, steps=steps)
    bodies, done = found["bodies"], found["bodies"] * found["steps"]
    return (
        bodies,
        series.name,
        threads,
        found["contacts"] / bodies,
        found["candidates"] / bodies,
        done / found["wall"],
        done / found["cpu"],
        found["start_seconds"],
        found["memory"] / bodies,
    )
