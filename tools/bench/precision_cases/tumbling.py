"""Blocks that tumble on a plane, and many that come to lie on each other."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import ConvexHull

from precision_cases.case import GROUND, PLANE, SKIN, WEIGHT, Case, lattice, random, scene_of, turns
from precision_cases.settings import CONTACT, TURNING
from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from precision_cases.case import FloatArray, Scene

SIDE, DENSITY, COUNT, FALLEN = 0.2, 2500.0, 25, 0.3
LAW = {"kn": 1e6, "kt": 8e5, "en2": 0.25, "mu": 0.4}
CUBE = {"kind": "box", "name": "stone", "size": [SIDE] * 3, "rounding": 0.01}


@cache
def rock() -> Scene:
    """The hull of 16 points on an ellipsoid."""
    points = random(41).normal(size=(16, 3))
    points *= 0.5 * np.array([0.26, 0.2, 0.16]) / np.linalg.norm(points, axis=1, keepdims=True)
    hull = ConvexHull(points)
    faces = [
        list(f if np.dot(np.cross(*np.diff(points[f], axis=0)), e[:3]) > 0 else f[::-1])
        for f, e in zip(hull.simplices, hull.equations, strict=True)
    ]
    faces = [[int(k) for k in face] for face in faces]
    kind = {"kind": "polyhedron", "name": "stone", "rounding": 0.01}
    return kind | {"vertices": points.tolist(), "faces": faces}


def tumbling_scene(shape: Scene) -> Scene:
    """Thrown down in all orientations, spinning."""
    draw = random(42)
    rows = zip(
        lattice(COUNT, 2.0),
        draw.uniform(0.22, 0.3, COUNT),
        turns(COUNT, draw),
        draw.normal(size=(COUNT, 3)) * 0.5 + [1.0, 0.0, -1.0],
        draw.normal(size=(COUNT, 3)) * 3.0,
        strict=True,
    )
    bodies = [
        {
            "shape": "stone",
            "density": DENSITY,
            "position": [x, y, z],
            "orientation": q,
            "velocity": v,
            "spin": w,
        }
        for (x, y), z, q, v, w in rows
    ]
    return scene_of([*bodies, GROUND], [shape, PLANE], LAW, gravity=WEIGHT, run=SKIN)


def poses(shot: Any) -> FloatArray:
    """Rotation matrices; their distance is 2^.5 of the angle."""
    return matrix(shot.orientation[:-1]).reshape(-1, 9) / np.sqrt(2.0)


# --- a small packing ---------------------------------------------------------------------------
PACKED, WIDE = 0.6, 1.0


def packing_scene() -> Scene:
    """64 cubes fall into a box of planes."""
    draw = random(43)
    grid = np.array([(x, y, z) for z in range(4) for x in range(4) for y in range(4)], float)
    place = 0.24 * (grid - [1.5, 1.5, 0.0]) + [0.0, 0.0, 0.2]
    cube = CUBE | {"size": [0.13] * 3}
    rows = zip(place, turns(64, draw), strict=True)
    bodies = [
        {"shape": "stone", "density": DENSITY, "position": p, "orientation": q} for p, q in rows
    ]
    half = np.sqrt(0.5)
    walls = [
        {**GROUND, "position": [s * 0.5 * WIDE, 0.0, 0.0], "orientation": [half, 0, -s * half, 0]}
        for s in (-1, 1)
    ]
    walls += [
        {**GROUND, "position": [0.0, s * 0.5 * WIDE, 0.0], "orientation": [half, s * half, 0, 0]}
        for s in (-1, 1)
    ]
    return scene_of([*bodies, *walls, GROUND], [cube, PLANE], LAW, gravity=WEIGHT)


def mean_height(shot: Any) -> FloatArray:
    """Of the cubes, over their edge."""
    return shot.position[:64, 2].mean(keepdims=True) / 0.13


def median(errors: FloatArray) -> float:
    """What tumbles is chaotic: some part early."""
    return float(np.median(errors))


CASES = (
    Case(
        "tumbling_cube",
        f"{COUNT} cubes tumble for {FALLEN} s; median angle [rad], against a finer run",
        FALLEN,
        tuple(300 * 2**k for k in range(5)),
        CONTACT,
        lambda: tumbling_scene(CUBE),
        poses,
        typical=median,
    ),
    Case(
        "tumbling_rock",
        f"{COUNT} rocks tumble for {FALLEN} s; median angle [rad], against a finer run",
        FALLEN,
        tuple(300 * 2**k for k in range(5)),
        TURNING,
        lambda: tumbling_scene(rock()),
        poses,
        typical=median,
    ),
    Case(
        "packing",
        "64 cubes fall into a box; mean height over their edge, against a finer run",
        PACKED,
        tuple(600 * 2**k for k in range(3)),
        ("default", "lagged", "mixed", "sum", "pnorm", "rockable"),
        packing_scene,
        mean_height,
        finer=2,
    ),
)
