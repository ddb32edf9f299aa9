"""Statistics of what crosses barriers and lines, exact: every crossing is kept."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.rockfall.hazard import QUANTILES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.flights import Crossings
    from warpdem.rockfall.site import Barrier

MEASURED = ("energy", "speed", "height", "spin")
"""What is known of each crossing [J, m/s, m, rad/s]."""


@dataclass(frozen=True, eq=False)
class Passage:
    """What crossed one barrier.

    Attributes:
        name: Of the barrier.
        crossings: All of them.
        trajectories: That crossed it, once or more often.
        share: Of all trajectories.
        caught: Trajectories that ended there.
        measured: Mean, the ``QUANTILES`` and the largest of each of ``MEASURED`` over the
            crossings, NaN without any, shape [4, 6]. Of n values quantile q is the ceil(q n)-th
            smallest.
    """

    name: str
    crossings: int
    trajectories: int
    share: float
    caught: int
    measured: FloatArray


class Passages:
    """Collects the crossings of bundles of trajectories, some 50 bytes each."""

    def __init__(self) -> None:
        self._parts: list[tuple[IntArray, ...]] = []
        self._values: list[FloatArray] = []

    def add(self, crossings: Crossings) -> None:
        """Take the crossings of one more bundle."""
        self._parts.append((crossings.id, crossings.barrier, crossings.caught))
        self._values.append(np.stack([getattr(crossings, name) for name in MEASURED], axis=-1))

    def statistics(self, barriers: Sequence[Barrier], trajectories: int) -> list[Passage]:
        """What crossed each barrier.

        Args:
            barriers: Of the site.
            trajectories: How many there were in all.
        """
        values = np.concatenate([np.zeros((0, len(MEASURED))), *self._values])
        columns = zip(*self._parts, strict=True) if self._parts else [[np.zeros(0, int)]] * 3
        ids, number, caught = (np.concatenate(column) for column in columns)
        every = []
        for index, barrier in enumerate(barriers):
            here = number == index
            crossed = len(np.unique(ids[here]))
            share = crossed / max(trajectories, 1)
            stopped = int(np.count_nonzero(caught[here]))
            found = _measured(values[here])
            every.append(Passage(barrier.name, int(here.sum()), crossed, share, stopped, found))
        return every


def along(barriers: Sequence[Barrier], crossings: Crossings) -> FloatArray:
    """Way along its barrier's line at which each crossing lies [m], shape [n]."""
    way = np.zeros(len(crossings.id))
    for index, barrier in enumerate(barriers):
        here = crossings.barrier == index
        way[here] = _way(barrier.line, crossings.position[here, :2])
    return way


def _measured(values: FloatArray) -> FloatArray:
    if not len(values):
        return np.full((len(MEASURED), len(QUANTILES) + 2), np.nan)
    ordered = np.sort(values, axis=0)
    ranks = [-(-q * len(ordered) // 1000) - 1 for q in QUANTILES.values()]
    return np.stack([ordered.mean(axis=0), *ordered[ranks], ordered[-1]], axis=-1)


def _way(line: FloatArray, points: FloatArray) -> FloatArray:
    """Way along a line [m] to its point nearest to each point, shape [n]."""
    first, edges = line[:-1], np.diff(line, axis=0)
    lengths = np.linalg.norm(edges, axis=1)
    starts = np.cumsum(lengths) - lengths
    relative = points[:, None] - first
    squares = np.maximum(lengths**2, np.finfo(float).tiny)
    part = np.clip((relative * edges).sum(axis=-1) / squares, 0.0, 1.0)
    away = np.linalg.norm(relative - part[..., None] * edges, axis=-1)
    nearest = away.argmin(axis=1)
    rows = np.arange(len(points))
    return starts[nearest] + part[rows, nearest] * lengths[nearest]
