"""Tables of numbers that grow by rows (.csv), cut back to a known length when a run resumes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import OutputError
from warpdem.geometry.orientation import product
from warpdem.output.rows import quoted

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.snapshot import Energy, Snapshot

TRAJECTORY_COLUMNS = "t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz"
ENERGY_COLUMNS = (
    "t,kinetic,potential,elastic,dashpot,friction,rolling,work,external,balance,contacts,"
    "largest_overlap,bond,broken"
)
DRIVERS_COLUMNS = "t,name,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,fx,fy,fz,mx,my,mz,work"

_REAL = "%.17g"  # 17 digits return every double exactly


class Table:
    """A CSV file open for appending whole rows.

    Attributes:
        path: The file.
        length: Bytes of it that were written whole.
        rows: Lines below the head.
    """

    def __init__(self, path: Path, columns: str, length: int | None = None) -> None:
        """Start the table, or go on after its first ``length`` bytes.

        Raises:
            OutputError: The file is shorter than ``length``: somebody else changed it.
            OSError: It cannot be written.
        """
        self.path = path
        if length is not None and (not path.exists() or path.stat().st_size < length):
            raise OutputError(f"{path}: shorter than at the checkpoint; it cannot be continued")
        self._file = path.open("wb" if length is None else "r+b", buffering=0)
        self.rows = self._file.read(length).count(b"\n") - 1 if length is not None else -1
        self.length = length or 0
        self._file.truncate(self.length)
        self._file.seek(self.length)
        if length is None:
            self.append(f"{columns}\n")

    def append(self, rows: str) -> None:
        """Add whole rows, or none of them.

        Raises:
            OSError: The disk is full; the table ends where it did before.
        """
        data = memoryview(rows.encode())
        written = 0
        try:
            while written < len(data):
                written += self._file.write(data[written:])
        except OSError as fault:
            self._file.truncate(self.length)
            self._file.seek(self.length)
            raise OSError(fault.errno, fault.strerror, str(self.path)) from fault
        self.length += written
        self.rows += rows.count("\n")

    def sync(self) -> None:
        """Have the disk hold what was appended."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        self._file.close()


class Trajectory:
    """Rows of the moving bodies, in the axes of their shape files.

    The position is that of the centre of mass. The orientation turns the axes of the shape's own
    file (or of the box as given) to the world, not the principal axes the solver works in:
    ``q_file = q_principal * conjugate(frame_rotation)``.

    Args:
        bodies: Indices of the bodies to list, shape [row_count].
        frame_rotation: Unit quaternion w, x, y, z of each listed body, principal frame to the
            shape's own, shape [row_count, 4].
    """

    def __init__(self, bodies: IntArray, frame_rotation: FloatArray) -> None:
        self.bodies = bodies
        self._to_file_axes = frame_rotation * np.array([1.0, -1.0, -1.0, -1.0])
        self._format = f"{_REAL},%d{f',{_REAL}' * 13}\n" * len(bodies)

    def rows(self, snapshot: Snapshot) -> str:
        """One line a body for one instant; columns as in ``TRAJECTORY_COLUMNS``, world, SI."""
        listed = self.bodies
        table = np.column_stack(
            [
                np.full(len(listed), snapshot.time),
                listed,
                snapshot.position[listed],
                product(snapshot.orientation[listed], self._to_file_axes),
                snapshot.velocity[listed],
                snapshot.spin[listed],
            ]
        )
        return self._format % tuple(table.ravel().tolist())


class Driven:
    """Rows of the bodies that drivers move; written again and again.

    Args:
        bodies: Their numbers, shape [listed_count].
        names: Of these bodies.
        frame_rotation: As for `Trajectory`, of these bodies, shape [listed_count, 4].
    """

    def __init__(self, bodies: IntArray, names: Sequence[str], frame_rotation: FloatArray) -> None:
        self._bodies = bodies
        self._names = [quoted(name) for name in names]
        self._to_file_axes = frame_rotation * np.array([1.0, -1.0, -1.0, -1.0])

    def rows(self, snapshot: Snapshot) -> str:
        """One line a body for one instant; columns as in ``DRIVERS_COLUMNS``, world, SI.

        f and m are the contact force on the body and its moment about the centre of mass.
        """
        assert snapshot.work is not None
        listed = self._bodies
        table = np.column_stack(
            [
                snapshot.position[listed],
                snapshot.velocity[listed],
                product(snapshot.orientation[listed], self._to_file_axes),
                snapshot.spin[listed],
                snapshot.force[listed],
                snapshot.torque[listed],
                snapshot.work[listed],
            ]
        )
        lines = [
            ",".join([_REAL % snapshot.time, name, *(_REAL % value for value in row)])
            for name, row in zip(self._names, table.tolist(), strict=True)
        ]
        return "".join(f"{line}\n" for line in lines)


def energy_row(time: float, energy: Energy) -> str:
    """One line for one instant; columns as in ``ENERGY_COLUMNS`` [s, J, 1, m]."""
    joules = (
        energy.kinetic,
        energy.potential,
        energy.elastic,
        energy.dashpot,
        energy.friction,
        energy.rolling,
        energy.work,
        energy.external,
        energy.balance,
    )
    reals = ",".join(_REAL % value for value in (time, *joules))
    rest = ",".join(_REAL % v for v in (energy.largest_overlap, energy.bond, energy.broken))
    return f"{reals},{energy.contact_count:d},{rest}\n"
