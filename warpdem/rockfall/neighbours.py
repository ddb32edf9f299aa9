"""Largest values among neighbouring cells."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray

REACH = 2
"""Cells around a cell over which its largest slope is taken: beyond, a jump must end."""


def around(values: FloatArray, reach: int) -> FloatArray:
    """Largest value within ``reach`` rows and columns of each entry; shape as ``values``."""
    for axis in (0, 1):
        wide = [(0, 0), (0, 0)]
        wide[axis] = (reach, reach)
        padded = np.pad(values, wide, mode="edge")
        windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=axis)
        values = windows.max(axis=-1)
    return values
