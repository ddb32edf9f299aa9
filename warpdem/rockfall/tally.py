"""Counts of what passes each cell: whole numbers, so that sums know neither order nor grouping."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import reduce
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from warpdem.errors import UnstableError
from warpdem.rockfall.flights import Fate

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.flights import Flights, Visits
    from warpdem.rockfall.site import Site

QUANTITIES = ("energy", "speed", "jump", "spin")
"""What is counted in each cell [J, m/s, m, rad/s], in the order of the columns of a tally."""

UNIT = 2.0**-20
"""Unit of the sums [J, m/s, m, rad/s]: a sample is rounded to it, and then nothing is."""

LARGEST = 2.0**42
"""Samples lie below this [J, m/s, m, rad/s]; then 2**31 of them fit the sums."""

BIN_BITS = 13
"""Bits of a bin's number: 8 of the exponent and 5 of the mantissa of a float32 without sign."""

DROPPED_BITS = 18
"""Bits of the mantissa that a bin does not know: it is 1/32 wide, relative to its lower edge."""

BIN_ERROR = 2.0**-6
"""Largest relative error of a quantile, which is the middle of a bin."""

_LIMB = 32
_STOPPED = (Fate.REST, Fate.CAUGHT)


@dataclass(frozen=True, eq=False)
class Tally:
    """Statistics of a set of trajectories; ``a + b`` is that of both sets, bit for bit.

    A trajectory counts once in each cell it passes, with its largest values there.

    Attributes:
        cell: The cells passed, rising, int64, shape [cell_count].
        passages: Trajectories through each, int64, shape [cell_count].
        deposits: Trajectories that came to rest or were caught there, int64, shape [cell_count].
        largest: Of each of ``QUANTITIES``, float32, shape [cell_count, 4].
        high, low: Sums of the samples' upper and lower 32 bits in ``UNIT``, int64, shape
            [cell_count, 4]; kept apart they hold 2**31 samples of up to ``LARGEST``.
        key: The bins that hold samples, (4 cell + quantity) 2**13 + bin, rising, int64, shape
            [bin_count].
        count: Samples in each of them, int64, shape [bin_count].
        trajectories: How many were counted.
    """

    cell: IntArray
    passages: IntArray
    deposits: IntArray
    largest: NDArray[np.float32]
    high: IntArray
    low: IntArray
    key: IntArray
    count: IntArray
    trajectories: int

    @classmethod
    def of(cls, flights: Flights, site: Site) -> Self:
        """Count a bundle of trajectories; ids may come in any order, each in one bundle only.

        Raises:
            UnstableError: A value in a cell is not finite, or not below ``LARGEST``.
        """
        cell, values = _samples(flights.visits)
        passed, first = np.unique(cell, return_index=True)
        stopped = np.isin(flights.fate, _STOPPED)
        at = flights.position[stopped]
        rest = site.results.index(at[:, 0], at[:, 1])
        rest, deposits = np.unique(rest[rest >= 0], return_counts=True)
        units = np.rint(values.astype(np.float64) / UNIT).astype(np.int64)
        parts = (values, units >> _LIMB, units & ((1 << _LIMB) - 1))
        folds = (np.maximum, np.add, np.add)
        empty = np.zeros((len(rest), len(QUANTITIES)), np.int64)
        key, count = np.unique(_keys(cell, values), return_counts=True)
        merged = _by_cell(
            np.concatenate([passed, rest]),
            np.concatenate([np.diff(first, append=len(cell)), 0 * rest]),
            np.concatenate([0 * passed, deposits]),
            *(
                np.concatenate([_folded(fold, part, first), empty.astype(part.dtype)])
                for fold, part in zip(folds, parts, strict=True)
            ),
        )
        return cls(
            *merged,
            key=key,
            count=count.astype(np.int64),
            trajectories=len(flights.id),
        )

    @classmethod
    def empty(cls) -> Self:
        """The statistics of no trajectory, neutral in sums."""
        none = np.zeros(0, np.int64)
        wide = np.zeros((0, len(QUANTITIES)), np.int64)
        return cls(
            cell=none,
            passages=none,
            deposits=none,
            largest=wide.astype(np.float32),
            high=wide,
            low=wide,
            key=none,
            count=none,
            trajectories=0,
        )

    def __add__(self, other: Tally) -> Tally:
        mine, theirs = self.arrays(), other.arrays()
        rows = (np.concatenate([mine[name], theirs[name]]) for name in _CELL_ARRAYS)
        key = np.concatenate([self.key, other.key])
        order, first = _groups(key)
        return Tally(
            *_by_cell(*rows),
            key=key[order][first],
            count=_folded(np.add, np.concatenate([self.count, other.count])[order], first),
            trajectories=self.trajectories + other.trajectories,
        )

    def mean(self) -> FloatArray:
        """Mean of the samples in each cell, NaN without any, shape [cell_count, 4]."""
        sums = self.high.astype(np.float64) * 2.0**_LIMB + self.low
        with np.errstate(invalid="ignore"):
            return UNIT * sums / self.passages[:, None]

    def quantiles(self, permille: Sequence[int]) -> FloatArray:
        """Quantiles of the samples in each cell: of n samples the ceil(q n)-th smallest.

        The value is the middle of the bin that holds it, which is off by ``BIN_ERROR`` at most, and
        never above the largest; the n-th smallest is exact.

        Args:
            permille: The q, in thousandths.

        Returns:
            NaN without samples, shape [quantile_count, cell_count, 4].
        """
        found = np.full((len(permille), len(self.cell), len(QUANTITIES)), np.nan)
        passed = np.flatnonzero(self.passages)
        samples = np.repeat(self.passages[passed], len(QUANTITIES))
        until = np.cumsum(self.count)
        before = np.cumsum(samples) - samples
        largest = self.largest[passed].astype(np.float64).ravel()
        for row, q in zip(found, permille, strict=True):
            rank = -(-q * samples // 1000)
            holder = self.key[np.searchsorted(until, before + rank)] & ((1 << BIN_BITS) - 1)
            value = np.minimum(_middle(holder), largest)
            row[passed] = np.where(rank == samples, largest, value).reshape(-1, len(QUANTITIES))
        return found

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All of it by name, for a file."""
        return {field.name: np.asarray(getattr(self, field.name)) for field in fields(self)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Self:
        """A tally from what ``arrays`` gave; other entries of the mapping are left alone."""
        found: dict[str, Any] = {field.name: arrays[field.name] for field in fields(cls)}
        found["trajectories"] = int(found["trajectories"])
        return cls(**found)


_CELL_ARRAYS = ("cell", "passages", "deposits", "largest", "high", "low")


def total(tallies: Iterable[Tally]) -> Tally:
    """The sum of many tallies, taken as they come: equals meet equals, few are held at a time."""
    held: list[tuple[int, Tally]] = []
    for tally in tallies:
        size, added = 1, tally
        while held and held[-1][0] == size:
            added = held.pop()[1] + added
            size *= 2
        held.append((size, added))
    return reduce(Tally.__add__, (tally for _, tally in reversed(held)), Tally.empty())


def _samples(visits: Visits) -> tuple[IntArray, NDArray[np.float32]]:
    """One row a cell and trajectory, sorted by cell: the cells, and the largest values in each."""
    _, who = np.unique(visits.id, return_inverse=True)
    known = visits.cell >= 0
    pair = (visits.cell * (int(who.max(initial=0)) + 1) + who)[known]
    columns = [getattr(visits, name)[known] for name in QUANTITIES]
    values = np.stack(columns, axis=-1).astype(np.float32, copy=False)
    if not (values < LARGEST).all():
        row, column = np.argwhere(~(values < LARGEST))[0]
        raise UnstableError(
            f"trajectory {visits.id[known][row]}: {QUANTITIES[column]} {values[row, column]:g} "
            f"in cell {visits.cell[known][row]} cannot be counted, it must be finite; lower run.dt"
        )
    order, first = _groups(pair)
    values = np.maximum(values, np.float32(0.0)) + np.float32(0.0)  # no -0.0: bins read bits
    return visits.cell[known][order][first], _folded(np.maximum, values[order], first)


def _groups(key: IntArray) -> tuple[IntArray, IntArray]:
    """Order that sorts keys, and where in it each new key begins."""
    order = np.argsort(key, kind="stable")  # merges two sorted runs in linear time
    ordered = key[order]
    new = np.ones(len(key), bool)
    np.not_equal(ordered[1:], ordered[:-1], out=new[1:])
    return order, np.flatnonzero(new)


def _folded(fold: np.ufunc, rows: NDArray, first: IntArray) -> NDArray:
    """Groups of rows made one by a ufunc; no rows give none."""
    return fold.reduceat(rows, first, axis=0) if len(first) else rows[:0]


def _by_cell(cell: IntArray, *rows: NDArray) -> list[NDArray]:
    """Rows of equal cells made one: all are added but the largest, the third."""
    order, first = _groups(cell)
    folds = (np.add, np.add, np.maximum, np.add, np.add)
    merged = (_folded(fold, row[order], first) for fold, row in zip(folds, rows, strict=True))
    return [cell[order][first], *merged]


def _keys(cell: IntArray, values: NDArray[np.float32]) -> IntArray:
    """Keys of the bins that samples fall into, shape [sample_count * 4]."""
    bins = values.view(np.int32) >> DROPPED_BITS
    slot = len(QUANTITIES) * cell[:, None] + np.arange(len(QUANTITIES))
    return ((slot << BIN_BITS) + bins).ravel()


def _middle(bins: IntArray) -> FloatArray:
    """Middle of each bin."""
    edges = (np.stack([bins, bins + 1]).astype(np.int32) << DROPPED_BITS).view(np.float32)
    return edges.astype(np.float64).mean(axis=0)
