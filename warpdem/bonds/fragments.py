"""Fragments: what intact interfaces hold together."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray

LARGEST = 5
"""Fragments of which the mass is listed one by one."""


def fragments(pairs: IntArray, free: BoolArray) -> IntArray:
    """Fragment of each body: the lowest number of the free bodies it hangs together with.

    What is bonded to a fixed body hangs together with all that is bonded to it.

    Args:
        pairs: Bodies joined by intact interfaces, shape [pair_count, 2].
        free: Shape [body_count].

    Returns:
        Shape [body_count].
    """
    root = np.arange(len(free))
    # free bodies first, so that a fragment's name is that of a free body where it has one
    order = np.argsort(~free, kind="stable")
    place = np.empty_like(order)
    place[order] = np.arange(len(order))

    def find(body: int) -> int:
        while root[body] != body:
            root[body] = root[root[body]]
            body = root[body]
        return body

    for i, j in place[pairs]:
        a, b = sorted((find(i), find(j)))
        root[b] = a
    return order[np.array([find(k) for k in range(len(root))], dtype=np.int64)][place]


class Sizes(NamedTuple):
    """How a scene has fallen apart; fixed bodies have no mass.

    Attributes:
        total: Number of fragments, single bodies included.
        joined: Of those of two bodies or more.
        mean: Mass [kg].
        largest: Masses of the largest ones [kg], 0 where there are fewer, shape [LARGEST].
    """

    total: int
    joined: int
    mean: float
    largest: FloatArray


def sizes(fragment: IntArray, mass: FloatArray) -> Sizes:
    """Sizes of the fragments that have a free body; ``mass`` is 0 for fixed ones [kg]."""
    names, inverse, count = np.unique(fragment, return_inverse=True, return_counts=True)
    weight = np.bincount(inverse, weights=mass, minlength=len(names))
    loose = weight > 0.0
    masses = np.sort(weight[loose])[::-1]
    largest = np.zeros(LARGEST)
    largest[: min(LARGEST, len(masses))] = masses[:LARGEST]
    return Sizes(len(masses), int((count[loose] > 1).sum()), float(masses.mean()), largest)
