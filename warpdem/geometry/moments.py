"""Volume and first and second moments of pieces of a solid, and what follows from their sum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Moments:
    """Integrals over a region: of 1, of x and of x x^T; those of disjoint regions add up.

    Attributes:
        volume: [m^3].
        first: [m^4], shape [3].
        second: [m^5], shape [3, 3].
    """

    volume: float
    first: FloatArray
    second: FloatArray

    def __add__(self, other: Moments) -> Moments:
        return Moments(
            self.volume + other.volume, self.first + other.first, self.second + other.second
        )

    def __sub__(self, other: Moments) -> Moments:
        return Moments(
            self.volume - other.volume, self.first - other.first, self.second - other.second
        )


NOTHING = Moments(0.0, np.zeros(3), np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Of a solid of uniform density.

    Attributes:
        volume: [m^3].
        centre: Centre of mass [m], shape [3].
        inertia_over_mass: Tensor about the centre of mass over the mass [m^2], shape [3, 3].
        error: Estimated relative error of volume and inertia; 0 where they are exact.
    """

    volume: float
    centre: FloatArray
    inertia_over_mass: FloatArray
    error: float = 0.0


def mass_properties(moments: Moments, error: float = 0.0) -> MassProperties:
    """Mass properties that follow from the moments of the whole solid."""
    centre = moments.first / moments.volume
    spread = moments.second / moments.volume - np.outer(centre, centre)
    spread = 0.5 * (spread + spread.T)
    inertia = -spread
    # sums of the two others, not the trace less one: needles keep all their digits
    np.fill_diagonal(inertia, np.diag(spread)[[1, 2, 0]] + np.diag(spread)[[2, 0, 1]])
    return MassProperties(moments.volume, centre, inertia, error)


def swept(
    weight: FloatArray, base: FloatArray, direction: FloatArray, reach: FloatArray, order: int
) -> Moments:
    """Moments of rays x + t n, 0 < t < reach, each with volume element weight t^order dt.

    Args:
        weight: Measure of the rays' origins and directions, shape [n].
        base: Origins x, shape [n, 3].
        direction: Unit vectors n, shape [n, 3].
        reach: Lengths, shape [n].
        order: 0 above faces, 1 around edges, 2 around vertices.
    """
    zeroth = weight * reach ** (order + 1) / (order + 1)
    once = weight * reach ** (order + 2) / (order + 2)
    twice = weight * reach ** (order + 3) / (order + 3)
    cross = (base * once[:, None]).T @ direction
    return Moments(
        float(zeroth.sum()),
        zeroth @ base + once @ direction,
        (base * zeroth[:, None]).T @ base
        + cross
        + cross.T
        + (direction * twice[:, None]).T @ direction,
    )
