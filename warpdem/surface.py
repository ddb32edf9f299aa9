"""The rounded surface of a polyhedron as drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.polyhedron import Polyhedron


@dataclass(frozen=True, eq=False)
class Surface:
    """Polygons.

    Attributes:
        points: Corner positions [m], shape [point_count, 3].
        connectivity: Points of the polygons one after the other, shape [corner_count].
        offsets: First corner of each polygon, and their number at the end,
            shape [polygon_count + 1].
    """

    points: FloatArray
    connectivity: IntArray
    offsets: IntArray


def rounded_surface(shape: Polyhedron) -> Surface:
    raise NotImplementedError
