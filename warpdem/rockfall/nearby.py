"""Which cells of a grid lie near something."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.rockfall.site import Grid


def dilated(found: BoolArray, span: int) -> BoolArray:
    """Cells with one that is ``found`` among those up to ``span`` cells away along each axis."""
    grown = np.pad(found, span)
    for axis in (0, 1):
        length = found.shape[axis]
        shifts = [np.take(grown, range(k, k + length), axis=axis) for k in range(2 * span + 1)]
        grown = np.any(shifts, axis=0)
    return grown


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
