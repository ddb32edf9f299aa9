"""Whether a surface crosses itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.boxgrid import BoxGrid

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray

_CHUNK = 500_000
_MARGIN = 1e-9  # of the size of what meets: nearer than that, surfaces touch and do not cross


def crossing(vertices: FloatArray, edges: IntArray, triangles: IntArray) -> FloatArray | None:
    """A point in which an edge passes through a triangle it has no vertex in common with, or None.

    Args:
        vertices: Shape [vertex_count, 3].
        edges: Shape [edge_count, 2].
        triangles: Shape [triangle_count, 3].
    """
    ends, corners = vertices[edges], vertices[triangles]
    grid = BoxGrid(corners.min(axis=1), corners.max(axis=1))
    edge, triangle = grid.pairs(ends.min(axis=1), ends.max(axis=1))
    shared = (edges[edge][:, :, None] == triangles[triangle][:, None, :]).any(axis=(1, 2))
    edge, triangle = edge[~shared], triangle[~shared]
    for k in range(0, len(edge), _CHUNK):
        crosses, points = _crossings(ends[edge[k : k + _CHUNK]], corners[triangle[k : k + _CHUNK]])
        if crosses.any():
            return points[int(np.argmax(crosses))]
    return None


def _crossings(ends: FloatArray, corners: FloatArray) -> tuple[BoolArray, FloatArray]:
    """Whether segments pass through the inside of triangles, and where their lines meet planes."""
    a, b, c = corners.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    first, second = (np.einsum("ij,ij->i", ends[:, k] - a, normal) for k in (0, 1))
    margin = _MARGIN * np.linalg.norm(normal, axis=1) ** 1.5
    crosses = (np.minimum(first, second) < -margin) & (np.maximum(first, second) > margin)
    share = first / np.where(crosses, first - second, 1.0)
    points = ends[:, 0] + share[:, None] * (ends[:, 1] - ends[:, 0])
    border = _MARGIN * np.einsum("ij,ij->i", normal, normal)
    for u, v in ((a, b), (b, c), (c, a)):
        crosses &= np.einsum("ij,ij->i", np.cross(v - u, points - u), normal) > border
    return crosses, points
