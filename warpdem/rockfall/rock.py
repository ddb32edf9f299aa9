"""A rock as its trajectory sees it: contact points, mass, inertia."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Rock:
    """A convex rock in its principal frame, the origin its centre of mass.

    Attributes:
        name: Of the rock.
        vertices: Contact points of the core [m], shape [vertex_count, 3].
        rounding: Radius of the balls around them [m]; 0 for sharp corners.
        edges: Vertices of each edge of the hull, shape [edge_count, 2]; a single vertex counts as
            the edge [0, 0].
        mass: [kg].
        inertia: Principal moments [kg m^2], shape [3].
        skin_points: Corners of its outer surface [m], shape [point_count, 3].
        skin_triangles: Outward counter-clockwise, shape [triangle_count, 3].
        frame_rotation: Unit quaternion w, x, y, z from this frame to the axes of the rock's file or
            shape, shape [4].
        notes: What was made of the input, as sentences.
    """

    name: str
    vertices: FloatArray
    rounding: float
    edges: IntArray
    mass: float
    inertia: FloatArray
    skin_points: FloatArray
    skin_triangles: IntArray
    frame_rotation: FloatArray = field(default_factory=lambda: np.array([1.0, 0.0, 0.0, 0.0]))
    notes: tuple[str, ...] = ()

    @property
    def bound(self) -> float:
        """Radius of the bounding sphere about the centre of mass, rounding included [m]."""
        return float(np.linalg.norm(self.vertices, axis=1).max()) + self.rounding
