"""Trajectories shared out among releases by weight, evenly from the first on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray


def apportioned(ids: IntArray, weights: Sequence[float]) -> tuple[IntArray, IntArray]:
    """Release of each trajectory, and how many earlier ones it has had; shapes [n].

    Turn r of release k comes at the time (r + 1/2) / w_k; trajectories follow the turns in time,
    of equal ones the first release first. So at any number of trajectories each release has its
    share but for rounding, and after as many as the sum of whole weights exactly its weight; who
    comes when does not depend on the number of trajectories.

    Args:
        ids: Global numbers of the trajectories, shape [n].
        weights: Of the releases, positive.

    Source: the divisor method of Webster and Sainte-Lague.
    """
    weight = np.array(weights, np.float64)
    ids = np.asarray(ids, np.int64)
    if len(weight) == 1:
        return np.zeros(len(ids), np.int64), ids.copy()
    # before this time fewer turns than ids have been: each release is at most half a turn ahead
    time = np.maximum(ids - 0.5 * len(weight) - 1.0, 0.0) / weight.sum()
    turns = _turns_before(time, weight)
    missing = ids - turns.sum(axis=1)
    row = np.arange(len(ids))
    while True:
        following = ((turns + 0.5) / weight).argmin(axis=1)
        late = missing > 0
        if not late.any():
            return following, turns[row, following]
        turns[row[late], following[late]] += 1
        missing[late] -= 1


def _turns_before(time: FloatArray, weight: FloatArray) -> IntArray:
    """Number of turns r = 0, 1, ... with (r + 1/2) / w < time, shape [n, release_count]."""
    turns = np.maximum(np.ceil(time[:, None] * weight - 0.5), 0.0)
    # the rounded product may be off by one where a turn falls on the time
    turns = np.where((turns - 0.5) / weight >= time[:, None], turns - 1.0, turns)
    turns = np.where((turns + 0.5) / weight < time[:, None], turns + 1.0, turns)
    return np.maximum(turns, 0.0).astype(np.int64)
