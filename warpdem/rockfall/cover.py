"""Which cells of a grid lie in polygons or in the cells of a raster."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.rockfall.raster_files import value_at
from warpdem.rockfall.shapefiles import polygons_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.geometry.terrain import Raster
    from warpdem.rockfall.site import Grid


@dataclass(frozen=True, eq=False)
class Outline:
    """One polygon of a file, holes and parts included.

    Attributes:
        rings: Its borders in national coordinates, in any direction [m], each of shape [n, 2].
        attributes: Of its record, by name.
    """

    rings: tuple[FloatArray, ...]
    attributes: dict[str, Any]


def read_outlines(path: Path) -> tuple[Outline, ...]:
    """The polygons of a shapefile, in its order.

    Raises:
        GeometryError: The file cannot be read, or holds no polygons.
        WarpdemError: The extra ``geo`` is not installed.
    """
    return tuple(Outline(_rings(shape), record) for shape, record in polygons_of(path))


def _rings(shape: Any) -> tuple[FloatArray, ...]:
    corners = np.array(shape.points, np.float64)[:, :2]
    return tuple(np.split(corners, list(shape.parts)[1:]))


def inside(rings: Sequence[FloatArray], grid: Grid) -> BoolArray:
    """Cells whose centre lies within an odd number of rings, shape [rows, columns].

    A ring passes a row of centres where it changes sides; every centre to the east of that changes
    from outside to inside, or back.

    Args:
        rings: Corners of closed polygons, local [m], each of shape [n, 2].
        grid: The cells.
    """
    a = np.concatenate([np.zeros((0, 2)), *rings])
    b = np.concatenate([np.zeros((0, 2)), *(np.roll(ring, -1, axis=0) for ring in rings)])
    edge, row = _rows_passed(a[:, 1], b[:, 1], grid)
    height = grid.y + (row + 0.5) * grid.cell
    a, b = a[edge], b[edge]
    changes = (a[:, 1] <= height) != (b[:, 1] <= height)
    a, b, row, height = a[changes], b[changes], row[changes], height[changes]
    x = a[:, 0] + (height - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    column = np.ceil((x - grid.x) / grid.cell - 0.5)
    column = np.clip(column, 0, grid.columns).astype(np.int64)
    turns = np.zeros((grid.rows, grid.columns + 1), np.int64)
    np.add.at(turns, (row, column), 1)
    return np.cumsum(turns, axis=1)[:, :-1] % 2 == 1


def _rows_passed(a: FloatArray, b: FloatArray, grid: Grid) -> tuple[Any, Any]:
    """Each edge with the rows it may pass, one more at either end: numbers of both."""
    low = np.floor((np.minimum(a, b) - grid.y) / grid.cell - 0.5) - 1
    high = np.floor((np.maximum(a, b) - grid.y) / grid.cell - 0.5) + 1
    first = np.clip(low, 0, grid.rows).astype(np.int64)
    count = np.clip(high, -1, grid.rows - 1).astype(np.int64) - first + 1
    count = np.maximum(count, 0)
    edge = np.repeat(np.arange(len(a)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return edge, first[edge] + place


def values_under(raster: Raster, grid: Grid, origin: FloatArray) -> FloatArray:
    """Value of a raster (its cells' centres are its nodes) at each cell's centre, NaN outside.

    Args:
        raster: In national coordinates.
        grid: In local ones.
        origin: Of these, shape [3].
    """
    x = origin[0] + grid.x + (np.arange(grid.columns) + 0.5) * grid.cell
    y = origin[1] + grid.y + (np.arange(grid.rows) + 0.5) * grid.cell
    return value_at(raster, x[None, :], y[:, None])
