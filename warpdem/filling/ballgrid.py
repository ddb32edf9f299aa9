"""Finding the balls that a point is near."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.boxgrid import expanded

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray

_FINE = 200_000  # balls up to which cells are small: 125 entries a ball, a third of the tests
_MOST_CELLS = 10_000_000


class BallGrid:
    """Balls sorted into the cells from whose points they are within reach.

    Args:
        centres: Shape [ball_count, 3].
        reach: Distance within which each ball is to be found, shape [ball_count].
    """

    def __init__(self, centres: FloatArray, reach: FloatArray) -> None:
        low, high = centres - reach[:, None], centres + reach[:, None]
        self._origin = low.min(axis=0)
        span = high.max(axis=0) - self._origin
        self._cell = float(reach.mean()) * (0.5 if len(centres) <= _FINE else 1.0)
        self._cell = max(self._cell, float((span.prod() / _MOST_CELLS) ** (1.0 / 3.0)))
        self._shape = np.floor(span / self._cell).astype(np.int64) + 1
        ball, cell = expanded(self._cell_of(low), self._cell_of(high))
        key = self._key(cell)
        self._balls = ball[np.argsort(key, kind="stable")]
        self._start = np.concatenate(
            [[0], np.cumsum(np.bincount(key, minlength=int(self._shape.prod())))]
        )

    def _cell_of(self, points: FloatArray) -> IntArray:
        return np.floor((points - self._origin) / self._cell).astype(np.int64)

    def _key(self, cell: IntArray) -> IntArray:
        _, ny, nz = self._shape
        return (cell[:, 0] * ny + cell[:, 1]) * nz + cell[:, 2]

    def near(self, points: FloatArray) -> tuple[IntArray, IntArray]:
        """Numbers of a point and of a ball that may be within its reach, by point."""
        cell = self._cell_of(points)
        point = np.flatnonzero(((cell >= 0) & (cell < self._shape)).all(axis=1))
        if not len(point):
            return point, point
        key = self._key(cell[point])
        begin, count = self._start[key], self._start[key + 1] - self._start[key]
        slot = np.repeat(begin - np.cumsum(count) + count, count) + np.arange(count.sum())
        return np.repeat(point, count), self._balls[slot]
