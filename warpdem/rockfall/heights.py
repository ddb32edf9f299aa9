"""The ground as a raster: its heights, where they are known, how steep they are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.rockfall import facets
from warpdem.rockfall.nearby import REACH, around
from warpdem.rockfall.site import Grid, Ground

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.geometry.terrain import Raster


def origin_of(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """The local origin: the lower-left corner and the lowest height, as whole metres [m].

    Differences to whole metres of the same size are exact in floating point.

    Raises:
        GeometryError: There is no height at all.
    """
    if not np.isfinite(z).any():
        raise GeometryError("there are no heights at all, nothing but nodata")
    return np.floor([np.min(x), np.min(y), np.nanmin(z)])


def raster_ground(raster: Raster, origin: FloatArray) -> Ground:
    """The bilinear ground through the nodes of a raster.

    Args:
        raster: In national coordinates.
        origin: Of the local ones, shape [3].

    Raises:
        GeometryError: No cell has heights at its four corners.
    """
    heights = raster.heights[::-1] - origin[2]
    rows, columns = heights.shape
    west, south = float(raster.x[0] - origin[0]), float(raster.y[-1] - origin[1])
    grid = Grid(west, south, raster.cell, rows - 1, columns - 1)
    finite = np.isfinite(heights)
    known = finite[:-1, :-1] & finite[:-1, 1:] & finite[1:, :-1] & finite[1:, 1:]
    if not known.any():
        raise GeometryError("no cell of the raster has heights at its four corners")
    steep = around(np.where(known, corner_slope(heights, raster.cell), 0.0), REACH)
    return Ground(grid, np.ascontiguousarray(heights), None, known, steep, REACH * raster.cell)


def corner_slope(heights: FloatArray, cell: float) -> FloatArray:
    """Largest slope of the bilinear patch of each cell, shape [rows, columns].

    The gradient along x goes linearly from the southern to the northern edge, that along y from
    the western to the eastern one: both are largest at corners, and all four pairs are corners.

    Args:
        heights: At the nodes [m], shape [rows + 1, columns + 1].
        cell: Edge length [m].
    """
    along_x = np.abs(np.diff(heights, axis=1)) / cell
    along_y = np.abs(np.diff(heights, axis=0)) / cell
    return np.hypot(
        np.maximum(along_x[:-1], along_x[1:]), np.maximum(along_y[:, :-1], along_y[:, 1:])
    )


def height_at(ground: Ground, x: FloatArray, y: FloatArray) -> FloatArray:
    """Height of the ground under points [m], NaN where there is none.

    Args:
        ground: A raster, or triangles.
        x: Local coordinates [m], any shape.
        y: The others, of the same shape.
    """
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    if ground.facets is not None:
        plan = facets.height_at(ground.facets, ground.grid, x.reshape(-1), y.reshape(-1))
        return plan.reshape(x.shape)
    (southwest, southeast, northwest, northeast), a, b, inside = _patches(ground, x, y)
    west = (1.0 - b) * southwest + b * northwest
    east = (1.0 - b) * southeast + b * northeast
    return np.where(inside, (1.0 - a) * west + a * east, np.nan)


def slopes_at(ground: Ground, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slopes dh/dx and dh/dy [-] of the ground under points, NaN where there is none.

    Those of the bilinear patch or of the triangle below; the shape is that of the points.

    Args:
        ground: A raster, or triangles.
        x: Local coordinates [m], any shape.
        y: The others, of the same shape.
    """
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    if ground.facets is not None:
        found = facets.slopes_at(ground.facets, ground.grid, x.reshape(-1), y.reshape(-1))
        return found[:, 0].reshape(x.shape), found[:, 1].reshape(x.shape)
    (southwest, southeast, northwest, northeast), a, b, inside = _patches(ground, x, y)
    along_x = (1.0 - b) * (southeast - southwest) + b * (northeast - northwest)
    along_y = (1.0 - a) * (northwest - southwest) + a * (northeast - southeast)
    east, north = (np.where(inside, rise / ground.grid.cell, np.nan) for rise in (along_x, along_y))
    return east, north


def _patches(
    ground: Ground, x: FloatArray, y: FloatArray
) -> tuple[tuple[FloatArray, ...], FloatArray, FloatArray, BoolArray]:
    """Patches under points: heights at their corners, places in them 0 to 1, whether there is one.

    The corners lie southwest, southeast, northwest, northeast; all arrays have the points' shape.
    """
    heights, grid = ground.heights, ground.grid
    assert heights is not None
    along, up = (x - grid.x) / grid.cell, (y - grid.y) / grid.cell
    inside = (along >= 0.0) & (along <= grid.columns) & (up >= 0.0) & (up <= grid.rows)
    along, up = np.where(inside, along, 0.0), np.where(inside, up, 0.0)
    # the last node belongs to the last cell
    column = np.minimum(np.floor(along).astype(np.int64), grid.columns - 1)
    row = np.minimum(np.floor(up).astype(np.int64), grid.rows - 1)
    corners = tuple(heights[row + j, column + i] for j in (0, 1) for i in (0, 1))
    return corners, along - column, up - row, inside
