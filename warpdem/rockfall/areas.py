"""Points in areas of the map, all equally likely."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.rockfall.random import Purpose, Streams
from warpdem.rockfall.shapefiles import polygons_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import BoolArray, FloatArray

_SLENDER = 1e-4  # the least part of its box that an area may fill, for drawing to end soon


@dataclass(frozen=True, eq=False)
class Area:
    """A polygon with holes.

    Attributes:
        rings: Corners of the border and of the holes, in either turn, each of shape [n, 2] [m].
    """

    rings: tuple[FloatArray, ...]

    @property
    def size(self) -> float:
        """Surface on the map [m^2]."""
        border, *holes = (abs(_signed_area(ring)) for ring in self.rings)
        return border - sum(holes)

    @property
    def box(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest corner, shapes [2]."""
        return self.rings[0].min(axis=0), self.rings[0].max(axis=0)

    def holds(self, points: FloatArray) -> BoolArray:
        """Which points lie inside; shape [n, 2] to [n].

        A line from the point towards +x crosses the rings an odd number of times.
        """
        inside = np.zeros(len(points), bool)
        for ring in self.rings:
            for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
                spans = (ay <= points[:, 1]) != (by <= points[:, 1])
                left = (bx - ax) * (points[:, 1] - ay) - (by - ay) * (points[:, 0] - ax)
                inside ^= spans & ((left > 0.0) == (by > ay))
        return inside

    def drawn(self, streams: Streams) -> FloatArray:
        """A point for each trajectory, uniform over the area, shape [n, 2]."""
        low, high = self.box
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        tries = streams.accepted(Purpose.PLACE, 2, lambda parts: self.holds(middle + half * parts))
        return middle + half * tries


def checked_areas(areas: Sequence[Area]) -> tuple[Area, ...]:
    """The areas.

    Raises:
        GeometryError: One of them has no surface, or hardly any.
    """
    for number, area in enumerate(areas):
        low, high = area.box
        if not area.size > _SLENDER * float(np.prod(high - low)):
            corner = ", ".join(f"{x:.12g}" for x in area.rings[0][0])
            raise GeometryError(
                f"polygon {number}, with a corner at ({corner}), has no surface, or less than "
                f"{_SLENDER:g} of its box; cut it into pieces along its length, or give a line"
            )
    return tuple(areas)


def drawn_points(areas: Sequence[Area], streams: Streams) -> FloatArray:
    """A point for each trajectory, uniform over the areas, shape [n, 2]."""
    sizes = np.cumsum([area.size for area in areas])
    chosen = np.searchsorted(sizes, streams.uniform(Purpose.AREA) * sizes[-1], side="right")
    chosen = np.minimum(chosen, len(areas) - 1)
    found = np.empty((len(streams.ids), 2))
    for number in np.unique(chosen):
        rows = chosen == number
        found[rows] = areas[number].drawn(Streams(streams.seed, streams.ids[rows]))
    return found


def read_areas(path: Path, origin: FloatArray) -> tuple[Area, ...]:
    """The polygons of a shapefile, less ``origin``, shape [2].

    Raises:
        GeometryError: The file cannot be read, or holds no polygons.
        WarpdemError: The extra geo is not installed.
    """
    outlines = [shape.__geo_interface__ for shape, _ in polygons_of(path)]
    polygons = []
    for outline in outlines:
        if outline["type"] == "Polygon":
            polygons.append(outline["coordinates"])
        elif outline["type"] == "MultiPolygon":
            polygons.extend(outline["coordinates"])
    return tuple(Area(tuple(_ring(ring, origin) for ring in rings)) for rings in polygons)


def _ring(corners: Sequence[Sequence[float]], origin: FloatArray) -> FloatArray:
    return np.array([corner[:2] for corner in corners], float) - origin


def _signed_area(ring: FloatArray) -> float:
    x, y = (ring - ring[0]).T
    return 0.5 * float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
