"""The touching sub-contacts as a grid of points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.snapshot import CellState, Contacts


def grid(contacts: Contacts, cell: CellState | None = None) -> vtkUnstructuredGrid:
    """Contact points, wrapped into a periodic cell, with what acts there.

    Point data: ``normal`` from body j to i; ``fn`` along it, positive repels [N]; ``ft`` on i [N];
    ``force`` on i, both together [N]; ``gap``, negative in overlap [m]; ``bodies`` i, j; ``kind``,
    0 vertex-vertex, 1 vertex-edge, 2 edge-vertex, 3 vertex-face, 4 face-vertex, 5 edge-edge;
    ``moment`` on i [N m]; ``bonded``, 1 for a bond, which may be open.
    """
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK

    force = contacts.normal_force[:, None] * contacts.normal + contacts.tangential_force
    data = {
        "normal": contacts.normal,
        "fn": contacts.normal_force,
        "ft": contacts.tangential_force,
        "force": force,
        "gap": contacts.gap,
        "bodies": contacts.bodies,
        "kind": contacts.kind,
        "moment": contacts.moment,
        "bonded": contacts.bonded.astype(np.uint8),
    }
    point = contacts.point if cell is None else cell.wrapped(contacts.point)
    return vtu.vertices(point, data)
