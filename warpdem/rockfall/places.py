"""Where releases start: at points in turn, along lines, in areas."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.rockfall.areas import drawn_points
from warpdem.rockfall.random import Purpose

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.areas import Area
    from warpdem.rockfall.random import Streams


@dataclass(frozen=True, eq=False)
class Points:
    """Points in turn.

    Attributes:
        position: Local x, y, z [m], z NaN where it follows from the ground, shape [count, 3].
    """

    position: FloatArray

    @property
    def count(self) -> int:
        """Number of points."""
        return len(self.position)

    @property
    def certain(self) -> FloatArray:
        """Points that must lie on the ground, local x, y, shape [n, 2]."""
        return self.position[:, :2]

    def at(self, streams: Streams, turn: IntArray) -> FloatArray:
        """Where trajectories start that come as number ``turn`` of their release, shape [n, 3]."""
        del streams  # all is said
        return self.position[turn % self.count]


@dataclass(frozen=True, eq=False)
class Line:
    """Anywhere along straight pieces.

    Attributes:
        points: Local x, y of their ends, no two alike in a row [m], shape [point_count, 2].
    """

    points: FloatArray

    @property
    def count(self) -> int:
        """1: it has no points of its own."""
        return 1

    @property
    def certain(self) -> FloatArray:
        """Points that must lie on the ground, local x, y, shape [n, 2]."""
        return self.points

    def at(self, streams: Streams, turn: IntArray) -> FloatArray:
        """As of ``Points``; z is NaN."""
        del turn  # places are drawn
        along = np.diff(self.points, axis=0)
        length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
        end = np.cumsum(length)
        way = streams.uniform(Purpose.PLACE) * end[-1]
        piece = np.minimum(np.searchsorted(end, way, side="right"), len(length) - 1)
        part = (way - (end - length)[piece]) / length[piece]
        plan = self.points[piece] + along[piece] * part[:, None]
        return np.column_stack([plan, np.full(len(plan), np.nan)])


@dataclass(frozen=True, eq=False)
class Areas:
    """Anywhere in areas.

    Attributes:
        areas: In local coordinates.
    """

    areas: tuple[Area, ...]

    @property
    def count(self) -> int:
        """1: they have no points of their own."""
        return 1

    @property
    def certain(self) -> FloatArray:
        """None: an area may reach over the edge, if nothing is drawn there."""
        return np.zeros((0, 2))

    def at(self, streams: Streams, turn: IntArray) -> FloatArray:
        """As of ``Points``; z is NaN."""
        del turn  # places are drawn
        plan = drawn_points(self.areas, streams)
        return np.column_stack([plan, np.full(len(plan), np.nan)])


def straight(points: FloatArray) -> Line:
    """The line through points, shape [n, 2].

    Raises:
        GeometryError: All of them are one.
    """
    moves = np.append(True, (np.diff(points, axis=0) != 0.0).any(axis=1))
    if moves.sum() < 2:
        raise GeometryError("all points are one: a line has a length; give points for one place")
    return Line(points[moves])


Places = Points | Line | Areas
