"""Space that repeats itself, for the placing of bodies."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.input.scene_cell import Cell

    Blocked = Callable[[FloatArray, FloatArray], BoolArray]


class Repeat:
    """The periods of space, before a cell deforms.

    Attributes:
        period: Along each axis, 0 where space is open [m], shape [3].
        shifts: Of the nearest images, none the first [m], shape [shift_count, 3].
    """

    def __init__(self, cell: Cell | None = None) -> None:
        axes = zip(cell.size, cell.periodic, strict=True) if cell else ()
        self.period = np.array([size * periodic for size, periodic in axes] or [0.0] * 3)
        self._middle = np.array(cell.centre if cell else (0.0, 0.0, 0.0))
        steps = [(0, 1, -1) if length else (0,) for length in self.period]
        self.shifts = np.array(list(product(*steps))) * self.period

    def spans(self, low: FloatArray, high: FloatArray) -> BoolArray:
        """Axes along which a region is as long as the cell, so that bodies may lie on its rim."""
        return (self.period > 0.0) & (high - low >= self.period * (1.0 - 1e-9))

    def wrapped(self, centres: FloatArray) -> FloatArray:
        """The same points as seen in the cell [m], shape [n, 3]."""
        period = np.where(self.period > 0.0, self.period, np.inf)
        return centres - np.floor((centres - self._middle) / period + 0.5) * self.period

    def wide_enough(self, radius: FloatArray) -> BoolArray:
        """Balls that do not meet their own images, shape [ball_count]."""
        period = np.where(self.period > 0.0, self.period, np.inf)
        return 2.0 * radius < period.min()

    def touched(self, touched: Blocked, centres: FloatArray, radii: FloatArray) -> BoolArray:
        """Balls that meet what ``touched`` says, or an image of it; shape [ball_count]."""
        met = np.zeros(len(radii), bool)
        for shift in self.shifts:
            free = np.flatnonzero(~met)
            met[free] = touched(centres[free] + shift, radii[free])
        return met

    def with_images(
        self, centres: FloatArray, low: FloatArray, high: FloatArray
    ) -> tuple[FloatArray, np.ndarray]:
        """Points and those of their images that lie in a box, the points themselves first.

        Returns:
            Places, shape [n, 3], and whose each is, shape [n].
        """
        places, whose = [centres], [np.arange(len(centres))]
        for shift in self.shifts[1:]:
            moved = centres + shift
            inside = np.flatnonzero(((moved >= low) & (moved <= high)).all(axis=1))
            places.append(moved[inside])
            whose.append(inside)
        return np.concatenate(places), np.concatenate(whose)
