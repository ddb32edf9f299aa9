"""Cores that several tests share."""

import numpy as np

CUBE_CORNERS = [
    [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
]  # fmt: skip
CUBE_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
TETRA_CORNERS = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(8.0)
TETRA_FACES = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
CUP_FACES = [[0, 1, 2, 3], *CUBE_FACES[2:]]


def split(faces):
    """Each quadrilateral as two triangles."""
    return [part for a, b, c, d in faces for part in ([a, b, c], [a, c, d])]


def prism(outline, height):
    """Vertices and faces of an upright prism on a counter-clockwise outline."""
    count = len(outline)
    vertices = [[x, y, z] for z in (0.0, height) for x, y in outline]
    sides = [[k, (k + 1) % count, count + (k + 1) % count, count + k] for k in range(count)]
    return vertices, [list(range(count))[::-1], list(range(count, 2 * count)), *sides]


ELL = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]


def frame():
    """Vertices and triangles of a square frame: a slab with a square hole."""
    plan = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1], [2, 1], [2, 2], [1, 2]]
    flat = [[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7]]
    vertices = [[x, y, z] for z in (0.0, 0.5) for x, y in plan]
    faces = [part[::-1] for part in flat] + [[k + 8 for k in part] for part in flat]
    for k in range(4):
        n = (k + 1) % 4
        faces += split([[k, n, n + 8, k + 8], [4 + n, 4 + k, 12 + k, 12 + n]])
    return vertices, faces


def soup(vertices, triangles):
    """Three vertices of its own for each triangle, as in an STL file."""
    corners = np.asarray(vertices, float)[np.asarray(triangles)]
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


def rotation(seed):
    """A random rotation matrix."""
    matrix, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    return matrix * np.sign(np.linalg.det(matrix))
