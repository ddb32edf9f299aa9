"""All the files of a run that grow with it, written by one thread in one order."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.timestep import masses
from warpdem.driving.plan import listed_bodies
from warpdem.errors import OutputError
from warpdem.output import cell_box, contact_points
from warpdem.output import checkpoint as checkpoints
from warpdem.output.breakage import (
    BONDS_COLUMNS,
    FRAGMENTS_COLUMNS,
    broken_rows,
    fragments_row,
)
from warpdem.output.cell_table import CELL_COLUMNS, cell_row
from warpdem.output.series import Series
from warpdem.output.surfaces import Surfaces
from warpdem.output.table import (
    DRIVERS_COLUMNS,
    ENERGY_COLUMNS,
    TRAJECTORY_COLUMNS,
    Driven,
    Table,
    Trajectory,
    energy_row,
)
from warpdem.output.writer import told

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.arrays import FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.output.checkpoint import Checkpoint
    from warpdem.output.folder import RunFolder
    from warpdem.output.writer import Writer
    from warpdem.snapshot import Snapshot

TRAJECTORY = "trajectory.csv"
ENERGY = "energy.csv"
CELL = "cell.csv"
DRIVERS = "drivers.csv"
BONDS = "bonds.csv"
FRAGMENTS = "fragments.csv"
COLUMNS = {
    TRAJECTORY: TRAJECTORY_COLUMNS,
    ENERGY: ENERGY_COLUMNS,
    CELL: CELL_COLUMNS,
    DRIVERS: DRIVERS_COLUMNS,
    BONDS: BONDS_COLUMNS,
    FRAGMENTS: FRAGMENTS_COLUMNS,
}


class Recorder:
    """Writes frames, tables and checkpoints as jobs of a writer.

    Args:
        folder: Where to.
        scene: What is simulated, and what of it is written.
        polyhedra: The shapes.
        placement: The bodies.
        writer: The thread that does it, in the order of the calls.
        start: The checkpoint the run resumes from: the files are cut back to it.

    Raises:
        OutputError: A file cannot be opened, or is not the one the checkpoint belongs to.
    """

    def __init__(
        self,
        folder: RunFolder,
        scene: Scene,
        polyhedra: Mapping[str, Polyhedron],
        placement: Placement,
        writer: Writer,
        start: Checkpoint | None = None,
    ) -> None:
        output = scene.output
        driven = listed_bodies(scene, placement).tolist()
        self._folder = folder
        self._output = output
        self._writer = writer
        self._cell = scene.cell is not None
        self._times = dict(start.frame_times) if start else {}
        self._lengths = dict(start.table_lengths) if start else {}
        self._surfaces = Surfaces(polyhedra, placement) if output.surface else None
        self._trajectory = _trajectory(polyhedra, placement, driven)
        self._driven = _driven(polyhedra, placement, driven) if len(driven) else None
        self._bonded = bool(scene.bond)
        if self._bonded:
            self._names = placement.names
            self._mass = np.where(placement.fixed, 0.0, masses(placement, polyhedra)[0])
        try:
            self._series = {stem: self._open_series(stem) for stem in self._stems()}
            self._tables = {name: self._open_table(name) for name in self._table_names()}
        except OSError as fault:
            raise OutputError(told(fault)) from fault

    def record(self, snapshot: Snapshot) -> None:
        """Write a frame and the tables' rows of one instant, sooner or later.

        Raises:
            OutputError: Something earlier could not be written.
        """
        self._writer.put(lambda: self._write(snapshot))

    def checkpoint(self, checkpoint: Checkpoint) -> None:
        """Write a checkpoint of what was recorded so far, sooner or later.

        Args:
            checkpoint: State of the run; what the files hold is filled in.

        Raises:
            OutputError: Something earlier could not be written.
        """
        self._writer.put(lambda: self._save(checkpoint))

    def close(self) -> None:
        """Close the tables; the writer must have ended."""
        for table in self._tables.values():
            table.close()

    def _stems(self) -> list[str]:
        wanted = {
            "bodies": self._output.surface,
            "cell": self._output.surface and self._cell,
            "contacts": self._output.contacts,
        }
        return [stem for stem, is_wanted in wanted.items() if is_wanted]

    def _table_names(self) -> list[str]:
        wanted = {
            TRAJECTORY: self._output.table,
            ENERGY: self._output.energy,
            CELL: self._cell,
            DRIVERS: self._output.drivers and self._driven is not None,
            BONDS: self._output.bonds and self._bonded,
            FRAGMENTS: self._output.fragments and self._bonded,
        }
        return [name for name, is_wanted in wanted.items() if is_wanted]

    def _open_series(self, stem: str) -> Series:
        times = self._times.get(stem, [])
        series = Series(self._folder.path, stem, times)
        series.truncate(len(times))
        return series

    def _open_table(self, name: str) -> Table:
        return Table(self._folder / name, COLUMNS[name], self._lengths.get(name))

    def _write(self, snapshot: Snapshot) -> None:
        if self._surfaces:
            self._frame("bodies", snapshot, self._surfaces.grid(snapshot, self._output.fields))
            if snapshot.cell:
                self._frame("cell", snapshot, cell_box.grid(snapshot.cell))
        if self._output.contacts and snapshot.contacts:
            self._frame("contacts", snapshot, contact_points.grid(snapshot.contacts, snapshot.cell))
        if self._output.table:
            self._tables[TRAJECTORY].append(self._trajectory.rows(snapshot))
        if self._output.energy and snapshot.energy:
            self._tables[ENERGY].append(energy_row(snapshot.time, snapshot.energy))
        if self._cell and snapshot.cell:
            self._tables[CELL].append(cell_row(snapshot.time, snapshot.cell))
        if self._output.drivers and self._driven:
            self._tables[DRIVERS].append(self._driven.rows(snapshot))
        if BONDS in self._tables and snapshot.breakage:
            table = self._tables[BONDS]
            table.append("".join(broken_rows(snapshot.breakage, self._names, table.rows)))
        if FRAGMENTS in self._tables:
            self._tables[FRAGMENTS].append(fragments_row(snapshot, self._mass))

    def _frame(self, stem: str, snapshot: Snapshot, grid: vtkUnstructuredGrid) -> None:
        from warpdem.output import vtu  # noqa: PLC0415 - loads VTK

        compression = self._output.compression
        self._series[stem].append(snapshot.time, lambda part: vtu.write(part, grid, compression))

    def _save(self, checkpoint: Checkpoint) -> None:
        for table in self._tables.values():
            table.sync()
        times = {stem: list(series.times) for stem, series in self._series.items()}
        lengths = {name: table.length for name, table in self._tables.items()}
        whole = replace(
            checkpoint,
            frame_times=self._times | times,
            table_lengths=self._lengths | lengths,
        )
        checkpoints.save(self._folder.checkpoint, whole)


def _trajectory(
    polyhedra: Mapping[str, Polyhedron], placement: Placement, driven: Sequence[int]
) -> Trajectory:
    """Rows for the bodies that move, freely or driven."""
    moving = np.any(placement.velocity, axis=1) | np.any(placement.spin, axis=1)
    moving[np.asarray(driven, np.int64)] = True
    bodies = np.flatnonzero(~placement.fixed | moving)
    return Trajectory(bodies, _frames(polyhedra, placement)[bodies])


def _driven(
    polyhedra: Mapping[str, Polyhedron], placement: Placement, driven: Sequence[int]
) -> Driven:
    bodies = np.asarray(driven, np.int64)
    names = [placement.names[body] for body in bodies]
    return Driven(bodies, names, _frames(polyhedra, placement)[bodies])


def _frames(polyhedra: Mapping[str, Polyhedron], placement: Placement) -> FloatArray:
    """Rotation from the principal frame to the file's axes of each body, shape [body_count, 4]."""
    rotations = np.array([polyhedron.frame_rotation for polyhedron in polyhedra.values()])
    return rotations[placement.shape]
