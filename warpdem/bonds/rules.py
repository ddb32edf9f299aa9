"""The three rules by which two bodies are bonded."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpdem.bonds.sites import (
    VF,
    Sites,
    Solid,
    crossings,
    edge_between,
    inside,
    joined,
    nothing,
    subcontacts,
    vertex_vertex,
)

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene_bond import Bond

SAME = 1e-6
"""Places nearer to each other than so many face sizes are one."""


class Joint(NamedTuple):
    """Bonds of two bodies.

    Attributes:
        sites: Where they are.
        area: Of the interface [m^2]; 0 where the bonds span none.
    """

    sites: Sites
    area: float


def joint(bond: Bond, first: Solid, second: Solid) -> Joint:
    """Bonds of two bodies by the rule of ``bond``; none where they are too far apart."""
    if bond.rule == "vertices":
        sites = vertex_vertex(first, second, bond.tolerance)
        return Joint(sites, _spanned(sites.point))
    if bond.rule == "clusters":
        return Joint(_central(subcontacts(first, second, bond.tolerance)), 0.0)
    return _faces(first, second, bond.tolerance, bond.angle)


def _central(sites: Sites) -> Sites:
    """The site closest to the mean of all."""
    if len(sites) == 0:
        return sites
    away = sites.point - sites.point.mean(axis=0)
    return sites[np.array([np.argmin(np.einsum("nk,nk->n", away, away))])]


def _spanned(points: FloatArray) -> float:
    """Area of the convex hull of points that lie about in a plane [m^2]."""
    if len(points) < 3:
        return 0.0
    away = points - points.mean(axis=0)
    axes = np.linalg.svd(away, full_matrices=False)[2][:2]
    flat = away @ axes.T
    hull = _hull(flat)
    return _area(flat[hull])


def _hull(points: FloatArray) -> IntArray:
    """Convex hull of points in a plane, counter-clockwise; Andrew (1979)."""
    order = np.lexsort((points[:, 1], points[:, 0]))

    def chain(along: IntArray) -> list[int]:
        kept: list[int] = []
        for k in along:
            while len(kept) > 1 and _turn(*points[[kept[-2], kept[-1], k]]) <= 0.0:
                kept.pop()
            kept.append(int(k))
        return kept[:-1]

    return np.array(chain(order) + chain(order[::-1]))


def _turn(a: FloatArray, b: FloatArray, c: FloatArray) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _area(polygon: FloatArray) -> float:
    x, y = polygon.T
    return 0.5 * float(abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))


def _faces(first: Solid, second: Solid, tolerance: float, angle: float) -> Joint:
    """Bonds at the corners of the overlaps of all opposite faces."""
    parts, area = [], 0.0
    opposite = first.normals @ second.normals.T < -np.cos(angle)
    reach = first.radius + second.radius
    others = dict(second.polygons())
    for face, corners in first.polygons():
        for other in np.flatnonzero(opposite[face]):
            if int(other) not in others:
                continue
            normal = second.normals[other]
            theirs = second.vertices[others[int(other)]]
            height = (first.vertices[corners] - theirs[0]) @ normal - reach
            if np.abs(height).min() > tolerance:
                continue
            overlap = _overlap(first.vertices[corners], theirs, normal)
            size = float(np.ptp(theirs, axis=0).max())
            if overlap > (SAME * size) ** 2:
                parts.append(_corners(first, second, face, int(other), SAME * size))
                area += overlap
    sites = joined(parts) if parts else nothing()
    return Joint(sites, area)


def _overlap(first: FloatArray, second: FloatArray, normal: FloatArray) -> float:
    """Area common to two convex polygons, seen along ``normal`` [m^2]; Sutherland & Hodgman."""
    u = second[1] - second[0]
    u = u / np.linalg.norm(u)
    axes = np.stack([u, np.cross(normal, u)])
    clip = (second - second[0]) @ axes.T
    # the first one's face looks the other way
    polygon = ((first - second[0]) @ axes.T)[::-1]
    for a, b in zip(clip, np.roll(clip, -1, axis=0), strict=True):
        if len(polygon) == 0:
            return 0.0
        ahead = np.roll(polygon, -1, axis=0)
        d = np.array([_turn(a, b, p) for p in polygon])
        e = np.roll(d, -1)
        kept = []
        for k in range(len(polygon)):
            if d[k] >= 0.0:
                kept.append(polygon[k])
            if d[k] * e[k] < 0.0:
                kept.append(polygon[k] + (ahead[k] - polygon[k]) * (d[k] / (d[k] - e[k])))
        polygon = np.array(kept).reshape(-1, 2)
    return _area(polygon) if len(polygon) > 2 else 0.0


def _corners(first: Solid, second: Solid, face: int, other: int, slack: float) -> Sites:
    """Vertex-face bonds at corners over the other face, edge-edge bonds where borders cross.

    Of two at the same place the first body's vertex is taken.
    """
    mine = _over(first, second, face, other, slack)
    theirs = _over(second, first, other, face, slack).swapped()
    borders = {
        (edge_between(first, *map(int, ends)), edge_between(second, *map(int, others)))
        for ends in zip(*first.sides(face), strict=True)
        for others in zip(*second.sides(other), strict=True)
    }
    crossing = crossings(first, second, borders)
    # edges of sharp bodies that meet have no direction from one to the other
    crossing = crossing[np.flatnonzero(np.any(crossing.normal != 0.0, axis=1))]
    every = joined([mine, theirs, crossing])
    kept: list[int] = []
    flat = every.point - np.outer(every.point @ second.normals[other], second.normals[other])
    for k in range(len(every)):
        if all(np.linalg.norm(flat[k] - flat[m]) > 10.0 * slack for m in kept):
            kept.append(k)
    return every[np.array(kept, dtype=np.int64)]


def _over(first: Solid, second: Solid, face: int, other: int, slack: float) -> Sites:
    """Corners of a face of the first body that project inside a face of the second."""
    corners = first.sides(face)[0]
    a = corners[inside(second, other, first.vertices[corners], slack)]
    normal = np.broadcast_to(second.normals[other], (len(a), 3))
    origin = second.vertices[second.sides(other)[0][0]]
    gap = (first.vertices[a] - origin) @ second.normals[other] - first.radius - second.radius
    point = first.vertices[a] - normal * (first.radius + 0.5 * gap)[:, None]
    features = np.stack([a, np.full(len(a), other)], axis=1)
    return Sites(np.full(len(a), VF), features, gap, normal, point)
