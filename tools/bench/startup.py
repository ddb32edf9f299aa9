"""Where the time goes from the command to the first step: ``python tools/bench/startup.py``.

Each scene starts in a process of its own, first with empty caches of kernels and of mass properties
(cold), then with what that left in them (warm): imports, reading, shapes, placement, arrays,
kernels, first step, first frame. Rows are nested; the seconds of a row contain those of the rows
below it. ``--spheres N`` and ``--cubes N`` start lattices of so many bodies instead of scenes.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import importlib
import json
import os
import pkgutil
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = ("hopper", "drum", "triaxial", "breakage", "periodic_shear")
SHORTEST = 0.02  # rows of fewer seconds than this are left out
# what is timed inside of a simulation's birth: where its name is looked up, and what it does
PARTS = (
    ("warpdem.simulation", "build_shapes", "shapes"),
    ("warpdem.simulation", "place", "placement"),
    ("warpdem.simulation", "features_of", "features"),
    ("warpdem.simulation", "bonds_of", "bonds"),
    ("warpdem.simulation", "automatic_step", "time step"),
    ("warpdem.simulation", "find_device", "Warp's start"),
    ("warpdem.simulation", "plan_of", "drivers"),
    ("warpdem.simulation", "build", "arrays"),
    ("warpdem.simulation", "Lists", "empty lists"),
    ("warpdem.simulation", "load", "kernels"),
    ("warpdem.simulation:Simulation", "_first_forces", "forces at time zero"),
    ("warpdem.lists:Lists", "rebuild", "lists"),
)


class Clock:
    """Rows of a table: depth, what, wall and CPU seconds, of this process and its children."""

    def __init__(self) -> None:
        self.rows: list[list] = []
        self._depth = 0

    @contextlib.contextmanager
    def part(self, what: str):
        """A row, and its rows until it ends."""
        row = [self._depth, what, time.perf_counter(), cpu()]
        self.rows.append(row)
        self._depth += 1
        yield
        self._depth -= 1
        row[2:] = time.perf_counter() - row[2], cpu() - row[3]

    def watch(self, home: str, name: str, what: str) -> None:
        """Make a row of each call of what a module or class calls ``name``."""
        place = pkgutil.resolve_name(home)
        timed = getattr(place, name)

        @functools.wraps(timed, updated=())
        def call(*args, **options):
            with self.part(what):
                return timed(*args, **options)

        setattr(place, name, call)


def cpu() -> float:
    """Seconds of all cores spent by this process and its children."""
    spent = os.times()
    return sum(spent[:4])


def start(source: str, began: float) -> None:
    """Start a scene in this process; prints its rows as JSON."""
    clock = Clock()
    clock.rows.append([0, "Python", time.time() - began, cpu()])
    with clock.part("imports"):
        for name, what in (
            ("numpy", "NumPy"),
            ("warpdem.input.decode", "scene files (pydantic)"),
            ("warp", "Warp"),
            ("warpdem.simulation", "warpdem's other modules"),
        ):
            with clock.part(what):
                importlib.import_module(name)
    import warpdem  # noqa: PLC0415 - it is timed

    for part in PARTS:
        clock.watch(*part)
    with clock.part("scene read"):
        scene = warpdem.load(source) if source.endswith(".toml") else warpdem.loads(source)
    with clock.part("simulation"):
        simulation = warpdem.Simulation(scene)
    with clock.part("first step"):
        simulation.advance(until=simulation.dt)
    facts = simulation.report()
    facts["modules"] = len(list(Path(os.environ["WARP_CACHE_PATH"]).rglob("*.meta")))
    facts["first step"] = time.time() - began
    facts["peak GB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    with clock.part("first frame"):
        frame(scene, simulation)
    print(json.dumps({"rows": clock.rows, **facts}))


def frame(scene, simulation) -> None:
    """Write what a run would write of its first frame, into a folder that goes away."""
    from warpdem.output.folder import claimed  # noqa: PLC0415 - it is timed
    from warpdem.output.recorder import Recorder  # noqa: PLC0415 - the same
    from warpdem.output.writer import Writer  # noqa: PLC0415 - the same

    with (
        tempfile.TemporaryDirectory() as path,
        claimed(Path(path) / "run", resume=False, force=False) as folder,
    ):
        writer = Writer()
        recorder = Recorder(folder, scene, simulation.polyhedra, simulation.placement, writer)
        with writer:
            recorder.record(simulation.snapshot(contacts=scene.output.contacts))
        recorder.close()


def lattice(kind: str, count: int) -> str:
    """A scene of ``count`` bodies in a lattice over a floor; frames without their surfaces."""
    side = 1
    while side**3 < count:
        side += 1
    size = "size = [1.0, 1.0, 1.0]\nrounding = 0.05" if kind == "box" else "radius = 0.5"
    width = side * (1.76 if kind == "box" else 1.0) + 1.0
    return f"""
title = "{count} of kind {kind}"
[run]
duration = 1.0
[output]
surface = false
[[shape]]
name = "body"
kind = "{kind}"
{size}
[[shape]]
name = "floor"
kind = "plane"
[[group]]
name = "rock"
density = 2500.0
[[group]]
name = "floor"
[[body]]
shape = "floor"
group = "floor"
position = [0, 0, 0]
fixed = true
[[fill]]
name = "rocks"
shapes = ["body"]
group = "rock"
kind = "lattice"
count = {count}
region = {{ min = [0, 0, 0.01], max = [{width}, {width}, {width}] }}
[[contact]]
groups = ["rock", "rock"]
kn = 1e7
kt = 8e6
en2 = 0.1
mu = 0.5
[[contact]]
groups = ["rock", "floor"]
kn = 1e7
kt = 8e6
en2 = 0.1
mu = 0.5
"""


def measured(source: str, cache: str) -> dict:
    """The rows of a start in a process of its own, kernels cached in a folder."""
    surroundings = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    surroundings |= {"WARP_CACHE_PATH": cache, "WARPDEM_CACHE_PATH": cache}
    command = [sys.executable, str(Path(__file__)), "--start", "-", "--began", str(time.time())]
    done = subprocess.run(
        command, input=source, text=True, env=surroundings, stdout=subprocess.PIPE, check=True
    )
    return json.loads(done.stdout.splitlines()[-1])


def show(title: str, found: dict) -> None:
    print(
        f"\n{title}: {found['bodies']} bodies, {found['modules']} modules; first step after "
        f"{found['first step']:.2f} s; peak {found['peak GB']:.2f} GB"
    )
    print(f"{'wall [s]':>9} {'CPU [s]':>8}")
    for depth, what, wall, spent in found["rows"]:
        if wall >= SHORTEST:
            print(f"{wall:9.2f} {spent:8.2f}  {'  ' * depth}{what}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("scenes", nargs="*", help=f"files, or names of the gallery; default: {' '.join(SCENES)}")
    add("--spheres", type=int, metavar="N", help="a lattice of so many")
    add("--cubes", type=int, metavar="N", help="a lattice of so many")
    add("--cold", action="store_true", help="only with an empty cache")
    add("--warm", action="store_true", help="only with the kernels in the cache")
    add("--start", help=argparse.SUPPRESS)
    add("--began", type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.start:
        start(sys.stdin.read(), options.began)
        return
    lattices = {"sphere": options.spheres, "box": options.cubes}
    sources = {f"{n} {kind}": lattice(kind, n) for kind, n in lattices.items() if n}
    for name in options.scenes or ([] if sources else SCENES):
        sources[name] = name if name.endswith(".toml") else str(ROOT / "scenes" / f"{name}.toml")
    for name, source in sources.items():
        with tempfile.TemporaryDirectory() as cache:
            cold = measured(source, cache)
            if not options.warm:
                show(f"{name}, cold", cold)
            if not options.cold:
                show(f"{name}, warm", measured(source, cache))


if __name__ == "__main__":
    main()
