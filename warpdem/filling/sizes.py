"""Drawing homothety factors from the distributions a fill can ask for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.input.scene_fill import ConstantSize, LognormalSize, NormalSize, PowerSize, UniformSize

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.input.scene_fill import Size

_TABLE = 4097  # of the cumulated normal density; the quantile's error is below 1e-6 of sd
_TAIL = 9.0  # standard deviations beyond which a normal variable never lies


def largest(size: Size) -> float:
    """The largest factor a distribution can give."""
    return size.mean if isinstance(size, ConstantSize) else size.max


def drawn(size: Size, count: int, generator: np.random.Generator) -> FloatArray:
    """Independent factors, shape [count]."""
    share = generator.random(count)
    match size:
        case ConstantSize():
            return np.full(count, size.mean)
        case UniformSize():
            return size.min + share * (size.max - size.min)
        case NormalSize():
            return _cut_normal(share, size.mean, size.sd, size.min, size.max)
        case LognormalSize():
            spread = np.sqrt(np.log1p((size.sd / size.mean) ** 2))
            middle = np.log(size.mean) - 0.5 * spread**2
            return np.exp(_cut_normal(share, middle, spread, np.log(size.min), np.log(size.max)))
        case PowerSize():
            return _power(share, size.exponent, size.min, size.max)


def _cut_normal(share: FloatArray, mean: float, sd: float, low: float, high: float) -> FloatArray:
    """Quantiles of a normal distribution cut at two bounds."""
    first, last = np.clip([(low - mean) / sd, (high - mean) / sd], -_TAIL, _TAIL)
    place = np.linspace(first, last, _TABLE)
    density = np.exp(-0.5 * (place**2 - np.min(place**2)))
    below = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    values = mean + sd * np.interp(share * below[-1], below, place)
    return np.clip(values, low, high)


def _power(share: FloatArray, exponent: float, low: float, high: float) -> FloatArray:
    """Quantiles of the density p(h) ~ h^exponent between two bounds."""
    order = exponent + 1.0
    # in units of the upper bound: no power overflows
    ratio = low / high
    if abs(order) < 1e-9:
        return high * ratio ** (1.0 - share)
    return high * (ratio**order + share * (1.0 - ratio**order)) ** (1.0 / order)
