"""States of rocks in time, as arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Sample:
    """Where one followed rock was, at some times in order.

    Attributes:
        time: [s], shape [n].
        position: Local [m], shape [n, 3].
        orientation: w, x, y, z, shape [n, 4].
        velocity: [m/s], shape [n, 3].
        spin: World axes [rad/s], shape [n, 3].
        contact: Whether it pressed on the ground, shape [n].
    """

    time: FloatArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    contact: BoolArray


def split(motion: np.ndarray, owner: IntArray, count: int) -> list[Sample]:
    """States of ``count`` rocks in the order of time, as samples of each.

    Args:
        motion: Records of the device's ``Motion``, shape [n].
        owner: Rock of each, shape [n].
        count: Of rocks.
    """
    order = np.argsort(owner, kind="stable")
    ends = np.searchsorted(owner[order], np.arange(1, count))
    return [sample_of(part) for part in np.split(motion[order], ends)]


def sample_of(motion: np.ndarray) -> Sample:
    """Records of the device's ``Motion`` as arrays, the spin along the world's axes."""
    orientation = motion["orientation"][:, [3, 0, 1, 2]]
    return Sample(
        time=motion["time"].copy(),
        position=motion["position"].copy(),
        orientation=orientation,
        velocity=motion["velocity"].copy(),
        spin=np.einsum("nij,nj->ni", matrix(orientation), motion["spin"]),
        contact=motion["touching"] != 0,
    )
