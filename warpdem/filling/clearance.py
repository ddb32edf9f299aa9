"""Whether balls keep clear of polyhedra, exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.boxgrid import BoxGrid
from warpdem.geometry.activity import side_of_edges
from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.analytic import Analytic
    from warpdem.geometry.polyhedron import Polyhedron


class Elements:
    """The core of a shape as triangles; edges and vertices of no face are triangles without area.

    Args:
        shape: The shape, in its principal frame.
    """

    def __init__(self, shape: Polyhedron) -> None:
        triangles, _ = shape.triangles
        wires = shape.edges[side_of_edges(shape.edges, shape.facets) < 0]
        lone = np.ones(len(shape.vertices), bool)
        lone[shape.side_vertices] = False
        lone[wires] = False
        points = np.flatnonzero(lone)
        self.corners = shape.vertices[
            np.concatenate([triangles, wires[:, [0, 1, 1]], np.column_stack([points] * 3)])
        ]
        self._solid = len(triangles)

    @cached_property
    def _grid(self) -> BoxGrid:
        return BoxGrid(self.corners.min(axis=1), self.corners.max(axis=1))

    @cached_property
    def _columns(self) -> BoxGrid:
        flat = self.corners[: self._solid] * np.array([1.0, 1.0, 0.0])
        return BoxGrid(flat.min(axis=1), flat.max(axis=1))

    def touched(self, points: FloatArray, reach: FloatArray) -> BoolArray:
        """Points nearer to the core than ``reach``, shape [point_count]."""
        point, element = self._grid.pairs(points - reach[:, None], points + reach[:, None])
        near = distances(points[point], self.corners[element]) < reach[point]
        touched = np.zeros(len(points), bool)
        touched[point[near]] = True
        return touched

    def covers(self, points: FloatArray) -> IntArray:
        """How many faces lie above each point, along +z; shape [point_count]."""
        base = points * np.array([1.0, 1.0, 0.0])
        point, element = self._columns.pairs(base, base)
        above = _is_below(points[point], self.corners[element])
        return np.bincount(point[above], minlength=len(points))


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A polyhedron in space.

    Attributes:
        shape: The polyhedron.
        elements: Those of the shape; bodies of one shape share them.
        position: Of the origin of the principal frame [m], shape [3].
        orientation: Unit quaternion of the principal frame, shape [4].
        scale: Homothety.
    """

    shape: Polyhedron
    elements: Elements
    position: FloatArray
    orientation: FloatArray
    scale: float

    @cached_property
    def _turn(self) -> FloatArray:
        return matrix(self.orientation)

    def touched(self, centres: FloatArray, radii: FloatArray) -> BoolArray:
        """Balls that meet the rounded solid, lie inside it, or lie below a terrain.

        Args:
            centres: World [m], shape [ball_count, 3].
            radii: [m], shape [ball_count].
        """
        points = (centres - self.position) @ self._turn / self.scale
        reach = radii / self.scale + self.shape.radius
        box = (points + reach[:, None] > self.shape.core_min).all(axis=1)
        box &= (points - reach[:, None] < self.shape.core_max).all(axis=1)
        near = np.flatnonzero(box)
        touched = np.zeros(len(centres), bool)
        if len(near):
            touched[near] = self.elements.touched(points[near], reach[near])
        if self.shape.closed:
            inside = near[~touched[near]]
            if len(inside):
                touched[inside] = self.elements.covers(points[inside]) % 2 == 1
        elif self.shape.terrain:
            touched |= self.elements.covers(points) > 0
        return touched


@dataclass(frozen=True, eq=False)
class SurfaceObstacle:
    """An analytic surface in space.

    Attributes:
        surface: The surface.
        position: Of its origin [m], shape [3].
        orientation: Unit quaternion of its frame, shape [4].
        scale: Homothety.
    """

    surface: Analytic
    position: FloatArray
    orientation: FloatArray
    scale: float

    def touched(self, centres: FloatArray, radii: FloatArray) -> BoolArray:
        """Balls that meet the surface or lie beyond it, shape [ball_count].

        Args:
            centres: World [m], shape [ball_count, 3].
            radii: [m], shape [ball_count].
        """
        points = (centres - self.position) @ matrix(self.orientation) / self.scale
        return self.surface.height(points) < radii / self.scale


def distances(points: FloatArray, triangles: FloatArray) -> FloatArray:
    """Distance of each point from its own triangle, also one without area.

    Args:
        points: Shape [n, 3].
        triangles: Corners, shape [n, 3, 3].
    """
    a, b, c = (triangles[:, k] - points for k in range(3))
    normal = np.cross(b - a, c - a)
    square = np.einsum("ij,ij->i", normal, normal)
    inside = square > 0.0
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(u, v), normal) >= 0.0
    height = np.abs(np.einsum("ij,ij->i", a, normal))
    nearest = np.minimum(_to_segment(a, b), np.minimum(_to_segment(b, c), _to_segment(c, a)))
    return np.where(inside, height / np.sqrt(np.where(inside, square, 1.0)), nearest)


def _to_segment(a: FloatArray, b: FloatArray) -> FloatArray:
    """Distance of the origin from segments a b, shape [n, 3]."""
    along = b - a
    square = np.einsum("ij,ij->i", along, along)
    fraction = -np.einsum("ij,ij->i", a, along) / np.where(square > 0.0, square, 1.0)
    return np.linalg.norm(a + np.clip(fraction, 0.0, 1.0)[:, None] * along, axis=1)


def _is_below(points: FloatArray, triangles: FloatArray) -> BoolArray:
    """Points with their own triangle above them; a border shared by two counts for one of them.

    A point on a border is taken as if moved by (d, d^2), d infinitely small.
    """
    corners = triangles - points[:, None]
    signs, weights = [], []
    for first, second in ((1, 2), (2, 0), (0, 1)):
        a, b = corners[:, first], corners[:, second]
        # exactly the opposite when a and b are exchanged, so that neighbours agree
        weight = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        along = b - a
        tie = np.where(along[:, 1] != 0.0, -along[:, 1], along[:, 0])
        signs.append(np.sign(np.where(weight != 0.0, weight, tie)))
        weights.append(weight)
    inside = (signs[0] == signs[1]) & (signs[1] == signs[2]) & (signs[0] != 0.0)
    total = sum(weights)
    height = sum(weight * corners[:, k, 2] for k, weight in enumerate(weights))
    return inside & (height * np.sign(total) > 0.0)
