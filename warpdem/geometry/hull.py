"""Convex hulls of points in space: quickhull whose decisions are exact.

A point is added when it lies clearly outside, and then hides every facet whose plane it lies on or
above. That is decided in whole numbers where doubles cannot tell, so that what is hidden is one
connected patch whose rim is strictly convex: no facet without area is made, however many points
share a plane or line.

Source: Barber, Dobkin & Huhdanpaa (1996), doi:10.1145/235815.235821, for the order of the points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray

TOLERANCE = 1e-7
"""How far points may lie outside their hull, over the size of the cloud: files are often in single
precision."""

_FLAT = 1e-6  # of the size: the least thickness of a solid
_DOUBT = 1e-13  # bound of the rounding of a determinant of coordinates up to 1


def convex_hull(points: FloatArray) -> IntArray:
    """Facets of the convex hull, outward counter-clockwise, shape [facet_count, 3].

    Facets in one plane stay apart. No point lies outside by more than ``TOLERANCE``, and those
    that do by less than that need not be corners.

    Args:
        points: Positions, in any order, repeated ones too, shape [point_count, 3].

    Raises:
        GeometryError: There is no solid: too few points, or all near one plane.
    """
    if len(points) < 4:
        raise GeometryError(f"a solid needs four points at least, not {len(points)}")
    if not np.isfinite(points).all():
        bad = int(np.argmin(np.isfinite(points).all(axis=1)))
        raise GeometryError(f"point {bad} is not finite: {points[bad].tolist()}")
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    if not size > 0.0:
        raise GeometryError("all points are one; check the file's columns")
    return _Hull((points - 0.5 * (low + high)) / size).facets


class _Hull:
    """A growing hull of points in a unit cube.

    Attributes:
        facets: Corners, outward, shape [facet_count, 3].
    """

    def __init__(self, points: FloatArray) -> None:
        self._points = points
        self._numbers: dict[int, tuple[int, int, int]] = {}
        self.facets = self._start()
        self._normals = self._normals_of(self.facets)
        # what each point sees best: how high it stands over which facet
        self._left = np.arange(len(points))
        self._height, self._best = self._seen(self._left, 0)
        self._drop()
        while len(self._left):
            self._add(int(self._left[np.argmax(self._height)]))

    def _start(self) -> IntArray:
        """A large tetrahedron."""
        points = self._points
        a = int(np.argmin(points[:, np.argmax(np.ptp(points, axis=0))]))
        away = points - points[a]
        b = int(np.argmax((away**2).sum(axis=1)))
        along = away[b] / np.linalg.norm(away[b])
        off = np.cross(away, along)
        c = int(np.argmax((off**2).sum(axis=1)))
        normal = np.cross(away[b], away[c])
        length = float(np.linalg.norm(normal))
        thick = away @ (normal / length) if length > _FLAT else np.zeros(len(points))
        d = int(np.argmax(np.abs(thick)))
        if abs(thick[d]) <= _FLAT:
            what = "plane" if length > _FLAT else "straight line"
            raise GeometryError(f"all points lie on one {what}: they span no solid")
        if thick[d] > 0.0:
            b, c = c, b
        return np.array([[a, b, c], [a, d, b], [b, d, c], [c, d, a]])

    def _normals_of(self, facets: IntArray) -> FloatArray:
        a, b, c = (self._points[facets[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    def _seen(self, points: IntArray, first: int) -> tuple[FloatArray, IntArray]:
        """Greatest height of points over the facets from ``first`` on, and over which."""
        normals = self._normals[first:]
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        base = self._points[self.facets[first:, 0]]
        offset = np.einsum("ij,ij->i", normals, base)
        height, best = np.empty(len(points)), np.empty(len(points), np.int64)
        block = max(1, 4_000_000 // max(1, len(normals)))
        for start in range(0, len(points), block):
            part = slice(start, start + block)
            above = self._points[points[part]] @ normals.T - offset
            best[part] = above.argmax(axis=1)
            height[part] = above[np.arange(len(above)), best[part]]
        return height, best + first

    def _drop(self) -> None:
        """Forget the points inside."""
        kept = self._height > TOLERANCE
        self._left, self._height = self._left[kept], self._height[kept]
        self._best = self._best[kept]

    def _add(self, point: int) -> None:
        hidden = self._is_hidden(point)
        rim = self._rim(hidden)
        new = np.column_stack([rim, np.full(len(rim), point)])
        number = np.cumsum(~hidden) - 1
        self.facets = np.concatenate([self.facets[~hidden], new])
        self._normals = np.concatenate([self._normals[~hidden], self._normals_of(new)])
        lost = hidden[self._best]
        self._best = number[self._best]
        self._height[lost], self._best[lost] = self._seen(self._left[lost], 0)
        self._height[self._left == point] = 0.0
        self._drop()

    def _is_hidden(self, point: int) -> BoolArray:
        """Facets whose plane a point lies on or above, shape [facet_count]."""
        away = self._points[point] - self._points[self.facets[:, 0]]
        volume = np.einsum("ij,ij->i", self._normals, away)
        hidden = volume > 0.0
        for facet in np.flatnonzero(np.abs(volume) <= _DOUBT).tolist():
            hidden[facet] = self._exact_volume(facet, point) >= 0
        return hidden

    def _exact_volume(self, facet: int, point: int) -> int:
        """Six times the volume between facet and point, in a very small unit."""
        a, b, c, d = (self._whole(k) for k in (*self.facets[facet].tolist(), point))
        (ux, uy, uz), (vx, vy, vz), (wx, wy, wz) = (
            (x - a[0], y - a[1], z - a[2]) for x, y, z in (b, c, d)
        )
        return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz

    def _whole(self, point: int) -> tuple[int, int, int]:
        """Coordinates times 2^1074: every double is then a whole number."""
        if point not in self._numbers:
            ratios = [float(x).as_integer_ratio() for x in self._points[point]]
            x, y, z = ((top << 1074) // bottom for top, bottom in ratios)
            self._numbers[point] = x, y, z
        return self._numbers[point]

    def _rim(self, hidden: BoolArray) -> IntArray:
        """Sides of hidden facets along facets that are not, shape [side_count, 2]."""
        start = self.facets[hidden].reshape(-1)
        end = np.roll(self.facets[hidden], -1, axis=1).reshape(-1)
        count = len(self._points)
        inner = np.isin(start * count + end, end * count + start)
        return np.column_stack([start, end])[~inner]
