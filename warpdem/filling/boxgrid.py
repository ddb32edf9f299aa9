"""Finding the boxes that meet other boxes, by a uniform grid over the first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray

_MOST_CELLS = 12  # a box on average; more would cost more to sort than they save


class BoxGrid:
    """Upright boxes sorted into the cells they touch.

    Args:
        low: Lowest corners, shape [box_count, 3].
        high: Highest corners, shape [box_count, 3].
    """

    def __init__(self, low: FloatArray, high: FloatArray) -> None:
        self._low, self._high = low, high
        self._origin = low.min(axis=0)
        span = high.max(axis=0) - self._origin
        size = float((high - low).max(axis=1).mean())
        wide = span[span > 0.0]
        # no finer than needed for one box a cell on the average
        share = float(wide.prod() / len(low)) ** (1.0 / max(1, len(wide)))
        self._cell = max(size, share, 1e-300)
        while self._cell_counts(low, high).prod(axis=1).sum() > _MOST_CELLS * len(low) + 1000:
            self._cell *= 1.5
        self._shape = np.floor(span / self._cell).astype(np.int64) + 1
        box, cell = expanded(self._cell_of(low), self._cell_of(high))
        key = self._key(cell)
        order = np.argsort(key, kind="stable")
        self._keys, self._boxes = key[order], box[order]

    def _cell_of(self, points: FloatArray) -> IntArray:
        return np.floor((points - self._origin) / self._cell).astype(np.int64)

    def _cell_counts(self, low: FloatArray, high: FloatArray) -> IntArray:
        return self._cell_of(high) - self._cell_of(low) + 1

    def _key(self, cell: IntArray) -> IntArray:
        _, ny, nz = self._shape
        return (cell[:, 0] * ny + cell[:, 1]) * nz + cell[:, 2]

    def pairs(self, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
        """Queries and boxes that meet, touching included.

        Args:
            low: Lowest corners of the queries, shape [query_count, 3].
            high: Highest corners of the queries, shape [query_count, 3].

        Returns:
            Numbers of the query and of the box of each pair, each pair once, by query.
        """
        first = np.clip(self._cell_of(low), 0, self._shape)
        last = np.clip(self._cell_of(high), -1, self._shape - 1)
        query, cell = expanded(first, last)
        key = self._key(cell)
        begin = np.searchsorted(self._keys, key, side="left")
        count = np.searchsorted(self._keys, key, side="right") - begin
        slot = np.repeat(begin - np.cumsum(count) + count, count) + np.arange(count.sum())
        box = self._boxes[slot]
        query, cell = np.repeat(query, count), np.repeat(cell, count, axis=0)
        # two boxes that share several cells are reported in the one where their overlap begins
        start = np.maximum(first[query], self._cell_of(self._low[box]))
        meet = (start == cell).all(axis=1)
        meet &= (self._low[box] <= high[query]).all(axis=1)
        meet &= (self._high[box] >= low[query]).all(axis=1)
        return query[meet], box[meet]


def expanded(first: IntArray, last: IntArray) -> tuple[IntArray, IntArray]:
    """All cells from ``first`` to ``last`` of each row: row numbers and cells."""
    size = np.maximum(last - first + 1, 0)
    count = size.prod(axis=1)
    row = np.repeat(np.arange(len(first)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    _, ny, nz = np.maximum(size[row].T, 1)
    offset = np.column_stack([place // (ny * nz), place // nz % ny, place % nz])
    return row, first[row] + offset
