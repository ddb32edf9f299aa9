"""Random numbers of trajectories: each a function of seed, trajectory, purpose and draw alone.

Nothing is remembered from one number to the next, so they do not depend on how trajectories are
grouped. Only + - * / and square roots of doubles and whole numbers are used, which every machine
rounds alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from warpdem.arrays import BoolArray, FloatArray, IntArray

    Words = NDArray[np.uint64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)


class Purpose(IntEnum):
    """What a number is drawn for; the numbers are part of the results: add, never change."""

    ROCK = 1
    PLACE = 2
    HEIGHT = 3
    ORIENTATION = 4
    SPEED = 5
    AZIMUTH = 6
    DIP = 7
    SPIN_RATE = 8
    SPIN_AXIS = 9
    FORM = 10
    AREA = 11


def mixed(words: Words) -> Words:
    """One-to-one map of 64-bit words in which every bit depends on all; shape [...].

    Source: the finaliser of SplitMix64; Steele, Lea & Flood (2014), doi:10.1145/2660193.2660195.
    """
    words = words + _GOLDEN
    words = (words ^ (words >> np.uint64(30))) * _FIRST
    words = (words ^ (words >> np.uint64(27))) * _SECOND
    return words ^ (words >> np.uint64(31))


@dataclass(frozen=True, eq=False)
class Streams:
    """The random numbers of some trajectories.

    Attributes:
        seed: From 0 to 2^64 - 1.
        ids: Global numbers of the trajectories, int64, shape [n].
    """

    seed: int
    ids: IntArray

    def words(self, purpose: Purpose, draw: int) -> Words:
        """64 random bits a trajectory, shape [n]; different draws of one never repeat a word."""
        # twice: else seed 1 of trajectory 2 would be seed 2 of trajectory 1
        seed = mixed(mixed(np.array([self.seed], np.uint64)))
        key = mixed(seed ^ mixed(np.asarray(self.ids, np.int64).astype(np.uint64)))
        number = mixed(np.array([(int(purpose) << 48) + draw], np.uint64))
        return mixed(key ^ number)

    def uniform(self, purpose: Purpose, draw: int = 0) -> FloatArray:
        """Multiples of 2^-53 in [0, 1), shape [n]."""
        return (self.words(purpose, draw) >> np.uint64(11)).astype(np.float64) * 2.0**-53

    def between(self, purpose: Purpose, low: float, high: float) -> FloatArray:
        """Numbers from low to high, shape [n]."""
        return low + (high - low) * self.uniform(purpose)

    def directions(self, purpose: Purpose) -> FloatArray:
        """Unit vectors, all directions equally likely, shape [n, 3].

        Source: Marsaglia (1972), doi:10.1214/aoms/1177692644.
        """
        pair = self.accepted(purpose, 2, lambda parts: _square(parts[:, :2]) < 1.0)
        square = _square(pair)
        reach = 2.0 * np.sqrt(1.0 - square)
        return np.column_stack([pair * reach[:, None], 1.0 - 2.0 * square])

    def quaternions(self, purpose: Purpose) -> FloatArray:
        """Unit quaternions w, x, y, z of rotations that are all equally likely, shape [n, 4].

        Source: Marsaglia (1972), as above, on the sphere in four dimensions.
        """
        parts = self.accepted(purpose, 4, _inside_both)
        first, second = parts[:, :2], parts[:, 2:]
        reach = np.sqrt((1.0 - _square(first)) / _square(second))
        return np.column_stack([first, second * reach[:, None]])

    def accepted(
        self, purpose: Purpose, size: int, accepts: Callable[[FloatArray], BoolArray]
    ) -> FloatArray:
        """For each trajectory its first tuple in [-1, 1) that is accepted, shape [n, size].

        Args:
            purpose: What for.
            size: Numbers of a tuple.
            accepts: Which tuples of shape [m, size] will do, shape [m], each judged by itself; it
                must accept a fair part of them.
        """
        found = np.empty((len(self.ids), size))
        left, draw = np.arange(len(self.ids)), 0
        while len(left):
            rest = Streams(self.seed, self.ids[left])
            tries = [2.0 * rest.uniform(purpose, draw + part) - 1.0 for part in range(size)]
            parts = np.column_stack(tries)
            good = accepts(parts)
            found[left[good]] = parts[good]
            left, draw = left[~good], draw + size
        return found


def _square(pair: FloatArray) -> FloatArray:
    return pair[:, 0] * pair[:, 0] + pair[:, 1] * pair[:, 1]


def _inside_both(parts: FloatArray) -> BoolArray:
    second = _square(parts[:, 2:])
    return (_square(parts[:, :2]) < 1.0) & (second < 1.0) & (second > 0.0)
