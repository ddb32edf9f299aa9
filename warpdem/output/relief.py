"""The ground as a picture: heights in a window, lit from the north-west."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.rockfall.site import Grid, Ground, Site

FINEST = 1200
"""Heights along the longer side of a window at most; more are not seen."""

_SUNS = ((315.0, 0.55), (270.0, 0.15), (0.0, 0.15), (225.0, 0.15))  # azimuth, share of the light
_ALTITUDE = np.radians(45.0)


@dataclass(frozen=True)
class Window:
    """A piece of the plan, local [m]."""

    west: float
    east: float
    south: float
    north: float


@dataclass(frozen=True, eq=False)
class Relief:
    """Heights at nodes within a window.

    Attributes:
        x, y: Of columns and rows, rising, local [m].
        heights: National [m], NaN without data, shape [row_count, column_count].
    """

    x: FloatArray
    y: FloatArray
    heights: FloatArray

    def shade(self) -> FloatArray:
        """Light on the ground from 0 to 1, NaN without data; shape as ``heights``."""
        rise_y, rise_x = np.gradient(self.heights, self.y, self.x)
        upright = 1.0 / np.sqrt(1.0 + rise_x**2 + rise_y**2)
        light = np.zeros_like(self.heights)
        for azimuth, share in _SUNS:
            east, north = np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))
            across = np.cos(_ALTITUDE) * (east * rise_x + north * rise_y)
            light += share * np.clip((np.sin(_ALTITUDE) - across) * upright, 0.0, 1.0)
        return _stretched(light)


def _stretched(light: FloatArray) -> FloatArray:
    """Light spread from 0 to 1: a slope in the shade would be black all over."""
    known = light[np.isfinite(light)]
    if not len(known):
        return light
    dark, bright = np.percentile(known, [2.0, 98.0])
    spread = max(float(bright - dark), 0.2)  # a plane stays grey
    return np.clip(0.5 + (light - 0.5 * (dark + bright)) / spread, 0.0, 1.0)


def relief(site: Site, window: Window) -> Relief | None:
    """Heights within a window; None if the ground has fewer than two by two nodes there."""
    ground = site.ground
    x, y, heights = _nodes(ground) if ground.heights is not None else _sampled(ground, site.results)
    columns = np.flatnonzero((x >= window.west) & (x <= window.east))
    rows = np.flatnonzero((y >= window.south) & (y <= window.north))
    if min(len(rows), len(columns)) < 2:
        return None
    every = -(-max(len(rows), len(columns)) // FINEST)
    rows, columns = rows[::every], columns[::every]
    return Relief(x[columns], y[rows], heights[np.ix_(rows, columns)] + site.origin[2])


def _nodes(ground: Ground) -> tuple[FloatArray, FloatArray, FloatArray]:
    assert ground.heights is not None
    rows, columns = ground.heights.shape
    grid = ground.grid
    x, y = grid.x + grid.cell * np.arange(columns), grid.y + grid.cell * np.arange(rows)
    return x, y, ground.heights


def _sampled(ground: Ground, grid: Grid) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Heights of triangles under the middles of the cells."""
    x = grid.x + grid.cell * (np.arange(grid.columns, dtype=np.float64) + 0.5)
    y = grid.y + grid.cell * (np.arange(grid.rows, dtype=np.float64) + 0.5)
    plan_x, plan_y = np.meshgrid(x, y)
    heights = ground.height(plan_x.ravel(), plan_y.ravel())
    return x, y, heights.reshape(plan_x.shape)
