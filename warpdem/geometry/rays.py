"""Triangular cells of the rays that sweep the rounding of a core: where they begin and point."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.geometry.core import Core

# corners' weights and weight of the rule of degree 5 with 7 points, Radon (1948),
# doi:10.1007/BF01525334; then points just inside the corners, of no weight, to see where rays begin
# to be cut short (at a corner itself an adjoining triangle is at no distance)
_NEAR = [(6.0 - np.sqrt(15.0)) / 21.0, (6.0 + np.sqrt(15.0)) / 21.0]
_POINTS = np.array(
    [[1.0 / 3.0] * 3]
    + [
        [1.0 - 2.0 * x if k == corner else x for k in range(3)]
        for x in _NEAR
        for corner in range(3)
    ]
    + (1e-4 + (1.0 - 3e-4) * np.eye(3)).tolist()
)
_WEIGHTS = np.repeat([270.0, 155.0 - np.sqrt(15.0), 155.0 + np.sqrt(15.0), 0.0], [1, 3, 3, 3])
_WEIGHTS /= 1200.0
SAMPLES = len(_WEIGHTS)


@dataclass(frozen=True, eq=False)
class Cells:
    """Triangles of parameters, each of the same kind.

    A cell of a face (order 0) lies on it, all rays along frame[0]. One of an edge (order 1) holds
    s, phi, 0: rays begin at frame[0] + s frame[1] along cos(phi) frame[2] + sin(phi) frame[3].
    One of a vertex (order 2) is seen from it as its rays are; they begin at frame[0].

    Attributes:
        order: Power of the distance in a ray's volume element.
        corners: Shape [cell_count, 3, 3].
        frame: Shape [cell_count, 4, 3].
        start: First triangle of each cell, shape [cell_count + 1].
        triangles: Those that may cut its rays short, shape [triangle_count].
    """

    order: int
    corners: FloatArray
    frame: FloatArray
    start: IntArray
    triangles: IntArray

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.corners)

    @cached_property
    def owner(self) -> IntArray:
        """Cell of each of the triangles."""
        return np.repeat(np.arange(self.count), np.diff(self.start))

    def rays(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Origins and directions at parameters, shapes [cell_count, n, 3]."""
        frame = self.frame[:, :, None]
        origin = np.broadcast_to(frame[:, 0], points.shape)
        if self.order == 0:
            return points, origin
        if self.order == 1:
            turn = points[..., 1, None]
            direction = np.cos(turn) * frame[:, 2] + np.sin(turn) * frame[:, 3]
            return origin + points[..., :1] * frame[:, 1], direction
        return origin, points / np.linalg.norm(points, axis=-1, keepdims=True)

    @cached_property
    def corner_rays(self) -> tuple[FloatArray, FloatArray]:
        """Origins and directions at the corners, shapes [cell_count, 3, 3]."""
        return self.rays(self.corners)

    @cached_property
    def measure(self) -> FloatArray:
        """Area of the triangles of parameters, shape [cell_count]."""
        a, b, c = (self.corners[:, k] for k in range(3))
        return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)

    @cached_property
    def samples(self) -> tuple[FloatArray, FloatArray]:
        """Parameters and weights of a quadrature, shapes [cell_count, n, 3] and [cell_count, n]."""
        points = np.einsum("qk,nki->nqi", _POINTS, self.corners)
        weights = self.measure[:, None] * _WEIGHTS
        if self.order == 2:  # solid angle of a flat triangle's element
            a, b, c = (self.corners[:, k] for k in range(3))
            height = np.abs(np.einsum("ij,ij->i", a, np.cross(b - a, c - a)))
            # a triangle without area weighs nothing
            height /= np.maximum(2.0 * self.measure, np.finfo(float).tiny)
            weights = weights * height[:, None] / np.linalg.norm(points, axis=-1) ** 3
        return points, weights

    @cached_property
    def scale(self) -> FloatArray:
        """Size of 1, x, y, z, xx, xy, ... zz where the rays begin, shape [cell_count, 10]."""
        place = np.linalg.norm(self.corner_rays[0], axis=2).max(axis=1)
        return place[:, None] ** np.repeat([0, 1, 2], [1, 3, 6])

    @cached_property
    def spread(self) -> FloatArray:
        """Cosine of the widest angle between directions at corners, shape [cell_count]."""
        _, direction = self.corner_rays
        return np.einsum("nki,nki->nk", direction, np.roll(direction, 1, axis=1)).min(axis=1)

    def ends(self, radius: float) -> tuple[FloatArray, FloatArray]:
        """Balls that hold the centres x + R n of the rays' balls: centres and radii.

        Directions between the corners' bulge beyond their hull by no more than R (1 - cos a), a
        the widest angle between two of them.
        """
        base, direction = self.corner_rays
        end = base + radius * direction
        centre = end.mean(axis=1)
        reach = np.linalg.norm(end - centre[:, None], axis=-1).max(axis=1)
        return centre, reach + radius * (1.0 - self.spread)

    def rise(self, chosen: IntArray, triangles: FloatArray) -> FloatArray:
        """Upper bound of n . (y - x) over the rays of cells and the points y of triangles.

        Directions between the corners' are sums of theirs, over lengths down to
        sqrt((1 + 2 cos a) / 3).

        Args:
            chosen: Number of a cell for each triangle, shape [n].
            triangles: Shape [n, 3, 3].
        """
        base, direction = (rays[chosen] for rays in self.corner_rays)
        offset = triangles[:, None] - base[:, :, None]
        rise = np.einsum("nijk,nik->nij", offset, direction).max(axis=(1, 2))
        return rise / np.sqrt(np.maximum(1.0 + 2.0 * self.spread[chosen], 0.03) / 3.0)

    def is_coarse(self, radius: float) -> FloatArray:
        """Cells so wide that samples might miss a feature, shape [cell_count]."""
        base, direction = self.corner_rays
        length = np.linalg.norm(base - np.roll(base, 1, axis=1), axis=-1).max(axis=1)
        turn = np.linalg.norm(direction - np.roll(direction, 1, axis=1), axis=-1).max(axis=1)
        return np.maximum(length / radius, 2.0 * turn) > 1.5

    def halved(self, radius: float) -> Cells:
        """Two cells for each, one after the other, with its triangles: the longest side is cut."""
        scale = np.array([1.0, radius, 1.0]) if self.order == 1 else np.ones(3)
        sides = (np.roll(self.corners, -1, axis=1) - self.corners) * scale
        first = np.linalg.norm(sides, axis=2).argmax(axis=1)
        turn = (first[:, None] + np.arange(3)) % 3
        a, b, c = np.take_along_axis(self.corners, turn[:, :, None], axis=1).transpose(1, 0, 2)
        middle = 0.5 * (a + b)
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        length = np.repeat(np.diff(self.start), 2)
        start = np.concatenate([[0], np.cumsum(length)])
        inside = np.arange(start[-1]) - np.repeat(start[:-1], length)
        return Cells(
            self.order,
            np.stack(halves, axis=1).reshape(-1, 3, 3),
            np.repeat(self.frame, 2, axis=0),
            start,
            self.triangles[np.repeat(np.repeat(self.start[:-1], 2), length) + inside],
        )

    def rows(self, chosen: IntArray) -> Cells:
        """Only the cells ``chosen``, rising numbers."""
        length = np.diff(self.start)
        kept = np.zeros(self.count, bool)
        kept[chosen] = True
        return Cells(
            self.order,
            self.corners[chosen],
            self.frame[chosen],
            np.concatenate([[0], np.cumsum(length[chosen])]),
            self.triangles[kept[self.owner]],
        )

    def with_triangles(self, cell: IntArray, triangle: IntArray) -> Cells:
        """The cells with the triangles given by pairs sorted by cell."""
        count = np.bincount(cell, minlength=self.count)
        start = np.concatenate([[0], np.cumsum(count)])
        return Cells(self.order, self.corners, self.frame, start, triangle)


def _fresh(order: int, corners: FloatArray, frame: FloatArray) -> Cells:
    none = np.zeros(0, np.int64)
    return Cells(order, corners, frame, np.zeros(len(corners) + 1, np.int64), none)


def face_cells(core: Core, triangles: IntArray, face: IntArray, radius: float) -> Cells:
    """Cells of the faces, on both sides of an open core.

    They are cut where the rays are as near to a neighbour across a concave edge as they are long.

    Args:
        core: The core.
        triangles: Its faces cut up, shape [triangle_count, 3].
        face: The face of each, shape [triangle_count].
        radius: Length of the rays.
    """
    parts = [
        _cut_at_folds(core, core.vertices[triangles], face, side * core.normals, side * radius)
        for side in ((1.0,) if core.closed else (1.0, -1.0))
    ]
    corners, normals = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return _fresh(0, corners, np.repeat(normals[:, None], 4, axis=1))


def _cut_at_folds(
    core: Core, corners: FloatArray, face: IntArray, normals: FloatArray, radius: float
) -> tuple[FloatArray, FloatArray]:
    """Triangles on faces cut along the lines where a neighbour's plane is at |radius| from rays.

    With N the neighbour's normal and a on its plane: N . (x - a) = R (1 - n . N). A negative
    radius stands for the lower side of an open core.
    """
    folds = np.flatnonzero((core.twin >= 0) & (core.side_angles * radius < 0.0))
    own, other = core.facets.owner[folds], core.facets.owner[core.twin[folds]]
    shift = abs(radius) * (1.0 - np.einsum("ij,ij->i", normals[own], normals[other]))
    base = core.vertices[core.facets.sides[folds, 0]]
    offset = np.einsum("ij,ij->i", base, normals[other]) + shift
    rank = np.arange(len(own)) - np.searchsorted(own, own)
    for turn in range(int(rank.max(initial=-1)) + 1):
        fold = np.full(core.facets.count, -1)
        fold[own[rank == turn]] = np.flatnonzero(rank == turn)
        line = fold[face]
        height = np.einsum("nki,ni->nk", corners, normals[other[line]]) - offset[line, None]
        height[line < 0] = 1.0
        corners, face = _cut(corners, face, height)
    return corners, normals[face]


def _cut(corners: FloatArray, face: IntArray, height: FloatArray) -> tuple[FloatArray, IntArray]:
    """Triangles cut where a linear function, given at their corners, changes sign."""
    above = height > 0.0
    crossed = above.any(axis=1) & ~above.all(axis=1)
    lone = np.where(above.sum(axis=1) == 1, above.argmax(axis=1), (~above).argmax(axis=1))
    turn = (lone[:, None] + np.arange(3))[crossed] % 3
    a, b, c = np.take_along_axis(corners[crossed], turn[:, :, None], axis=1).transpose(1, 0, 2)
    u, v, w = np.take_along_axis(height[crossed], turn, axis=1).T
    ab = a + (u / (u - v))[:, None] * (b - a)
    ac = a + (u / (u - w))[:, None] * (c - a)
    pieces = [np.stack(piece, axis=1) for piece in ((a, ab, ac), (ab, b, c), (ab, c, ac))]
    return (
        np.concatenate([corners[~crossed], *pieces]),
        np.concatenate([face[~crossed], *[face[crossed]] * 3]),
    )


def edge_cells(core: Core) -> Cells:
    """Cells of the edges, none wider than an eighth of a turn."""
    arcs = core.edge_arcs
    along = core.vertices[arcs.ends[:, 1]] - core.vertices[arcs.ends[:, 0]]
    length = np.linalg.norm(along, axis=1)
    along = _unit(along)
    frame = np.stack(
        [core.vertices[arcs.ends[:, 0]], along, arcs.middle, np.cross(along, arcs.middle)], axis=1
    )
    count = np.maximum(1, np.ceil(2.0 * arcs.half / (0.25 * np.pi) - 1e-9)).astype(np.int64)
    edge = np.repeat(np.arange(len(count)), count)
    step = 2.0 * arcs.half[edge] / count[edge]
    low = -arcs.half[edge] + step * (
        np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    )
    zero, far = np.zeros(len(edge)), length[edge]
    corner = [
        np.column_stack([s, phi, zero])
        for s, phi in ((zero, low), (far, low), (far, low + step), (zero, low + step))
    ]
    halves = [np.stack([corner[0], corner[k], corner[k + 1]], axis=1) for k in (1, 2)]
    return _fresh(1, np.concatenate(halves), np.concatenate([frame[edge]] * 2))


def cap_cells(core: Core) -> Cells:
    """Cells of the vertices: triangles from the middle of each normal cone to its arcs."""
    plain = _plain_cap_cells(core)
    corners, vertex = [], []
    for number, cap in core.caps:
        middle = _unit(-cap.angles @ cap.outward)
        after = np.roll(cap.corners, -1, axis=0)
        corners += [np.array([middle, a, b]) for a, b in zip(cap.corners, after, strict=True)]
        vertex += [number] * len(after)
    signs = np.array([[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)], float)
    octants = signs[:, :, None] * np.eye(3)
    for number in core.points.tolist():
        corners += list(octants)
        vertex += [number] * len(octants)
    at = np.concatenate([plain[1], np.array(vertex, np.int64)])
    frame = np.repeat(core.vertices[at][:, None], 4, axis=1)
    return _fresh(2, np.concatenate([plain[0], np.array(corners).reshape(-1, 3, 3)]), frame)


def _plain_cap_cells(core: Core) -> tuple[FloatArray, IntArray]:
    """Triangles and vertices of the cells of plain vertices, whose arcs are their edges'."""
    arcs = core.edge_arcs
    along = _unit(core.vertices[arcs.ends[:, 1]] - core.vertices[arcs.ends[:, 0]])
    middle = np.zeros_like(core.vertices)
    for end, away in ((0, along), (1, -along)):
        np.add.at(middle, arcs.ends[:, end], -arcs.half[:, None] * away)
    across = np.sin(arcs.half)[:, None] * np.cross(along, arcs.middle)
    onward = np.cos(arcs.half)[:, None] * arcs.middle
    triangles, vertices = [], []
    for end in (0, 1):
        at = arcs.ends[:, end]
        rows = core.plain_vertices[at]
        rim = [_unit(middle[at[rows]]), (onward - across)[rows], (onward + across)[rows]]
        triangles.append(np.stack(rim, axis=1))
        vertices.append(at[rows])
    return np.concatenate(triangles), np.concatenate(vertices)


def _unit(vectors: FloatArray) -> FloatArray:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
