"""Surfaces given by a formula: a plane, the inside of a cylinder or of a ball."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from warpdem.geometry.surface import Surface

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray

_AROUND = 48  # sides of a drawn circle
_RINGS = 24  # of a drawn ball


@dataclass(frozen=True)
class Analytic:
    """A surface in its own frame, infinite but for how it is drawn.

    Attributes:
        kind: What is solid: "plane", z <= 0; "cylinder", beyond ``radius`` of the z axis; "ball",
            beyond ``radius`` of the origin.
        radius: [m]; 0 for a plane.
        extent: Edge of the drawn patch of a plane, length of a drawn cylinder [m]; None: as the
            bodies of the scene need.
    """

    kind: Literal["plane", "cylinder", "ball"]
    radius: float
    extent: float | None

    @property
    def bound(self) -> float:
        """A length of its size [m]."""
        return self.radius or self.extent or 1.0

    def height(self, points: FloatArray) -> FloatArray:
        """Distances of points from it, positive on its free side [m], shape [point_count]."""
        if self.kind == "plane":
            return points[:, 2]
        axes = 2 if self.kind == "cylinder" else 3
        return self.radius - np.linalg.norm(points[:, :axes], axis=1)

    def drawn(self, reach: float) -> Surface:
        """Polygons that show it out to about ``reach`` from its origin where it has no extent."""
        half = 0.5 * self.extent if self.extent else reach
        if self.kind == "plane":
            corners = half * np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
            return Surface(corners, np.arange(4), np.array([0, 4]))
        angle = 2.0 * np.pi * np.arange(_AROUND) / _AROUND
        circle = self.radius * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        if self.kind == "cylinder":
            end = np.array([0.0, 0.0, half])
            return _rings(np.stack([circle - end, circle + end]))
        polar = np.pi * np.arange(_RINGS + 1) / _RINGS
        flat = np.sin(polar)[:, None, None] * circle
        return _rings(flat - self.radius * np.cos(polar)[:, None, None] * np.array([0.0, 0.0, 1.0]))


def _rings(points: FloatArray) -> Surface:
    """Quadrilaterals between closed rings of points, seen from inside; shape [ring, side, 3]."""
    rings, sides, _ = points.shape
    number = np.arange(rings * sides).reshape(rings, sides)
    following = np.roll(number, -1, axis=1)
    corners: IntArray = np.stack([number[:-1], number[1:], following[1:], following[:-1]], axis=-1)
    count = (rings - 1) * sides
    return Surface(points.reshape(-1, 3), corners.reshape(-1), 4 * np.arange(count + 1))
