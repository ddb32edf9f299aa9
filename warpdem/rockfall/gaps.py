"""Holes in what is known of the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray


def enclosed(known: BoolArray) -> BoolArray:
    """Cells that are not known and from which only known ones lead out of the grid.

    Ways go from a cell to the four beside it.

    Args:
        known: Shape [rows, columns]; so is the result.
    """
    gap = np.pad(~known.astype(bool), 1, constant_values=True)
    out = np.zeros_like(gap)
    out[0] = True
    reached = 0
    while (now := int(out.sum())) > reached:
        reached = now
        _spread(gap, out)
        _spread(gap[::-1], out[::-1])
    return (gap & ~out)[1:-1, 1:-1]


def _spread(gap: BoolArray, out: BoolArray) -> None:
    """Widen what is ``out`` to all gaps beside it in the same row, and so on from row to row."""
    run = np.cumsum(~gap, axis=1)  # the same number all along a gap
    for row in range(1, len(gap)):
        seen = gap[row] & (out[row] | out[row - 1])
        hit = np.zeros(gap.shape[1] + 1, bool)
        hit[run[row, seen]] = True
        out[row] = gap[row] & hit[run[row]]
