"""Turning the facets of a surface alike, and those of a closed one outward."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.facets import area_vectors, connected
from warpdem.geometry.winding import winding_number

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.facets import Facets


def consistent_turns(facets: Facets, twin: IntArray) -> BoolArray | None:
    """Facets to turn so that neighbours agree; None for a surface with one side (Moebius).

    In each connected part the facet with the smallest number stays. Shape [facet_count].
    """
    owner = facets.owner
    paired = np.flatnonzero(twin >= 0)
    disagree = facets.sides[paired, 0] == facets.sides[twin[paired], 0]
    if not disagree.any():
        return np.zeros(facets.count, bool)
    here, there = owner[paired], owner[twin[paired]]
    turned = np.full(facets.count, -1)
    part = connected(facets.count, here, there)
    turned[np.unique(part)] = 0
    reached = turned >= 0
    while reached.any():
        step = reached[here] & (turned[there] < 0)
        turned[there[step]] = turned[here[step]] ^ disagree[step]
        reached = np.zeros(facets.count, bool)
        reached[there[step]] = True
    if np.any((turned[here] ^ turned[there]) != disagree):
        return None
    return turned.astype(bool)


def closed_parts(facets: Facets, twin: IntArray) -> tuple[IntArray, BoolArray]:
    """Connected part of each facet, numbered from 0, and whether each part is closed."""
    paired = np.flatnonzero(twin >= 0)
    root = connected(facets.count, facets.owner[paired], facets.owner[twin[paired]])
    _, part = np.unique(root, return_inverse=True)
    closed = np.ones(part.max(initial=-1) + 1, bool)
    closed[part[facets.owner[twin < 0]]] = False
    return part, closed


def inward_facets(vertices: FloatArray, facets: Facets, part: IntArray) -> BoolArray:
    """Facets of closed, alike oriented surfaces whose normal points into the solid.

    A part inside an odd number of others bounds a cavity: its volume counts as negative.

    Args:
        vertices: Corner positions, shape [vertex_count, 3].
        facets: The facets; every part is closed.
        part: Part of each facet, numbered from 0, shape [facet_count].
    """
    sign = np.where(part_volumes(vertices, facets, part) < 0.0, -1, 1)
    if len(sign) > 1:
        sign = sign * (1 - 2 * (_depths(vertices, facets, part) % 2))
    return sign[part] < 0


def part_volumes(vertices: FloatArray, facets: Facets, part: IntArray) -> FloatArray:
    """Signed volume enclosed by each part, shape [part_count]."""
    base = vertices[facets.sides[facets.start[:-1], 0]]
    base = base - vertices.mean(axis=0)
    share = np.einsum("ij,ij->i", base, area_vectors(vertices, facets)) / 3.0
    volumes = np.zeros(part.max(initial=-1) + 1)
    np.add.at(volumes, part, share)
    return volumes


def _depths(vertices: FloatArray, facets: Facets, part: IntArray) -> IntArray:
    """Number of other parts around each part, shape [part_count]."""
    count = part.max() + 1
    members = [facets.selected(part == number) for number in range(count)]
    used = [vertices[member.sides[:, 0]] for member in members]
    low = np.array([points.min(axis=0) for points in used])
    high = np.array([points.max(axis=0) for points in used])
    depth = np.zeros(count, np.int64)
    for inner in range(count):
        around = np.all(low <= low[inner], axis=1) & np.all(high >= high[inner], axis=1)
        around[inner] = False
        for outer in np.flatnonzero(around):
            turns = winding_number(used[inner][:1], vertices, members[outer])
            depth[inner] += int(abs(turns[0]) > 0.5)
    return depth
