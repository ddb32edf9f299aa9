"""Trajectories as they end, gathered from launches into one bundle."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import UnstableError
from warpdem.rockfall.flights import COUNTS, MEASURES, Crossings, Fate, Flights, Visits
from warpdem.rockfall.samples import sample_of

if TYPE_CHECKING:
    from warpdem.arrays import IntArray
    from warpdem.rockfall.flights import Starts

Records = tuple["IntArray", np.ndarray]
"""Rows of ``Starts``, and a record of each."""


class Endings:
    """Trajectories that have ended, by row of their starts.

    Args:
        count: Of trajectories.
        motion, visit, crossing: Types of the device's records.

    Attributes:
        fate, motion, count, measure: Filled row by row.
        visits, crossings: Records of each launch, in its order.
    """

    def __init__(self, count: int, motion: np.dtype, visit: np.dtype, crossing: np.dtype) -> None:
        self._kinds = visit, crossing
        self.fate = np.zeros(count, np.int8)
        self.motion = np.zeros(count, motion)
        self.count = np.zeros((count, len(COUNTS)), np.int64)
        self.measure = np.zeros((count, len(MEASURES)))
        self.visits: list[Records] = []
        self.crossings: list[Records] = []

    def flights(self, starts: Starts) -> Flights:
        """All of them, in the order of their starts.

        Raises:
            UnstableError: The motion of one ceased to be finite.
        """
        end = sample_of(self.motion)
        broken = np.flatnonzero(self.fate == Fate.BROKEN)
        if len(broken):
            number, time = int(starts.id[broken[0]]), float(end.time[broken[0]])
            raise UnstableError(
                f"trajectory {number}: its motion ceased to be finite at t = {time:.6g} s; look at "
                "its start and its rock, or take a smaller run.dt and run.stride",
                body=f"trajectory {number}",
                time=time,
            )
        return Flights(
            id=starts.id,
            release=starts.release,
            rock=starts.rock,
            fate=self.fate,
            time=end.time,
            start=starts.position,
            position=end.position,
            orientation=end.orientation,
            velocity=end.velocity,
            spin=end.spin,
            counts=self.count,
            measures=self.measure,
            visits=self._visits(starts.id),
            crossings=self._crossings(starts.id),
        )

    def _visits(self, ids: IntArray) -> Visits:
        row, record = _joined(self.visits, self._kinds[0])
        names = [field.name for field in fields(Visits)][1:]
        columns = {name: record[name].copy() for name in names}
        columns["cell"] = columns["cell"].astype(np.int64)
        return Visits(id=ids[row], **columns)

    def _crossings(self, ids: IntArray) -> Crossings:
        row, record = _joined(self.crossings, self._kinds[1])
        names = [field.name for field in fields(Crossings)][1:]
        columns = {name: record[name].copy() for name in names}
        columns["caught"] = columns["caught"].astype(bool)
        return Crossings(id=ids[row], **columns)


def _joined(parts: list[Records], kind: np.dtype) -> Records:
    """Records of all launches, by row, in the order in which they happened."""
    if not parts:
        return np.zeros(0, np.int64), np.zeros(0, kind)
    row = np.concatenate([part[0] for part in parts])
    order = np.argsort(row, kind="stable")
    return row[order], np.concatenate([part[1] for part in parts])[order]
