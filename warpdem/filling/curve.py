"""The order of bodies along a curve that fills space: neighbours in space are so in memory too."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray

# cells of the curve along each axis: 2 to this power
BITS = 21


def along_curve(position: FloatArray) -> IntArray:
    """Numbers of bodies in the order of Morton's curve through their places, shape [count].

    Args:
        position: Centres [m], shape [count, 3].
    """
    if not len(position):
        return np.zeros(0, dtype=np.int64)
    low = position.min(axis=0)
    extent = float(np.ptp(position, axis=0).max())
    share = (position - low) / extent if extent > 0.0 else np.zeros_like(position)
    cell = np.minimum(share * 2.0**BITS, 2.0**BITS - 1.0).astype(np.uint64)
    key = _spread(cell[:, 0]) | _spread(cell[:, 1]) << np.uint64(1)
    key |= _spread(cell[:, 2]) << np.uint64(2)
    return np.argsort(key, kind="stable")


def _spread(number: np.ndarray) -> np.ndarray:
    """The bits of numbers below 2^21, two zeros between each; shape [count] uint64."""
    for shift, mask in (
        (32, 0x1F00000000FFFF),
        (16, 0x1F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    ):
        number = (number | number << np.uint64(shift)) & np.uint64(mask)
    return number
