"""Cells of a grid near others: the largest value among them, which lie near a line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.site import Grid


REACH = 2
"""Cells around a cell over which its largest slope is taken: beyond, a jump must end."""


def around(values: np.ndarray, reach: int) -> np.ndarray:
    """Largest value within ``reach`` rows and columns of each entry; shape and type as ``values``.

    Of truths: whether any of them is true.
    """
    for axis in (0, 1):
        wide = [(0, 0), (0, 0)]
        wide[axis] = (reach, reach)
        padded = np.pad(values, wide, mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=axis)
        values = windows.max(axis=-1)
    return values


def cells_near(grid: Grid, line: FloatArray, distance: float) -> IntArray:
    """Numbers of all cells with a point within ``distance`` of a point or segment, and some more.

    Args:
        grid: The cells.
        line: The point, shape [1, 2], or the ends of the segment, shape [2, 2] [m].
        distance: [m].
    """
    low = np.floor((line.min(axis=0) - distance - (grid.x, grid.y)) / grid.cell).astype(int)
    high = np.floor((line.max(axis=0) + distance - (grid.x, grid.y)) / grid.cell).astype(int)
    low, high = np.maximum(low, 0), np.minimum(high, (grid.columns - 1, grid.rows - 1))
    column, row = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    centre = np.stack([column, row], axis=-1) * grid.cell + (
        grid.x + 0.5 * grid.cell,
        grid.y + 0.5 * grid.cell,
    )
    along = line[-1] - line[0]
    length = along @ along
    part = np.clip((centre - line[0]) @ along / length, 0.0, 1.0) if length else 0.0
    nearest = line[0] + np.multiply.outer(part, along)
    away = np.linalg.norm(centre - nearest, axis=-1)
    near = away <= distance + grid.cell * np.sqrt(0.5)
    return (row * grid.columns + column)[near]
