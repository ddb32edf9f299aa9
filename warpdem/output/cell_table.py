"""The periodic cell at each frame as a table (cell.csv)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.snapshot import CellState

AXES = "xyz"


def _tensor(symbol: str) -> str:
    """Columns of a tensor, by rows."""
    return ",".join(f"{symbol}_{a}{b}" for a in AXES for b in AXES)


CELL_COLUMNS = ",".join(
    [
        "t,volume,solid_fraction,pressure",
        _tensor("stress"),
        _tensor("kinetic"),
        _tensor("rate"),
        _tensor("deformation"),
        _tensor("edge"),
    ]
)


def cell_row(time: float, cell: CellState) -> str:
    """One line for one instant [s, m^3, 1, Pa, Pa, Pa, 1/s, 1, m]; compression is positive.

    stress: of contacts and motion together; kinetic: the part of motion; rate: velocity gradient;
    deformation: its gradient since the start; edge_xy: x component of the cell's edge y. Positions
    of trajectory.csv are not wrapped into the cell: whole multiples of its edges may be added.
    """
    stress = cell.stress
    parts = (
        [time, cell.volume, cell.solid_fraction, np.trace(stress) / 3.0],
        stress,
        cell.kinetic_stress,
        cell.velocity_gradient,
        cell.deformation,
        cell.edges,
    )
    return ",".join(f"{value:.17g}" for part in parts for value in np.ravel(part)) + "\n"
