"""Feature pairs of two bodies near each other: the places where bonds can be made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron

VV, VE, EV, VF, FV, EE = range(6)
"""Kinds of feature pairs, as in kernels.codes: feature of the first body first."""
SWAPPED = np.array([VV, EV, VE, FV, VF, EE])
"""The same kinds seen from the second body."""
PARALLEL = 1e-10
"""Square of the sine under which edges count as parallel, as in kernels.narrow."""


@dataclass(frozen=True, eq=False)
class Sites:
    """Feature pairs of two bodies.

    Attributes:
        kind: Of the feature pair, shape [n].
        features: Of the first and of the second body, shape [n, 2].
        gap: Signed distance [m], shape [n].
        normal: Unit normal from the second to the first body, world, shape [n, 3].
        point: Middle of the gap, world [m], shape [n, 3].
    """

    kind: IntArray
    features: IntArray
    gap: FloatArray
    normal: FloatArray
    point: FloatArray

    def __len__(self) -> int:
        return len(self.kind)

    def __getitem__(self, chosen: IntArray) -> Sites:
        """Some of them."""
        return Sites(
            self.kind[chosen],
            self.features[chosen],
            self.gap[chosen],
            self.normal[chosen],
            self.point[chosen],
        )

    def swapped(self) -> Sites:
        """The same with the two bodies exchanged."""
        kind, features = SWAPPED[self.kind], self.features[:, ::-1]
        return Sites(kind, features, self.gap, -self.normal, self.point)


class Solid:
    """A placed body: the world positions of its features.

    Attributes:
        shape: Its polyhedron.
        radius: Of its rounding [m].
        vertices: World positions [m], shape [vertex_count, 3].
    """

    def __init__(self, placement: Placement, shapes: Sequence[Polyhedron], body: int) -> None:
        self.shape = shapes[placement.shape[body]]
        self.radius = float(self.shape.radius * placement.scale[body])
        self._rotation = matrix(placement.orientation[body])
        scaled = self.shape.vertices * placement.scale[body]
        self.vertices = scaled @ self._rotation.T + placement.position[body]

    @cached_property
    def normals(self) -> FloatArray:
        """Outward unit normals of the faces, world, shape [face_count, 3]."""
        return self.shape.face_normals @ self._rotation.T

    def sides(self, face: int) -> tuple[IntArray, IntArray]:
        """First and second vertices of a face's directed sides."""
        ends = self.shape.side_vertices[
            self.shape.side_start[face] : self.shape.side_start[face + 1]
        ]
        return ends[:, 0], ends[:, 1]

    def polygons(self) -> Iterator[tuple[int, IntArray]]:
        """Number and corners, in order, of each convex face."""
        for face in np.flatnonzero(self.shape.face_convex):
            yield int(face), self.sides(int(face))[0]

    def box(self, reach: float) -> tuple[FloatArray, FloatArray]:
        """Its world box, grown by the rounding and by ``reach`` [m]."""
        grown = self.radius + reach
        return self.vertices.min(axis=0) - grown, self.vertices.max(axis=0) + grown


def near(first: Solid, second: Solid, tolerance: float) -> bool:
    """Whether the boxes of two bodies come within the tolerance."""
    low, high = first.box(0.5 * tolerance)
    other_low, other_high = second.box(0.5 * tolerance)
    return bool(np.all(low <= other_high) and np.all(other_low <= high))


def vertex_vertex(first: Solid, second: Solid, tolerance: float) -> Sites:
    """All pairs of vertices with a gap below the tolerance."""
    apart = first.vertices[:, None] - second.vertices[None]
    reach = first.radius + second.radius + tolerance
    a, b = np.nonzero(np.einsum("abk,abk->ab", apart, apart) < reach * reach)
    radii = (first.radius, second.radius)
    return _between(VV, np.stack([a, b], axis=1), first.vertices[a], second.vertices[b], radii)


def subcontacts(first: Solid, second: Solid, tolerance: float) -> Sites:
    """All feature pairs with a gap below the tolerance whose feet lie inside both features."""
    parts = [
        vertex_vertex(first, second, tolerance),
        _vertex_edge(first, second),
        _vertex_edge(second, first).swapped(),
        _vertex_face(first, second, tolerance),
        _vertex_face(second, first, tolerance).swapped(),
        _edge_edge(first, second),
    ]
    return joined([part[np.flatnonzero(part.gap < tolerance)] for part in parts])


def joined(parts: Sequence[Sites]) -> Sites:
    """Sites one after the other."""
    names = ("kind", "features", "gap", "normal", "point")
    return Sites(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


def _between(
    kind: int, features: IntArray, p: FloatArray, q: FloatArray, radii: tuple[float, float]
) -> Sites:
    """Sites of feature pairs whose closest core points are p, q."""
    d = p - q
    distance = np.linalg.norm(d, axis=1)
    normal = d / np.where(distance > 0.0, distance, 1.0)[:, None]
    gap = distance - sum(radii)
    point = p - normal * (radii[0] + 0.5 * gap)[:, None]
    return Sites(np.full(len(features), kind), features, gap, normal, point)


def _vertex_edge(first: Solid, second: Solid) -> Sites:
    ends = second.vertices[second.shape.edges]
    along = ends[:, 1] - ends[:, 0]
    square = np.einsum("ek,ek->e", along, along)
    foot = np.einsum("vek,ek->ve", first.vertices[:, None] - ends[None, :, 0], along)
    a, b = np.nonzero((foot > 0.0) & (foot < square))
    q = ends[b, 0] + along[b] * (foot[a, b] / square[b])[:, None]
    radii = (first.radius, second.radius)
    return _between(VE, np.stack([a, b], axis=1), first.vertices[a], q, radii)


def _vertex_face(first: Solid, second: Solid, tolerance: float) -> Sites:
    reach = first.radius + second.radius
    found = []
    for face, corners in second.polygons():
        normal = second.normals[face]
        height = (first.vertices - second.vertices[corners[0]]) @ normal
        # behind the face by more than the roundings it is another face's
        on = inside(second, face, first.vertices) & (height > -reach - tolerance)
        a = np.flatnonzero(on)
        gap = height[a] - reach
        normals = np.broadcast_to(normal, (len(a), 3))
        point = first.vertices[a] - normals * (first.radius + 0.5 * gap)[:, None]
        features = np.stack([a, np.full(len(a), face)], axis=1)
        found.append(Sites(np.full(len(a), VF), features, gap, normals, point))
    return joined(found) if found else nothing()


def inside(solid: Solid, face: int, points: FloatArray, slack: float = 0.0) -> np.ndarray:
    """Whether points project inside a convex face, or up to ``slack`` [m] beside it."""
    a, b = (solid.vertices[ends] for ends in solid.sides(face))
    inward = np.cross(solid.normals[face], b - a)
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    depth = np.einsum("psk,sk->ps", points[:, None] - a[None], inward)
    return np.all(depth >= -slack, axis=1)


def _edge_edge(first: Solid, second: Solid) -> Sites:
    ends, others = first.vertices[first.shape.edges], second.vertices[second.shape.edges]
    u, v = ends[:, 1] - ends[:, 0], others[:, 1] - others[:, 0]
    w = ends[:, None, 0] - others[None, :, 0]
    uu, vv = np.einsum("ek,ek->e", u, u)[:, None], np.einsum("ek,ek->e", v, v)[None]
    uv, uw, vw = u @ v.T, np.einsum("ek,efk->ef", u, w), np.einsum("fk,efk->ef", v, w)
    area = uu * vv - uv * uv
    skew = area > PARALLEL * uu * vv
    s = np.divide(uv * vw - vv * uw, area, out=np.zeros_like(area), where=skew)
    t = np.divide(uu * vw - uv * uw, area, out=np.zeros_like(area), where=skew)
    a, b = np.nonzero(skew & (s > 0.0) & (s < 1.0) & (t > 0.0) & (t < 1.0))
    p = ends[a, 0] + u[a] * s[a, b][:, None]
    q = others[b, 0] + v[b] * t[a, b][:, None]
    radii = (first.radius, second.radius)
    return _between(EE, np.stack([a, b], axis=1), p, q, radii)


def nothing() -> Sites:
    """No sites."""
    empty = np.zeros((0, 3))
    return Sites(
        np.zeros(0, np.int64), np.zeros((0, 2), np.int64), np.zeros(0), empty, empty.copy()
    )


def edge_between(solid: Solid, a: int, b: int) -> int:
    """Number of the edge between two vertices of a body, or -1."""
    edges = solid.shape.edges
    found = np.flatnonzero(
        ((edges[:, 0] == a) & (edges[:, 1] == b)) | ((edges[:, 0] == b) & (edges[:, 1] == a))
    )
    return int(found[0]) if len(found) else -1


def crossings(first: Solid, second: Solid, wanted: set[tuple[int, int]]) -> Sites:
    """Crossings of the named pairs of edges."""
    every = _edge_edge(first, second)
    chosen = [k for k, (a, b) in enumerate(every.features) if (int(a), int(b)) in wanted]
    return every[np.array(chosen, dtype=np.int64)]
