"""What became of the trajectories of an ensemble, in numbers for its summary."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.rockfall.flights import COUNTS, MEASURES, Fate

if TYPE_CHECKING:
    from collections.abc import Iterable

    from warpdem.rockfall.chunks import Chunk

DOUBTFUL = ("unconverged", "limited", "dropped")
"""Counts of which the number of trajectories with any is told too."""

_PEAK = COUNTS.index("most_sweeps")


def account(chunks: Iterable[Chunk]) -> dict[str, Any]:
    """Fates, sums of the counts and largest measures of all trajectories.

    Raises:
        OutputError: A chunk cannot be read.
    """
    fates = np.zeros(len(Fate), np.int64)
    counts, measures = np.zeros(len(COUNTS), np.int64), np.zeros(len(MEASURES))
    doubtful = dict.fromkeys(DOUBTFUL, 0)
    for chunk in chunks:
        flights = chunk.flights
        fates += np.bincount(flights.fate, minlength=len(Fate))
        peak = max(counts[_PEAK], flights.counts[:, _PEAK].max(initial=0))
        counts += flights.counts.sum(axis=0)
        counts[_PEAK] = peak
        measures = np.maximum(measures, flights.measures.max(axis=0, initial=0.0))
        for name in DOUBTFUL:
            doubtful[name] += int(np.count_nonzero(flights.counts[:, COUNTS.index(name)]))
    return {
        # a broken one ends the run
        "fates": {one.name.lower(): int(fates[one]) for one in Fate if one is not Fate.BROKEN},
        "steps": dict(zip(COUNTS, counts.tolist(), strict=True)),
        "trajectories_with": doubtful,
        "largest": dict(zip(MEASURES, measures.tolist(), strict=True)),
    }
