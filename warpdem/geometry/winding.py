"""Whether points lie inside closed surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.geometry.facets import Facets

_CHUNK = 2_000_000  # point-side products held at once: some 200 MB


def winding_number(points: FloatArray, vertices: FloatArray, facets: Facets) -> FloatArray:
    """How often a surface winds around each point; 1 inside an outward surface, 0 outside.

    Source: solid angle of a triangle, van Oosterom and Strackee (1983),
    doi:10.1109/TBME.1983.325207, summed over fans: polygons with holes need no triangulation.

    Args:
        points: Shape [point_count, 3].
        vertices: Corner positions, shape [vertex_count, 3].
        facets: Facets of the surface.
    """
    apex = facets.sides[facets.start[:-1], 0][facets.owner]
    corners = vertices[np.column_stack([apex, facets.sides])]
    rows = max(1, _CHUNK // max(1, len(corners)))
    parts = [_turns(points[k : k + rows], corners) for k in range(0, len(points), rows)]
    return np.concatenate([np.zeros(0), *parts])


def _turns(points: FloatArray, corners: FloatArray) -> FloatArray:
    a, b, c = (corners[None, :, k] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    ab, bc, ca = (np.einsum("...i,...i", x, y) for x, y in ((a, b), (b, c), (c, a)))
    triple = np.einsum("...i,...i", a, np.cross(b, c))
    below = la * lb * lc + ab * lc + bc * la + ca * lb
    return np.arctan2(triple, below).sum(axis=1) / (2.0 * np.pi)
