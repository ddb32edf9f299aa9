"""Writes scenes/breakage.toml, a block of bonded convex cells: python tools/make_breakage.py.

The cells are those of Voronoi about jittered points; each core lies a rounding inside its cell, so
that neighbours touch with their rounded faces.
"""

from itertools import product
from pathlib import Path

import numpy as np

SCENE = Path(__file__).resolve().parents[1] / "scenes" / "breakage.toml"
SIDE, CELLS, JITTER, ROUNDING = 1.0, 4, 0.3, 0.01
SPEED, CLEAR = 9.0, 0.02
# onto an edge, a little askew
TURN = (np.radians(40.0), np.radians(12.0))
SAME = 1e-9

HEAD = """# A block of 64 convex cells, bonded face to face, hits a plate with an edge; bonds
# break by their elastic energy, their fracture energies spread after Weibull.
# Written by tools/make_breakage.py.
#   python -m warpdem scenes/breakage.toml
title = "a bonded block breaks on a plate"

[run]
duration = 0.4

[output]
every = 0.005

[[group]]
name = "rock"
density = 2600.0

[[group]]
name = "plate"

[[contact]]
groups = ["rock", "plate"]
kn = 5.0e7
kt = 4.0e7
en2 = 0.1
mu = 0.5

[[contact]]
groups = ["rock", "rock"]
kn = 5.0e7
kt = 4.0e7
en2 = 0.1
mu = 0.5

[[bond]]
groups = ["rock", "rock"]
between = "inner"
rule = "faces"
tolerance = 1.0e-6
angle = 1.0e-4
kn = 4.0e8      # of an interface: share
kt = 2.0e8
share = true
en2 = 0.5
gc = 90.0
weibull = { modulus = 3.0 }

[[shape]]
name = "plate"
kind = "box"
size = [6.0, 6.0, 0.5]

[[body]]
name = "plate"
shape = "plate"
group = "plate"
position = [0, 0, -0.25]
fixed = true
"""


def cube(half: float) -> list[np.ndarray]:
    """Faces of a cube, each a loop of points counter-clockwise seen from outside."""
    faces = []
    for axis, sign in product(range(3), (-1.0, 1.0)):
        normal = np.eye(3)[axis] * sign
        u = np.roll(np.eye(3)[axis], 1)
        v = np.cross(normal, u)
        faces.append(
            half * np.array([normal - u - v, normal + u - v, normal + u + v, normal - u + v])
        )
    return faces


def clipped(faces: list[np.ndarray], normal: np.ndarray, offset: float) -> list[np.ndarray]:
    """What of a convex solid lies where normal . x <= offset."""
    kept, cap = [], []
    for face in faces:
        height = face @ normal - offset
        loop = []
        for p, q, a, b in zip(face, np.roll(face, -1, 0), height, np.roll(height, -1), strict=True):
            if a <= 0.0:
                loop.append(p)
            if a * b < 0.0:
                loop.append(p + (q - p) * (a / (a - b)))
                cap.append(loop[-1])
        if len(loop) > 2:
            kept.append(np.array(loop))
    if len(cap) > 2:
        points = np.array(cap)
        away = points - points.mean(axis=0)
        u = away[0] / np.linalg.norm(away[0])
        angle = np.arctan2(away @ np.cross(normal, u), away @ u)
        kept.append(points[np.argsort(angle)])
    return kept


def cell(number: int, seeds: np.ndarray) -> list[np.ndarray]:
    """Core of a cell: nearer to its seed than to any other, less the rounding."""
    faces = cube(SIDE / 2.0 - ROUNDING)
    for other in np.delete(seeds, number, axis=0):
        apart = other - seeds[number]
        normal = apart / np.linalg.norm(apart)
        middle = (other + seeds[number]) / 2.0
        faces = clipped(faces, normal, float(normal @ middle) - ROUNDING)
    return faces


def indexed(faces: list[np.ndarray]) -> tuple[np.ndarray, list[list[int]]]:
    """Different vertices, and the faces by their numbers."""
    points: list[np.ndarray] = []
    loops = []
    for face in faces:
        loop: list[int] = []
        for p in face:
            near = [k for k, q in enumerate(points) if np.abs(p - q).max() < SAME]
            if not near:
                points.append(p)
            number = near[0] if near else len(points) - 1
            if number not in loop:
                loop.append(number)
        if len(loop) > 2:
            loops.append(loop)
    return np.array(points), loops


def main() -> None:
    """Write the scene."""
    generator = np.random.default_rng(7)
    grid = np.array(list(product(range(CELLS), repeat=3)), float) + 0.5
    seeds = (grid + generator.uniform(-JITTER, JITTER, grid.shape)) * SIDE / CELLS - SIDE / 2.0
    a, b = TURN
    turn = np.array([np.cos(a / 2), np.sin(a / 2), 0.0, 0.0])
    w, x = turn[:2]
    c, s = np.cos(b / 2), np.sin(b / 2)
    quaternion = np.array([c * w, c * x, s * w, -s * x])
    lowest = reach(quaternion)
    text = HEAD
    for number in range(len(seeds)):
        vertices, faces = indexed(cell(number, seeds))
        corners = ",\n  ".join("[" + ", ".join(f"{v:.15g}" for v in p) + "]" for p in vertices)
        text += f"""
[[shape]]
name = "cell {number}"
kind = "polyhedron"
rounding = {ROUNDING}
vertices = [
  {corners},
]
faces = {faces}

[[body]]
name = "cell {number}"
shape = "cell {number}"
group = "rock"
position = [0, 0, {lowest + CLEAR:.6f}]
orientation = [{", ".join(f"{v:.15g}" for v in quaternion)}]
velocity = [0, 0, {-SPEED}]
"""
    SCENE.write_text(text, encoding="utf-8")


def reach(quaternion: np.ndarray) -> float:
    """How far the turned block reaches below its centre [m]."""
    w, v = quaternion[0], quaternion[1:]
    corners = np.array(list(product((-0.5, 0.5), repeat=3))) * SIDE
    t = 2.0 * np.cross(v, corners)
    turned = corners + w * t + np.cross(v, t)
    return float(-turned[:, 2].min())


if __name__ == "__main__":
    main()
