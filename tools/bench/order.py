"""Order in dt of scenes with several contacts, friction and rolling, against the figures to be met.

    python tools/bench/order.py [SCENE ...] [--samples N]

Median errors of orientation and position at the end of a run, against dt/64, over N random starts;
dt is 2.5e-4 s, about 20 steps a corner contact, then 1/2 to 1/16 of it: 320 steps. Scenes and
figures are those of shared/design/numerics.md, section 2. Exit status 1 if an error of the default
contact update at 20 or at 320 steps is more than 1.5 times its figure.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from itertools import pairwise
from math import acos, exp, pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from rockable import angles, verdict

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import FloatArray

COARSEST = 2.5e-4
RUNGS = 5
REFERENCE = 64
ALLOWANCE = 1.5
UPDATES = ("predicted", "lagged")
ZETA = 0.2
KN, KT = 1e5, 7e4


@dataclass(frozen=True)
class Start:
    """Bodies at the start and what they are made of; sizes are outer edges, 0 of a sphere.

    Attributes:
        size: Of each body [m].
        position, turn, velocity, spin: Of each body; turns are quaternions of any length.
        duration: Of the run [s].
        rounding: Minkowski radius of the boxes, radius of the spheres [m].
        mass: Of each body [kg].
        law: mu, kr and mur.
        free: No gravity and no plane.
    """

    size: list[list[float]]
    position: list[list[float]]
    turn: Any
    velocity: Any
    spin: Any
    duration: float
    rounding: float = 0.05
    mass: tuple[float, ...] = (1.0, 1.0, 1.0)
    law: dict[str, float] = field(default_factory=dict)
    free: bool = False


def brick(random: np.random.Generator) -> Start:
    """A tumbling brick: three or four impacts on corners and edges, with friction."""
    return Start(
        [[1.0, 0.8, 0.5]],
        [[0.0, 0.0, 0.75]],
        random.normal(size=(1, 4)),
        [random.normal(size=3) * 0.3 + [1.0, 0.0, -1.0]],
        [random.normal(size=3) * 2.0],
        0.6,
        law={"mu": 0.4},
    )


def cubes(random: np.random.Generator) -> Start:
    """The edge of a free cube on the face of another."""
    turn = np.array([[1.0, 0.0, 0.0, 0.0], [np.cos(pi / 8), np.sin(pi / 8), 0.0, 0.0]])
    return Start(
        [[1.0] * 3, [0.9] * 3],
        [[0.0, 0.0, 0.0], [0.1, 0.1, 1.16]],
        turn + random.normal(size=(2, 4)) * 0.02,
        [[0.0, 0.0, 0.5], [0.3, 0.2, -0.5]],
        random.normal(size=(2, 3)) * 0.4,
        0.25,
        law={"mu": 0.4},
        free=True,
    )


def stack(random: np.random.Generator) -> Start:
    """Three cubes, one on the other, in motion."""
    turn = np.array([[1.0, 0.0, 0.0, 0.1 * k] for k in range(3)])
    return Start(
        [[1.0] * 3, [0.9] * 3, [0.8] * 3],
        [[0.0, 0.0, 0.501], [0.02, 0.01, 1.452], [0.0, 0.03, 2.303]],
        turn + random.normal(size=(3, 4)) * 2e-4,
        random.normal(size=(3, 3)) * [0.3, 0.3, 0.02],
        random.normal(size=(3, 3)) * [0.02, 0.02, 0.3],
        0.25,
        mass=(1.0, 0.73, 0.51),
        law={"mu": 0.3},
    )


def spheres(random: np.random.Generator) -> Start:
    """A sphere that slides, spins and rolls on the plane, hit by another one."""
    return Start(
        [[0.0] * 3, [0.0] * 3],
        [[0.0, 0.0, 0.0999], [0.25, 0.05, 0.2]],
        np.eye(4)[[0, 0]],
        [[1.0, 0.5 * random.random(), 0.0], [-1.0, 0.0, 0.5 * random.random()]],
        random.normal(size=(2, 3)) * 10.0,
        0.25,
        rounding=0.1,
        law={"mu": 0.3, "kr": 300.0, "mur": 0.01},
    )


def slider(random: np.random.Generator) -> Start:
    """A slab that spins and slides; nothing hits."""
    return Start(
        [[1.0, 1.0, 0.6]],
        [[0.0, 0.0, 0.3002]],
        [[1.0, 0.0, 0.0, 0.0] + random.normal(size=4) * 1e-4],
        [[1.2 + 0.2 * random.random(), 0.2 * random.random(), 0.0]],
        [[0.0, 0.0, 3.0 + 2.0 * random.random()]],
        0.4,
        law={"mu": 0.3},
    )


SCENES: dict[str, tuple[Callable[[np.random.Generator], Start], tuple[float, float, float]]] = {
    "brick": (brick, (2e-3, 1e-5, 1.6)),
    "cubes": (cubes, (3e-4, 1e-6, 1.8)),
    "stack": (stack, (6e-5, 4e-7, 1.9)),
    "spheres": (spheres, (1e-3, 3e-5, 1.0)),
    "slider": (slider, (1e-4, 0.0, 0.0)),
}
"""Starts by name, and the figures to be met: rotation error at dt, at dt/16, order; 0 for none."""


def scene_of(start: Start, dt: float, update: str) -> Scene:
    """The scene of a start; damping such that the ratio of a pair is `ZETA`."""
    count = len(start.size)
    shapes = [_shape(k, size, start.rounding) for k, size in enumerate(start.size)]
    turn = np.array(start.turn, float)
    turn /= np.linalg.norm(turn, axis=1)[:, None]
    bodies: list[dict[str, Any]] = [
        {
            "shape": f"s{k}",
            "position": start.position[k],
            "orientation": turn[k],
            "velocity": start.velocity[k],
            "spin": start.spin[k],
            "density": start.mass[k] / _volume(start.size[k], start.rounding),
        }
        for k in range(count)
    ]
    if not start.free:
        shapes.append(_shape(count, [40.0, 40.0, 4.0], start.rounding))
        bodies.append({"shape": f"s{count}", "position": [0.0, 0.0, -2.0], "fixed": True})
    loss = 2.0 * ZETA * acos(ZETA) / sqrt(1.0 - ZETA**2)
    law = {"groups": ["default"] * 2, "kn": KN, "kt": KT, "en2": exp(-2.0 * loss), **start.law}
    return Scene.model_validate(
        {
            "run": {"duration": start.duration, "dt": dt, "contact_update": update},
            "gravity": {"vector": [0.0, 0.0, 0.0 if start.free else -9.81]},
            "shape": shapes,
            "body": bodies,
            "contact": [law],
            "output": {"energy": False},
        }
    )


def _volume(size: list[float], rounding: float) -> float:
    return float(np.prod(size)) or 4.0 / 3.0 * pi * rounding**3


def _shape(number: int, size: list[float], rounding: float) -> dict[str, Any]:
    """A box that has the mass and inertia of the sharp one, or a sphere."""
    if not any(size):
        return {"kind": "sphere", "name": f"s{number}", "radius": rounding}
    square = np.square(size)
    return {
        "kind": "box",
        "name": f"s{number}",
        "size": size,
        "rounding": rounding,
        "volume": _volume(size, rounding),
        "inertia_over_mass": (square.sum() - square) / 12.0,
    }


def final(start: Start, steps: int, update: str) -> tuple[FloatArray, FloatArray]:
    """Positions [m] and orientations of the free bodies at the end of a run."""
    scene = scene_of(start, start.duration / steps, update)
    simulation = Simulation(scene, device="cpu", threads=1)
    simulation.advance(start.duration)
    end = simulation.snapshot()
    count = len(start.size)
    return end.position[:count], end.orientation[:count]


def apart(
    first: tuple[FloatArray, FloatArray], second: tuple[FloatArray, FloatArray]
) -> tuple[float, float]:
    """Root mean square over the bodies of rotation angle [rad] and distance [m]."""
    turned = angles(first[1], second[1])
    moved = np.linalg.norm(first[0] - second[0], axis=1)
    return float(np.sqrt(np.mean(turned**2))), float(np.sqrt(np.mean(moved**2)))


def errors(make: Callable[[np.random.Generator], Start], samples: int) -> dict[str, FloatArray]:
    """Median rotation and position errors of each contact update, shape [RUNGS, 2]."""
    found: dict[str, list[list[tuple[float, float]]]] = {update: [] for update in UPDATES}
    for seed in range(samples):
        start = make(np.random.default_rng(seed))
        steps = round(start.duration / COARSEST)
        reference = final(start, steps * REFERENCE, UPDATES[0])
        for update, rows in found.items():
            ladder = [final(start, steps * 2**rung, update) for rung in range(RUNGS)]
            rows.append([apart(end, reference) for end in ladder])
    return {update: np.median(np.array(rows), axis=0) for update, rows in found.items()}


def order(error: FloatArray) -> float:
    """Mean order of the last three errors of a ladder that halves dt."""
    return float(np.mean([np.log2(coarse / fine) for coarse, fine in pairwise(error[-3:])]))


def meets(error: FloatArray, figures: tuple[float, float, float]) -> bool:
    """Whether first and last error of a ladder are within the allowance of their figures."""
    pairs = zip((error[0], error[-1]), figures[:2], strict=True)
    return all(not figure or value <= ALLOWANCE * figure for value, figure in pairs)


def tabulate(name: str, samples: int) -> bool:
    """Print the rows of a scene; whether it meets its figures."""
    make, figures = SCENES[name]
    passes = meets((found := errors(make, samples))[UPDATES[0]][:, 0], figures)
    for update, error in found.items():
        turned, moved = (
            "  ".join(f"{value:.1e}" for value in error[:, k]) + f"  [{order(error[:, k]):4.1f}]"
            for k in (0, 1)
        )
        print(f"{name:8s} {update:10s} {turned} | {moved}", flush=True)
    wanted = f"{figures[0]:.0e}"
    if figures[1]:
        wanted = f"{wanted:36s}  {figures[1]:.0e}    [{figures[2]:4.1f}]"
    print(f"{'':8s} {'to be met':10s} {wanted:51s}   {verdict(passes)}")
    return passes


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", nargs="*", help=f"of {', '.join(SCENES)}; default: all")
    parser.add_argument("--samples", type=int, default=6, help="random starts of each scene")
    asked = parser.parse_args()
    if unknown := {*asked.scene} - {*SCENES}:
        parser.error(f"no scene {', '.join(unknown)}; there are: {', '.join(SCENES)}")
    print(f"median of {asked.samples} starts at dt, dt/2 .. dt/16 [order of the last three]")
    print(f"{'scene':8s} {'update':10s} {'rotation [rad]':51s} | position [m]")
    passes = [tabulate(name, asked.samples) for name in asked.scene or SCENES]
    return 0 if all(passes) else 1


if __name__ == "__main__":
    sys.exit(main())
