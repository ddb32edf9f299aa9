"""From vertices, faces and edges as given to a checked, mended and oriented core."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry import coplanar, mend
from warpdem.geometry.activity import borders, side_of_edges
from warpdem.geometry.core import Core
from warpdem.geometry.crossing import crossing
from warpdem.geometry.facets import Facets, facets_of, twins
from warpdem.geometry.orient import closed_parts, consistent_turns, inward_facets, part_volumes
from warpdem.geometry.polygon import triangulated

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray

FARTHEST = 1e15
"""Largest coordinate [m]: its fifth power, as in an inertia, and sums of them are still numbers."""

_PLANARITY = 1e-5  # of the size: how far a corner may lie off its polygon's plane
_EMPTY = 1e-12  # of the size cubed: the least volume a solid encloses


def assembled(
    vertices: FloatArray | Sequence[Sequence[float]],
    faces: IntArray | Sequence[Sequence[int]],
    edges: IntArray | Sequence[Sequence[int]] | None,
    *,
    repair: bool,
) -> tuple[Core, list[str]]:
    """The core, and the repairs made, as sentences.

    Args:
        vertices: Positions [m], shape [vertex_count, 3].
        faces: Vertex numbers of planar polygons.
        edges: Segments, or None for the borders of the faces.
        repair: Weld vertices, drop degenerate and duplicate facets, merge coplanar ones. Without
            it, facets are turned at most, and a surface that is no manifold counts as open.

    Raises:
        GeometryError: The numbers describe no core; says why and what to do.
    """
    points = _checked_vertices(vertices)
    facets = _checked_facets(faces, points)
    segments = np.zeros((0, 2), np.int64) if edges is None else checked_edges(edges, len(points))
    notes: list[str] = []
    if repair and facets.count:
        points, facets, notes = mend.mended(points, facets)
        if not facets.count:
            raise GeometryError("no facet has an area; check the file's units and the scale")
    core = _oriented(points, facets, segments, notes, strict=repair)
    if repair and facets.count:
        points, facets, merges = coplanar.merged(core)
        notes += merges
        core = _core(points, facets, segments, closed=core.closed)
    _check_planes(core)
    return core, notes


def _checked_vertices(vertices: FloatArray | Sequence[Sequence[float]]) -> FloatArray:
    points = np.array(vertices, np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or not len(points):
        raise GeometryError("needs at least one vertex of three coordinates")
    if bad := np.flatnonzero(~np.isfinite(points).all(axis=1)).tolist():
        raise GeometryError(f"vertex {bad[0]} is not finite: {points[bad[0]].tolist()}")
    if far := np.flatnonzero((np.abs(points) > FARTHEST).any(axis=1)).tolist():
        raise GeometryError(
            f"vertex {far[0]} lies beyond {FARTHEST:g} m: {points[far[0]].tolist()}; "
            "check the units and the scale"
        )
    return points


def _checked_facets(faces: IntArray | Sequence[Sequence[int]], points: FloatArray) -> Facets:
    if not len(faces):
        return Facets(np.zeros(1, np.int64), np.zeros((0, 2), np.int64))
    if short := [k for k, face in enumerate(faces) if len(face) < 3][:1]:
        raise GeometryError(f"face {short[0]} has fewer than three corners; give an edge instead")
    facets = facets_of(faces)
    unknown = facets.owner[(facets.sides[:, 0] < 0) | (facets.sides[:, 0] >= len(points))]
    if len(unknown):
        raise GeometryError(
            f"face {unknown[0]} names a vertex that is not among 0 to {len(points) - 1}"
        )
    order = np.lexsort((facets.sides[:, 0], facets.owner))
    same = (np.diff(facets.sides[order, 0]) == 0) & (np.diff(facets.owner[order]) == 0)
    if same.any():
        side = order[int(np.argmax(same))]
        raise GeometryError(
            f"face {facets.owner[side]} visits vertex {facets.sides[side, 0]} twice; split it"
        )
    return facets


def checked_edges(edges: IntArray | Sequence[Sequence[int]], vertex_count: int) -> IntArray:
    """The segments as an array, shape [edge_count, 2].

    Raises:
        GeometryError: A segment names an unknown vertex, or has no length.
    """
    segments = np.array(edges, np.int64).reshape(-1, 2)
    wrong = (segments < 0).any(axis=1) | (segments >= vertex_count).any(axis=1)
    if wrong.any():
        raise GeometryError(
            f"edge {np.argmax(wrong)} names a vertex that is not among 0 to {vertex_count - 1}"
        )
    if (loop := segments[:, 0] == segments[:, 1]).any():
        raise GeometryError(f"edge {np.argmax(loop)} begins and ends in the same vertex")
    return segments


def _core(points: FloatArray, facets: Facets, segments: IntArray, *, closed: bool) -> Core:
    twin, _ = twins(facets)
    wires = segments[side_of_edges(segments, facets) < 0]
    lone = np.ones(len(points), bool)
    lone[facets.sides] = False
    lone[wires] = False
    return Core(points, facets, twin, wires, np.flatnonzero(lone), closed)


def _oriented(
    points: FloatArray, facets: Facets, segments: IntArray, notes: list[str], *, strict: bool
) -> Core:
    """The core with neighbours turned alike, and outward where the surface is closed."""
    twin, crowded = twins(facets)
    if strict and crowded.any():
        a, b = points[facets.sides[int(np.argmax(crowded))]]
        raise GeometryError(
            f"more than two facets share the edge from {_place(a)} to {_place(b)}; "
            "remove inner walls, or split the surface into several bodies"
        )
    turned = consistent_turns(facets, twin)
    if turned is None:
        if strict:
            raise GeometryError("the surface has one side only (a Moebius strip); cut it open")
        return _core(points, facets, segments, closed=False)
    facets = facets.reversed(turned)
    part, part_closed = closed_parts(facets, twin)
    closed = bool(facets.count and part_closed.all() and not crowded.any())
    if closed:
        _check_volumes(points, facets, part)
        inward = inward_facets(points, facets, part)
        facets, turned = facets.reversed(inward), turned ^ inward
        if count := int(turned.sum()):
            notes.append(f"turned {count} {'facet' if count == 1 else 'facets'} outward")
    return _core(points, facets, segments, closed=closed)


def _check_volumes(points: FloatArray, facets: Facets, part: IntArray) -> None:
    empty = np.abs(part_volumes(points, facets, part)) <= _EMPTY * mend.extent(points) ** 3
    if empty.any():
        first = facets.sides[facets.start[int(np.argmax(empty[part]))], 0]
        raise GeometryError(
            f"the closed surface at {_place(points[first])} encloses no volume; "
            "give a plate as one layer of faces"
        )


def _check_planes(core: Core) -> None:
    size = mend.extent(core.vertices)
    if (flat := np.linalg.norm(core.normals, axis=1) == 0.0).any():
        raise GeometryError(f"face {np.argmax(flat)} has no area; remove it")
    sides = core.facets.sides
    origin = core.vertices[sides[core.facets.start[:-1], 0]][core.facets.owner]
    normal = core.normals[core.facets.owner]
    off = np.abs(np.einsum("ij,ij->i", core.vertices[sides[:, 0]] - origin, normal))
    if (bent := off > _PLANARITY * size).any():
        side = int(np.argmax(bent))
        raise GeometryError(
            f"face {core.facets.owner[side]} is not planar: vertex {sides[side, 0]} lies "
            f"{off[side]:.3g} m off its plane; split it into triangles"
        )


def check_crossing(core: Core) -> None:
    """Refuse a closed surface that crosses itself: what it encloses is not defined.

    Raises:
        GeometryError: An edge passes through a face.
    """
    triangles, _ = triangulated(core.vertices, core.facets, core.normals, convex_faces(core))
    point = crossing(core.vertices, borders(core.facets), triangles)
    if point is not None:
        raise GeometryError(
            f"the surface crosses itself at {_place(point)}; mend the mesh, split it into several "
            "bodies, or declare volume and inertia_over_mass"
        )


def _place(point: FloatArray) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"


def is_convex(core: Core) -> bool:
    """Whether the core is a convex set, within 1e-6 rad and 1e-6 of its size."""
    if not core.closed:
        return _is_convex_plate(core)
    part, _ = closed_parts(core.facets, core.twin)
    if part.max() > 0 or len(core.wires) or len(core.points) or (core.side_angles < -1e-6).any():
        return False
    # convex edges alone do not tell a star that winds twice; of large meshes every n-th plane does
    step = max(1, core.facets.count * len(core.vertices) // 100_000_000)
    base = core.vertices[core.facets.sides[core.facets.start[:-1], 0]]
    offset = np.einsum("ij,ij->i", base, core.normals) + 1e-6 * mend.extent(core.vertices)
    return all(
        (core.vertices @ core.normals[facet]).max() <= offset[facet]
        for facet in range(0, core.facets.count, step)
    )


def _is_convex_plate(core: Core) -> bool:
    """A single point, segment or convex polygon."""
    kinds = (core.facets.count, len(core.wires), len(core.points))
    return kinds in {(0, 0, 1), (0, 1, 0)} or (kinds == (1, 0, 0) and bool(convex_faces(core)[0]))


def convex_faces(core: Core) -> BoolArray:
    """Faces that are convex polygons without holes; shape [facet_count]."""
    if not core.facets.count:
        return np.zeros(0, bool)
    convex = core.facets.loop_count == 1
    before = core.side_directions[core.facets.preceding]
    turn = np.cross(before, core.side_directions)
    left = np.einsum("ij,ij->i", turn, core.normals[core.facets.owner])
    convex[core.facets.owner[left < -1e-9]] = False  # straight but for rounding is convex
    return convex
