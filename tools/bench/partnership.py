"""Energy that pairs of blocks gain or lose in one collision, under each sharing rule.

    python tools/bench/partnership.py [--pairs N] [--json FILE]

Pairs of equal cubes and of different rocks meet in random poses. First without friction and
dashpot: |dE|/E0 of each collision, which is zero in the exact motion; median, nine tenths, worst,
at dt and dt/4. Then with friction and dashpot: what the total energy (kinetic, elastic) rises by
over the whole run, in parts of E0, which passive laws keep at zero; and what the collision leaves.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from restitution import about

from warpdem.checks.timestep import masses
from warpdem.geometry.orientation import product, turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray

STIFFNESS = 1e5
"""kn [N/m]; bodies have some 1 kg, so that a hit lasts 7 ms."""
STEP = 4e-4
END = 0.7
WATCHED = 2e-3
"""Time between two looks at the energy where it must not rise [s]."""
RULES: dict[str, dict[str, Any]] = {
    "once": {"partnership": "once"},
    "sum": {"partnership": "sum"},
    "pnorm p = 4": {"partnership": "pnorm"},
    "pnorm p = 8": {"partnership": "pnorm", "partnership_exponent": 8.0},
    "number": {"partnership": "number"},
    "overlap": {"partnership": "overlap"},
}
ELASTIC = {"kt": 0.0, "mu": 0.0, "en2": 1.0}
ROUGH = {"kt": 0.7 * STIFFNESS, "mu": 0.5, "en2": 0.5}


SPACING = 8.0
"""Between pairs, which never meet [m]."""
KINDS = ("cubes", "cubes face to face", "rocks", "rocks face to face")


def rock(random: np.random.Generator, name: str) -> dict[str, Any]:
    golden = 0.5 * (1.0 + np.sqrt(5.0))
    corners = np.array([[0.0, i, j * golden] for i in (-1, 1) for j in (-1, 1)])
    vertices = np.concatenate([np.roll(corners, k, axis=1) for k in range(3)])
    faces = [
        [a, b, c] if np.linalg.det(vertices[[a, b, c]]) > 0.0 else [a, c, b]
        for a in range(12)
        for b in range(a + 1, 12)
        for c in range(b + 1, 12)
        if all(np.linalg.norm(vertices[i] - vertices[j]) < 2.1 for i, j in ((a, b), (b, c), (a, c)))
    ]
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    stretched = vertices @ np.diag(random.uniform(0.7, 1.3, 3)) @ turn * 0.3
    if np.linalg.det(turn) < 0.0:
        faces = [face[::-1] for face in faces]
    return {
        "kind": "polyhedron",
        "name": name,
        "vertices": stretched,
        "faces": faces,
        "rounding": 0.05,
    }


def bodies(kind: str, count: int, seed: int = 1) -> tuple[list[Any], list[Any]]:
    """Shapes and bodies of so many pairs, side by side.

    Random poses, or two faces opposite within some .05 rad; an offset across the line of flight,
    closing speed 2 m/s.
    """
    random = np.random.default_rng(seed)
    shapes: list[dict[str, Any]] = []
    placed: list[dict[str, Any]] = []
    for pair in range(count):
        middle = SPACING * np.array([0.0, pair % 10, pair // 10])
        across = random.uniform(-0.3, 0.3, 2)
        for side in (-1.0, 1.0):
            name = f"{pair} {side:+.0f}"
            if kind.startswith("cubes"):
                shape = {"kind": "box", "name": name, "size": [1.0] * 3, "rounding": 0.05}
                normal = np.array([1.0, 0.0, 0.0])
            else:
                shape = rock(random, name)
                normal = normal_of(shape, int(random.integers(len(shape["faces"]))))
            turn = random.normal(size=4)
            if kind.endswith("face to face"):
                turn = facing(normal, np.array([-side, 0.0, 0.0]), random)
            shapes.append(shape)
            placed.append(
                {
                    "shape": name,
                    "density": 1.0,
                    "position": middle + np.array([0.92 * side, *(0.5 * side * across)]),
                    "orientation": turn / np.linalg.norm(turn),
                    "velocity": [-side, 0.0, 0.0],
                }
            )
    return shapes, placed


def normal_of(shape: dict[str, Any], face: int) -> FloatArray:
    """Outward unit normal of a face."""
    a, b, c = (shape["vertices"][corner] for corner in shape["faces"][face])
    across = np.cross(b - a, c - a)
    return across / np.linalg.norm(across)


def facing(normal: FloatArray, towards: FloatArray, random: np.random.Generator) -> FloatArray:
    """Quaternion that turns ``normal`` to ``towards``, within some .05 rad, at a random roll."""
    axis = np.cross(normal, towards)
    if np.linalg.norm(axis) < 1e-9:
        axis = np.cross(normal, [0.3, 0.5, 0.8])
    angle = np.arctan2(np.linalg.norm(np.cross(normal, towards)), normal @ towards)
    turn = about(tuple(axis), float(angle))
    roll = about(tuple(towards), float(random.uniform(0.0, 2.0 * np.pi)))
    tilt = random.normal(size=3)
    nudge = about(tuple(tilt), float(random.normal() * 0.05))
    return product(nudge[None], product(roll[None], turn[None]))[0]


def simulated(
    kind: str, count: int, law: dict[str, Any], dt: float, rule: dict[str, Any]
) -> Simulation:
    """All collisions at their start."""
    shapes, placed = bodies(kind, count)
    scene = {
        "run": {"duration": END, "dt": dt, **rule},
        "gravity": {"vector": [0.0, 0.0, 0.0]},
        "shape": shapes,
        "body": placed,
        "contact": [{"groups": ["default", "default"], "kn": STIFFNESS, **law}],
    }
    return Simulation(Scene.model_validate(scene), device="cpu")


def changes(kind: str, count: int, dt: float, rule: dict[str, Any]) -> FloatArray:
    """|dE|/E0 of collisions without friction and dashpot, shape [count]."""
    simulation = simulated(kind, count, ELASTIC, dt, rule)
    before = energies(simulation)
    simulation.advance(END)
    return np.abs(energies(simulation) / before - 1.0)


def rises(kind: str, count: int, dt: float, rule: dict[str, Any]) -> tuple[FloatArray, FloatArray]:
    """Sum of the rises of the energy of rough, damped collisions, and what is left, over E0."""
    simulation = simulated(kind, count, ROUGH, dt, rule)
    seen = [energies(simulation)]
    while simulation.time < END - 0.5 * dt:
        simulation.advance(simulation.time + max(WATCHED, dt))
        seen.append(energies(simulation))
    steps = np.diff(seen, axis=0)
    return np.where(steps > 0.0, steps, 0.0).sum(axis=0) / seen[0], seen[-1] / seen[0]


def energies(simulation: Simulation) -> FloatArray:
    """Kinetic and elastic energy of each pair [J], shape [count]."""
    now = simulation.snapshot()
    mass, moment = masses(simulation.placement, simulation.polyhedra)
    spin = turned(now.orientation * np.array([1.0, -1.0, -1.0, -1.0]), now.spin)
    kinetic = 0.5 * (mass * (now.velocity**2).sum(axis=1) + (moment * spin**2).sum(axis=1))
    found = kinetic.reshape(-1, 2).sum(axis=1)
    owner, elastic = simulation.pair_energies()
    np.add.at(found, owner // 2, elastic)
    return found


def summary(values: FloatArray) -> tuple[float, float, float]:
    """Median, nine tenths, worst."""
    return tuple(float(np.quantile(values, q)) for q in (0.5, 0.9, 1.0))  # type: ignore[return-value]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=100)
    parser.add_argument("--json", type=Path, help="where to write the figures")
    asked = parser.parse_args()
    found: dict[str, Any] = {}
    for kind in KINDS:
        print(f"\n{asked.pairs} pairs of {kind}: median, p90, worst")
        print(f"{'rule':12s} {'dt':>8s} {'|dE|/E0, elastic':>32s} {'rises/E0, rough':>32s}  left")
        for name, rule in RULES.items():
            for dt in (STEP, STEP / 4.0):
                elastic = summary(changes(kind, asked.pairs, dt, rule))
                rough, left = rises(kind, asked.pairs, dt, rule)
                figures = (*elastic, *summary(rough), float(np.median(left)))
                found[f"{kind}, {name}, {dt:g}"] = figures
                row = " ".join(f"{value:10.1e}" for value in figures[:-1])
                print(f"{name:12s} {dt:8.0e} {row}  {figures[-1]:.3f}", flush=True)
    if asked.json:
        asked.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
