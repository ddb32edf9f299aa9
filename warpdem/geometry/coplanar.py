"""Merging the coplanar facets of a surface into polygonal faces, and collinear sides into edges.

Facets count as coplanar when they meet at an angle below 1e-6 rad, or when the smaller lies within
1e-7 of the surface's size from the plane of the larger (meshes are often in single precision); the
faces that come out are flat within 1e-6 of the size, or their facets are left alone.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.activity import FLAT
from warpdem.geometry.facets import Facets, area_vectors, connected, twins
from warpdem.geometry.mend import WELD, compacted, extent, slivers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.core import Core

_FLATNESS = 1e-6  # of the size: how far a merged face may leave its plane


def merged(core: Core) -> tuple[FloatArray, Facets, list[str]]:
    """Vertices and faces with coplanar facets merged, and what was done, as sentences."""
    vertices, facets = core.vertices, core.facets
    size = extent(vertices)
    face = _flat_faces(vertices, facets, _coplanar_sets(core, size), size)
    lone = np.bincount(face, minlength=facets.count)[face] == 1
    faces = _joined(core, face, lone)
    notes = []
    if before := int((~lone).sum()):
        after = len(np.unique(face[~lone]))
        plural = "face" if after == 1 else "faces"
        notes.append(f"merged {before} coplanar facets into {after} {plural}")
    straight = _straight_vertices(vertices, faces, size)
    if straight.any():
        faces = _without_vertices(faces, straight)
    return *compacted(vertices, faces), notes


def _coplanar_sets(core: Core, size: float) -> IntArray:
    """Smallest facet of the connected coplanar set of each facet, shape [facet_count]."""
    facets, twin = core.facets, core.twin
    side = np.flatnonzero(twin > np.arange(len(twin)))
    thin = slivers(core.vertices, facets, WELD * size)
    height = _heights(core)
    angle = np.abs(core.side_angles[side])
    lower = np.minimum(height[side], height[twin[side]])
    flat = (angle <= FLAT) | ((angle < 0.5 * np.pi) & (np.sin(angle) * lower <= WELD * size))
    here, there = facets.owner[side], facets.owner[twin[side]]
    flat &= ~thin[here] & ~thin[there]
    # a facet without area has no plane: it joins the neighbour along its longest side
    longest = _longest_sides(core)
    joins = longest[thin & (twin[longest] >= 0)]
    return connected(
        facets.count,
        np.concatenate([here[flat], facets.owner[joins]]),
        np.concatenate([there[flat], facets.owner[twin[joins]]]),
    )


def _heights(core: Core) -> FloatArray:
    """How far each side's facet reaches from the side's line [m], shape [side_count]."""
    facets = core.facets
    inward = np.cross(core.normals[facets.owner], core.side_directions)
    start, length = facets.start[:-1][facets.owner], np.diff(facets.start)[facets.owner]
    base = core.vertices[facets.sides[:, 0]]
    height = np.zeros(len(facets.sides))
    for step in range(int(length.max(initial=0))):
        corner = core.vertices[facets.sides[start + step % length, 0]]
        np.maximum(height, np.einsum("ij,ij->i", corner - base, inward), out=height)
    return height


def _longest_sides(core: Core) -> IntArray:
    """Longest side of each facet, shape [facet_count]."""
    ends = core.vertices[core.facets.sides]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    order = np.lexsort((-length, core.facets.owner))
    return order[core.facets.start[:-1]]


def _flat_faces(vertices: FloatArray, facets: Facets, face: IntArray, size: float) -> IntArray:
    """The sets of facets, those that are not flat taken apart again."""
    area = area_vectors(vertices, facets)
    normal = np.stack([np.bincount(face, part, minlength=facets.count) for part in area.T], axis=1)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal /= np.where(length > 0.0, length, 1.0)
    origin = vertices[facets.sides[facets.start[face], 0]][facets.owner]
    along = normal[face][facets.owner]
    height = np.abs(np.einsum("ij,ij->i", vertices[facets.sides[:, 0]] - origin, along))
    bent = np.zeros(facets.count, bool)
    bent[face[facets.owner[height > _FLATNESS * size]]] = True
    return np.where(bent[face], np.arange(facets.count), face)


def _joined(core: Core, face: IntArray, lone: BoolArray) -> Facets:
    """Facets of one face joined; ``lone`` ones stay as they are."""
    facets, twin = core.facets, core.twin
    if lone.all():
        return facets
    owner = facets.owner
    inner = (twin >= 0) & (face[owner] == face[owner[twin]])
    loops: dict[int, list[list[int]]] = {}
    rim = np.flatnonzero(~inner & ~lone[owner])
    rim = rim[np.argsort(face[owner[rim]], kind="stable")]
    for group in np.split(rim, _changes(face[owner[rim]])) if len(rim) else ():
        number = int(face[owner[group[0]]])
        loops[number] = _loops(core.vertices, facets.sides[group], core.area_vectors[number])
    rows, length = [], []
    for number in np.flatnonzero(face == np.arange(facets.count)):
        if lone[number]:
            rows.append(facets.sides[facets.start[number] : facets.start[number + 1]])
        else:
            rows.append(np.concatenate([_closed_loop(loop) for loop in loops[int(number)]]))
        length.append(len(rows[-1]))
    return Facets(np.concatenate([[0], np.cumsum(length)]), np.concatenate(rows))


def _changes(values: IntArray) -> IntArray:
    return np.flatnonzero(np.diff(values)) + 1


def _closed_loop(loop: list[int]) -> IntArray:
    return np.column_stack([loop, np.roll(loop, -1)])


def _loops(vertices: FloatArray, sides: IntArray, normal: FloatArray) -> list[list[int]]:
    """Closed loops that the sides of one face form, the outer one first."""
    leaving: dict[int, list[int]] = {}
    for number, start in enumerate(sides[:, 0].tolist()):
        leaving.setdefault(start, []).append(number)
    unused = set(range(len(sides)))
    found = []
    # begin where only one side leaves, so that loops which touch in a vertex stay apart
    for first in sorted(unused, key=lambda number: (len(leaving[int(sides[number, 0])]), number)):
        if first not in unused:
            continue
        side, loop = first, []
        while side in unused:
            unused.remove(side)
            loop.append(int(sides[side, 0]))
            choices = leaving[int(sides[side, 1])]
            side = choices[0]
            if len(choices) > 1:
                side = _leftmost(vertices, sides, side_in=loop[-1], choices=choices, normal=normal)
        found.append(loop)
    return sorted(found, key=lambda loop: -float(_loop_area(vertices[loop]) @ normal))


def _leftmost(
    vertices: FloatArray,
    sides: IntArray,
    *,
    side_in: int,
    choices: Sequence[int],
    normal: FloatArray,
) -> int:
    """Of the sides that leave a vertex, the one that turns most to the left."""
    vertex = sides[choices[0], 0]
    onward = vertices[vertex] - vertices[side_in]

    def turn(number: int) -> float:
        leaving = vertices[sides[number, 1]] - vertices[vertex]
        sine = float(np.cross(onward, leaving) @ normal) / float(np.linalg.norm(normal))
        return float(np.arctan2(sine, onward @ leaving))

    return max(choices, key=turn)


def _loop_area(points: FloatArray) -> FloatArray:
    around = points - points[0]
    return 0.5 * np.cross(around, np.roll(around, -1, axis=0)).sum(axis=0)


def _straight_vertices(vertices: FloatArray, facets: Facets, size: float) -> BoolArray:
    """Vertices between two collinear edges and on no other; shape [vertex_count]."""
    sides = facets.sides
    twin, _ = twins(facets)
    once = (twin < 0) | (twin > np.arange(len(twin)))
    degree = np.bincount(sides[once].reshape(-1), minlength=len(vertices))
    before = vertices[sides[facets.preceding, 0]]
    here, after = vertices[sides[:, 0]], vertices[sides[:, 1]]
    into, out = here - before, after - here
    chord = np.linalg.norm(after - before, axis=1)
    off = np.linalg.norm(np.cross(into, out), axis=1)
    shorter = np.minimum(np.linalg.norm(into, axis=1), np.linalg.norm(out, axis=1))
    # distance from the chord, and the angle it amounts to
    distance = off / np.where(chord > 0.0, chord, 1.0)
    near = (distance <= WELD * size) | (distance <= FLAT * shorter)
    near &= np.einsum("ij,ij->i", into, out) > 0.0
    straight = degree == 2
    straight[sides[~near, 0]] = False
    return straight


def _without_vertices(facets: Facets, dropped: BoolArray) -> Facets:
    """Facets whose loops skip the vertices in ``dropped``."""
    kept = ~dropped[facets.sides[:, 0]]
    # the start of the next kept side along the loop ends each kept side
    end = facets.sides[:, 1].copy()
    pending = kept & dropped[end]
    place = facets.following.copy()
    while pending.any():
        end[pending] = facets.sides[place[pending], 1]
        place[pending] = facets.following[place[pending]]
        pending = kept & dropped[end]
    length = np.bincount(facets.owner[kept], minlength=facets.count)
    sides = np.column_stack([facets.sides[kept, 0], end[kept]])
    return Facets(np.concatenate([[0], np.cumsum(length)]), sides)
