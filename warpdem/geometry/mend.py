"""Repairs of a surface as meshes come: duplicate vertices, facets without area, duplicates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.facets import Facets, area_vectors, connected

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray

WELD = 1e-7  # of the largest coordinate difference: what single precision in a file resolves


def extent(vertices: FloatArray) -> float:
    """Diagonal of the bounding box [m]."""
    return float(np.linalg.norm(np.ptp(vertices, axis=0))) if len(vertices) else 0.0


def mended(vertices: FloatArray, facets: Facets) -> tuple[FloatArray, Facets, list[str]]:
    """The surface with each vertex and each facet once, and what was done, as sentences."""
    notes = []
    label = welded(vertices, WELD * extent(vertices))
    if duplicates := int((label != np.arange(len(label))).sum()):
        notes.append(f"welded {_counted(duplicates, 'duplicate vertex', 'duplicate vertices')}")
    facets, collapsed = _without_collapsed(Facets(facets.start, label[facets.sides]))
    if collapsed:
        notes.append(f"dropped {_counted(collapsed, 'facet', 'facets')} without area")
    kept = _first_of_each(facets)
    if repeated := int((~kept).sum()):
        facets = facets.selected(kept)
        notes.append(f"dropped {_counted(repeated, 'duplicate facet', 'duplicate facets')}")
    used = np.zeros(len(vertices), bool)
    used[facets.sides] = True
    if stray := int((~used & (label == np.arange(len(label)))).sum()):
        notes.append(f"dropped {_counted(stray, 'vertex', 'vertices')} of no facet")
    return *compacted(vertices, facets), notes


def _counted(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"


def compacted(vertices: FloatArray, facets: Facets) -> tuple[FloatArray, Facets]:
    """Only the vertices of facets, in their order."""
    used = np.zeros(len(vertices), bool)
    used[facets.sides] = True
    number = np.cumsum(used) - 1
    return vertices[used], Facets(facets.start, number[facets.sides])


def welded(vertices: FloatArray, tolerance: float) -> IntArray:
    """Smallest number of the vertices within ``tolerance`` of each, chains included.

    Vertices are compared along a line in a general direction, where few others lie as near.
    """
    if len(vertices) < 2:
        return np.arange(len(vertices))
    place = vertices @ np.array([0.5477, 0.3169, 0.7746])  # a direction no mesh is aligned with
    order = np.argsort(place, kind="stable")
    links = []
    ahead = 1
    active = np.arange(len(order) - 1)
    while len(active):
        a, b = order[active], order[active + ahead]
        near = np.linalg.norm(vertices[a] - vertices[b], axis=1) <= tolerance
        links.append(np.column_stack([a[near], b[near]]))
        ahead += 1
        active = active[place[b] - place[a] <= tolerance * 1.01]
        active = active[active + ahead < len(order)]
    pairs = np.concatenate(links)
    return connected(len(vertices), pairs[:, 0], pairs[:, 1])


def _without_collapsed(facets: Facets) -> tuple[Facets, int]:
    """Facets without sides of no length, and how many facets had fewer than three left."""
    real = facets.sides[:, 0] != facets.sides[:, 1]
    length = np.bincount(facets.owner[real], minlength=facets.count)
    kept = length >= 3
    sides = facets.sides[real & kept[facets.owner]]
    start = np.concatenate([[0], np.cumsum(length[kept])])
    return Facets(start, sides), int((~kept).sum())


def _first_of_each(facets: Facets) -> BoolArray:
    """The first facet of each set of vertices, whichever way round; shape [facet_count]."""
    kept = np.ones(facets.count, bool)
    length = np.diff(facets.start)
    for size in np.unique(length):
        rows = np.flatnonzero(length == size)
        corners = facets.sides[facets.start[rows][:, None] + np.arange(size), 0]
        _, first = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
        kept[rows] = False
        kept[rows[first]] = True
    return kept


def slivers(vertices: FloatArray, facets: Facets, tolerance: float) -> BoolArray:
    """Facets thinner than ``tolerance`` across their longest side; shape [facet_count]."""
    area = np.linalg.norm(area_vectors(vertices, facets), axis=1)
    ends = vertices[facets.sides]
    longest = np.maximum.reduceat(
        np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), facets.start[:-1]
    )
    return 2.0 * area <= tolerance * longest
