"""Directions from azimuth and dip, without a library's sine: every machine rounds them alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray

_RADIAN = 0.017453292519943295  # of a degree
# Taylor series up to x^17 and x^18: what is left out at 45 degrees is below 1e-19
_SINE = (1.0, *(1.0 / (-2 * k * (2 * k + 1)) for k in range(1, 9)))
_COSINE = (1.0, *(1.0 / (-2 * k * (2 * k - 1)) for k in range(1, 10)))


def direction(azimuth: FloatArray, dip: FloatArray) -> FloatArray:
    """Unit vectors with x to the east, y to the north, z up; shape [n, 3].

    Args:
        azimuth: Clockwise from north [degrees], shape [n].
        dip: Below the horizontal [degrees], shape [n].
    """
    east, north = sine_cosine(azimuth)
    down, level = sine_cosine(dip)
    return np.column_stack([east * level, north * level, 0.0 - down])


def sine_cosine(angle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Sine and cosine of angles in degrees, to an error below 1e-15; exact at right angles."""
    angle = np.fmod(np.asarray(angle, float), 360.0)
    quarter = np.rint(angle / 90.0)
    x = (angle - 90.0 * quarter) * _RADIAN
    sine, cosine = x * _series(_SINE, x * x), _series(_COSINE, x * x)
    turn = quarter.astype(np.int64) % 4
    return (
        np.choose(turn, [sine, cosine, -sine, -cosine]),
        np.choose(turn, [cosine, -sine, -cosine, sine]),
    )


def _series(factors: tuple[float, ...], square: FloatArray) -> FloatArray:
    """1 + f1 s (1 + f2 s (1 + ...))."""
    total = np.ones_like(square)
    for factor in factors[:0:-1]:
        total = 1.0 + factor * square * total
    return total
