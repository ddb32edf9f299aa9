"""Whole convex solids, rounded, their cores a little apart: what touches is the nearest there is.

The smallest gap of all sub-contacts of a pair = the distance of the two cores by a quadratic
programme, less the roundings; and there is one wherever that is negative.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from reference import hull_distance

from warpdem.geometry.hull import convex_hull
from warpdem.geometry.orientation import matrix, random_orientations
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

SPACING = 64.0
"""Between pairs [m]: a power of two, so that what is placed there is rounded alike."""
ROUNDING = 0.05
ERROR = 1e-12
"""Of a gap [m]; places are some hundred metres."""


def solid(random: np.random.Generator, name: str) -> dict[str, Any]:
    """The hull of some points, as flat or long as 1:20; a box now and then."""
    if random.random() < 0.2:
        size = random.uniform(0.1, 1.5, 3).tolist()
        return {"kind": "box", "name": name, "size": size, "rounding": ROUNDING}
    points = (
        random.normal(size=(random.integers(4, 14), 3)) * 0.4 * 20.0 ** random.uniform(-1, 0, 3)
    )
    faces = convex_hull(points)
    return {
        "kind": "polyhedron",
        "name": name,
        "vertices": points.tolist(),
        "faces": faces.tolist(),
        "rounding": ROUNDING,
    }


def placed(count: int, random: np.random.Generator, **run: Any) -> tuple[Simulation, list[Any]]:
    """Pairs of solids with their cores less than both roundings apart, and these distances.

    Each pair is drawn in a scene of its own first, which says where the vertices are.
    """
    shapes = [solid(random, str(k)) for k in range(2 * count)]
    turns = random_orientations(2 * count, random)
    bodies = [
        {"shape": str(k), "density": 1.0, "position": [SPACING * k, 0.0, 0.0], "orientation": turn}
        for k, turn in enumerate(turns.tolist())
    ]
    apart = simulated(shapes, bodies)
    cores = [
        apart.polyhedra[str(k)].vertices @ matrix(apart.placement.orientation[k]).T
        for k in range(2 * count)
    ]
    # of the centre of mass from the place that the scene gives
    offset = apart.placement.position - [body["position"] for body in bodies]
    for pair in range(count):
        middle = SPACING * np.array([pair % 10, pair // 10, 0.0])
        shift = _near(cores[2 * pair], cores[2 * pair + 1], random)
        bodies[2 * pair]["position"] = (middle + shift - offset[2 * pair]).tolist()
        bodies[2 * pair + 1]["position"] = (middle - offset[2 * pair + 1]).tolist()
    simulation = simulated(shapes, bodies, **run)
    position = simulation.snapshot().position
    cores = [core + place for core, place in zip(cores, position, strict=True)]
    return simulation, [hull_distance(*pair) for pair in zip(cores[::2], cores[1::2], strict=True)]


def simulated(shapes: list[Any], bodies: list[Any], **run: Any) -> Simulation:
    """The bodies at their start."""
    scene = {
        "run": {"duration": 1.0, "dt": 1e-6, "device": "cpu", **run},
        "gravity": {"vector": [0.0, 0.0, 0.0]},
        "shape": shapes,
        "body": bodies,
        "contact": [
            {"groups": ["default", "default"], "kn": 1.0, "kt": 0.0, "mu": 0.0, "en2": 1.0}
        ],
    }
    return Simulation(Scene.model_validate(scene), threads=1)


def _near(first: np.ndarray, second: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A place of the first core about the second one, between touching it and both roundings."""
    way = random.normal(size=3)
    way /= np.linalg.norm(way)
    near, far = 0.0, 10.0
    wanted = random.uniform(0.02, 1.98) * ROUNDING
    for _ in range(40):
        middle = 0.5 * (near + far)
        distance = hull_distance(first + middle * way, second)
        if abs(distance - wanted) < 0.01 * ROUNDING:
            break
        near, far = (middle, far) if distance < wanted else (near, middle)
    return middle * way


def faults(count: int, seed: int, **run: Any) -> list[str]:
    """What is wrong with so many pairs."""
    simulation, distances = placed(count, np.random.default_rng(seed), **run)
    contacts = simulation.snapshot(contacts=True).contacts
    assert contacts is not None
    found = []
    pair = contacts.bodies.min(axis=1) // 2
    for k, distance in enumerate(distances):
        gap = float(contacts.gap[pair == k].min(initial=np.inf))
        error = abs(gap + 2.0 * ROUNDING - distance)
        if not error <= ERROR:
            found.append(f"solids {k} of seed {seed}: gap {gap:.17g}, cores {distance:.17g} apart")
    return found
