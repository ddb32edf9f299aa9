"""The periodic cell as a box of six faces."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.snapshot import CellState

# corners by their halves along x, y, z; faces as loops of them
CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
FACES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def grid(cell: CellState) -> vtkUnstructuredGrid:
    """The box at one instant; show it as a wireframe."""
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK

    points = cell.centre + CORNERS @ cell.edges.T
    ends = 4 * np.arange(len(FACES) + 1, dtype=np.int32)
    return vtu.polygons(points, FACES.ravel().astype(np.int32), ends, {})
