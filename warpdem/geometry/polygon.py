"""Cutting planar polygons, also with holes, into triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.arcs import perpendicular

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.facets import Facets


def triangulated(
    vertices: FloatArray, facets: Facets, normals: FloatArray, convex: BoolArray
) -> tuple[IntArray, IntArray]:
    """Triangles of all facets, with their orientation, no vertices added.

    Args:
        vertices: Shape [vertex_count, 3].
        facets: The polygons.
        normals: Unit normals, shape [facet_count, 3].
        convex: Facets that a fan from the first vertex cuts, shape [facet_count].

    Returns:
        Vertices, shape [triangle_count, 3], and facet of each triangle, in the order of facets.
    """
    apex = facets.sides[facets.start[:-1], 0][facets.owner]
    fan = np.column_stack([apex, facets.sides])
    kept = (apex != fan[:, 1]) & (apex != fan[:, 2]) & convex[facets.owner]
    triangles, owner = [fan[kept]], [facets.owner[kept]]
    for facet in np.flatnonzero(~convex).tolist():
        cut = ear_clipped(vertices, facets.loops(facet), normals[facet])
        triangles.append(cut)
        owner.append(np.full(len(cut), facet))
    owners = np.concatenate(owner)
    order = np.argsort(owners, kind="stable")
    return np.concatenate(triangles)[order], owners[order]


def ear_clipped(vertices: FloatArray, loops: Sequence[IntArray], normal: FloatArray) -> IntArray:
    """Triangles of one polygon with holes.

    Args:
        vertices: Shape [vertex_count, 3].
        loops: Borders with the inside on the left; the outer one may stand anywhere.
        normal: Unit normal, shape [3].
    """
    across = perpendicular(normal[None])[0]
    plane = vertices @ np.array([across, np.cross(normal, across)], np.float64).T
    ring = _bridged(plane, [loop.tolist() for loop in loops])
    triangles = []
    while len(ring) > 3:
        ear = _ear(plane, ring)
        triangles.append([ring[ear - 1], ring[ear], ring[(ear + 1) % len(ring)]])
        del ring[ear]
    return np.array([*triangles, ring], np.int64)


def _doubled_area(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Twice the signed area of triangles in the plane, shape [...]."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (
        c[..., 0] - a[..., 0]
    )


def _bridged(plane: FloatArray, loops: list[list[int]]) -> list[int]:
    """One ring through all loops: each hole is joined, rightmost first, by a bridge."""
    area = [_loop_area(plane[loop]) for loop in loops]
    outer = int(np.argmax(area))
    ring = loops[outer]
    holes = [loop for k, loop in enumerate(loops) if k != outer]
    for hole in sorted(holes, key=lambda loop: -plane[loop, 0].max()):
        start = int(np.argmax(plane[hole, 0]))
        place = _visible(plane, ring, hole[start])
        ring = ring[: place + 1] + hole[start:] + hole[: start + 1] + ring[place:]
    return ring


def _loop_area(points: FloatArray) -> float:
    following = np.roll(points, -1, axis=0)
    return float(0.5 * np.sum(points[:, 0] * following[:, 1] - points[:, 1] * following[:, 0]))


def _visible(plane: FloatArray, ring: list[int], vertex: int) -> int:
    """Place in the ring of a corner that sees a vertex whose ray to the right hits the ring.

    Source: Eberly, "Triangulation by ear clipping" (2002), section 3.
    """
    points = plane[ring]
    following = np.roll(points, -1, axis=0)
    x, y = plane[vertex]
    with np.errstate(divide="ignore", invalid="ignore"):
        fraction = (y - points[:, 1]) / (following[:, 1] - points[:, 1])
        meets = points[:, 0] + fraction * (following[:, 0] - points[:, 0])
    # sides that go up have the inside on their left, where the vertex is
    facing = (points[:, 1] <= y) & (following[:, 1] > y) & (meets >= x)
    side = int(np.argmin(np.where(facing, meets, np.inf)))
    after = (side + 1) % len(ring)
    corner = side if points[side, 0] > points[after, 0] else after
    hit = np.array([meets[side], y])
    return _nearest_blocking(points, np.array([x, y]), hit, corner)


def _nearest_blocking(points: FloatArray, origin: FloatArray, hit: FloatArray, corner: int) -> int:
    """The corner, or the reflex one inside origin-hit-corner with the least angle to the ray."""
    tip = points[corner]
    triangle = [origin, hit, tip] if tip[1] > origin[1] else [origin, tip, hit]
    inside = _inside(points, *triangle)
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    inside &= _doubled_area(before, points, after) < 0.0
    inside[corner] = True
    away = points - origin
    slope = np.abs(away[:, 1]) / np.maximum(np.abs(away[:, 0]), 1e-300)
    distance = np.einsum("ij,ij->i", away, away)
    candidates = np.flatnonzero(inside)
    return int(min(candidates, key=lambda k: (slope[k], distance[k])))


def _inside(points: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> BoolArray:
    """Points in a counter-clockwise triangle or on its border."""
    return (
        (_doubled_area(a, b, points) >= 0.0)
        & (_doubled_area(b, c, points) >= 0.0)
        & (_doubled_area(c, a, points) >= 0.0)
    )


def _ear(plane: FloatArray, ring: list[int]) -> int:
    """Place of a convex corner whose triangle holds no other corner, the fattest such."""
    points = plane[ring]
    before, after = np.roll(points, 1, axis=0), np.roll(points, -1, axis=0)
    area = _doubled_area(before, points, after)
    span = np.einsum("ij,ij->i", after - before, after - before)
    span += np.einsum("ij,ij->i", points - before, points - before)
    reflex = points[area <= 0.0]
    for place in np.argsort(-area / span, kind="stable"):
        if area[place] <= 0.0:
            break
        corners = before[place], points[place], after[place]
        others = reflex[~np.any([np.all(reflex == corner, axis=1) for corner in corners], axis=0)]
        if not _inside(others, *corners).any():
            return int(place)
    return int(np.argmax(area))  # rounding left no ear: only slivers remain
