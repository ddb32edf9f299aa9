"""Planar polygons in compressed rows, and how they hang together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Facets:
    """Planar polygons, possibly with holes, as rows of directed sides.

    Attributes:
        start: First side of each facet, and their number at the end, shape [facet_count + 1].
        sides: Vertices a, b of each side; seen against the normal the facet lies on the left of
            a -> b. Sides of one loop follow one another; shape [side_count, 2].
    """

    start: IntArray
    sides: IntArray

    @property
    def count(self) -> int:
        """Number of facets."""
        return len(self.start) - 1

    @cached_property
    def owner(self) -> IntArray:
        """Facet of each side, shape [side_count]."""
        return np.repeat(np.arange(self.count), np.diff(self.start))

    @cached_property
    def _breaks(self) -> BoolArray:
        """Whether a side is the last of its loop, shape [side_count]."""
        ends = np.zeros(len(self.sides), bool)
        ends[self.start[1:] - 1] = True
        ends[:-1] |= self.sides[:-1, 1] != self.sides[1:, 0]
        return ends

    @cached_property
    def following(self) -> IntArray:
        """Next side along the loop, shape [side_count]."""
        ends = np.flatnonzero(self._breaks)
        first = np.concatenate([[0], ends[:-1] + 1])[: len(ends)]
        following = np.arange(1, len(self.sides) + 1)
        following[ends] = first
        return following

    @cached_property
    def preceding(self) -> IntArray:
        """Previous side along the loop, shape [side_count]."""
        preceding = np.empty(len(self.sides), np.int64)
        preceding[self.following] = np.arange(len(self.sides))
        return preceding

    @cached_property
    def loop_count(self) -> IntArray:
        """Number of loops of each facet, shape [facet_count]."""
        return np.add.reduceat(self._breaks.astype(np.int64), self.start[:-1])

    def loops(self, facet: int) -> list[IntArray]:
        """Vertex loops of one facet, each in the direction of its sides."""
        rows = slice(self.start[facet], self.start[facet + 1])
        cuts = np.flatnonzero(self._breaks[rows])[:-1] + 1
        return np.split(self.sides[rows, 0], cuts)

    def reversed(self, turned: BoolArray) -> Facets:
        """The same facets, those in ``turned`` with the opposite normal.

        A loop keeps the place of its first vertex in the row.
        """
        if not turned.any():
            return self
        sides = self.sides.copy()
        first = np.flatnonzero(np.concatenate([[True], self._breaks[:-1]]))
        length = np.diff(np.append(first, len(sides)))
        begin = np.repeat(first, length)
        place = np.arange(len(sides)) - begin
        # side k of the turned loop runs between the vertices -k and -k-1 of the old one
        old = begin + (np.repeat(length, length) - 1 - place)
        rows = turned[self.owner]
        sides[rows] = self.sides[old[rows]][:, ::-1]
        return Facets(self.start, sides)

    def selected(self, kept: BoolArray) -> Facets:
        """Only the facets in ``kept``, shape [facet_count]."""
        if kept.all():
            return self
        length = np.diff(self.start)[kept]
        return Facets(
            np.concatenate([[0], np.cumsum(length)]),
            self.sides[np.repeat(kept, np.diff(self.start))],
        )


def _numbered(corner: int) -> int:
    """A vertex number; -1, which no vertex has, for what is too large to be one."""
    return corner if -(2**63) <= corner < 2**63 else -1


def facets_of(faces: Sequence[Sequence[int]] | IntArray) -> Facets:
    """Facets of one loop each.

    Args:
        faces: Vertex numbers of each polygon; an array of shape [facet_count, corner_count] when
            all have equally many.
    """
    if isinstance(faces, np.ndarray):
        length = np.full(len(faces), faces.shape[1] if faces.ndim > 1 else 0)
        corners = faces.reshape(-1).astype(np.int64)
    else:
        length = np.array([len(face) for face in faces], np.int64)
        corners = np.array([_numbered(corner) for face in faces for corner in face], np.int64)
    start = np.concatenate([[0], np.cumsum(length)]).astype(np.int64)
    following = np.arange(1, len(corners) + 1)
    following[start[1:] - 1] = start[:-1]
    return Facets(start, np.column_stack([corners, corners[following]]))


def area_vectors(vertices: FloatArray, facets: Facets) -> FloatArray:
    """Area of each facet along its normal [m^2], shape [facet_count, 3]."""
    if not facets.count:
        return np.zeros((0, 3))
    origin = vertices[facets.sides[facets.start[:-1], 0]][facets.owner]
    a = vertices[facets.sides[:, 0]] - origin
    b = vertices[facets.sides[:, 1]] - origin
    return 0.5 * np.add.reduceat(np.cross(a, b), facets.start[:-1], axis=0)


def twins(facets: Facets) -> tuple[IntArray, BoolArray]:
    """Which sides lie on one another.

    Returns:
        The only other side between the same two vertices, or -1, shape [side_count]; and whether
        more than two sides share them, shape [side_count].
    """
    sides = facets.sides.astype(np.int64)
    count = len(sides)
    if not count:
        return np.zeros(0, np.int64), np.zeros(0, bool)
    key = sides.min(axis=1) * (sides.max() + 1) + sides.max(axis=1)
    order = np.argsort(key, kind="stable")
    fresh = np.append(True, np.diff(key[order]) != 0)
    first = np.flatnonzero(fresh)
    size = np.diff(np.append(first, count))
    twin = np.full(count, -1)
    one, other = order[first[size == 2]], order[first[size == 2] + 1]
    twin[one], twin[other] = other, one
    crowded = np.zeros(count, bool)
    crowded[order] = np.repeat(size > 2, size)
    return twin, crowded


def connected(count: int, a: IntArray, b: IntArray) -> IntArray:
    """Smallest member of the connected set of each of ``count`` items, links from a to b."""
    label = np.arange(count)
    while True:
        low = np.minimum(label[a], label[b])
        linked = label.copy()
        np.minimum.at(linked, label[a], low)
        np.minimum.at(linked, label[b], low)
        while not np.array_equal(deeper := linked[linked], linked):
            linked = deeper
        if np.array_equal(linked, label):
            return label
        label = linked
