"""The core of a sphero-polyhedron, the set its rounding is laid around, and its normal cones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.arcs import (
    Cap,
    EdgeArcs,
    convex_angle,
    middle_direction,
    normal_cap,
    perpendicular,
)
from warpdem.geometry.facets import area_vectors, connected

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.facets import Facets


@dataclass(frozen=True, eq=False)
class Core:
    """Facets, and edges and vertices that belong to no facet.

    Attributes:
        vertices: Positions [m], shape [vertex_count, 3].
        facets: Planar polygons.
        twin: The side of another facet along each side, or -1, shape [side_count].
        wires: Edges on no facet, shape [wire_count, 2].
        points: Vertices on no facet and no edge, shape [point_count].
        closed: The facets bound solids and have outward normals.
    """

    vertices: FloatArray
    facets: Facets
    twin: IntArray
    wires: IntArray
    points: IntArray
    closed: bool

    @cached_property
    def area_vectors(self) -> FloatArray:
        """Shape [facet_count, 3]."""
        return area_vectors(self.vertices, self.facets)

    @cached_property
    def normals(self) -> FloatArray:
        """Unit normals of the facets, shape [facet_count, 3]; zero for one without area."""
        length = np.linalg.norm(self.area_vectors, axis=1, keepdims=True)
        return self.area_vectors / np.where(length > 0.0, length, 1.0)

    @cached_property
    def side_directions(self) -> FloatArray:
        """Unit vectors along the sides, shape [side_count, 3]."""
        a, b = self.vertices[self.facets.sides[:, 0]], self.vertices[self.facets.sides[:, 1]]
        return (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)

    @cached_property
    def side_angles(self) -> FloatArray:
        """Angle from each facet's normal to its neighbour's [rad], pi on a border.

        Positive on convex edges, negative on concave ones; shape [side_count].
        """
        angle = np.full(len(self.twin), np.pi)
        paired = np.flatnonzero(self.twin >= 0)
        normals = self.normals[self.facets.owner]
        angle[paired] = convex_angle(
            normals[paired], normals[self.twin[paired]], self.side_directions[paired]
        )
        return angle

    @cached_property
    def edge_arcs(self) -> EdgeArcs:
        """Normal cones of all edges that have one."""
        folds, borders = self._fold_arcs(), self._border_arcs()
        along = self.vertices[self.wires[:, 1]] - self.vertices[self.wires[:, 0]]
        around = perpendicular(along / np.linalg.norm(along, axis=1, keepdims=True))
        return EdgeArcs(
            np.concatenate([folds.ends, borders.ends, self.wires]),
            np.concatenate([folds.middle, borders.middle, around]),
            np.concatenate([folds.half, borders.half, np.full(len(along), np.pi)]),
        )

    def _fold_arcs(self) -> EdgeArcs:
        """Of the edges between two facets; an open surface counts its outer and inner side."""
        first = np.flatnonzero(self.twin > np.arange(len(self.twin)))
        angle = self.side_angles[first]
        first = first[angle > 0.0] if self.closed else first[angle != 0.0]
        angle = self.side_angles[first]
        upper = np.sign(angle)[:, None]
        normals = self.normals[self.facets.owner]
        along = self.side_directions[first]
        middle = middle_direction(
            upper * normals[first], upper * normals[self.twin[first]], upper * along
        )
        return EdgeArcs(self.facets.sides[first], middle, 0.5 * np.abs(angle))

    def _border_arcs(self) -> EdgeArcs:
        border = np.flatnonzero(self.twin < 0)
        outward = np.cross(self.side_directions[border], self.normals[self.facets.owner[border]])
        return EdgeArcs(self.facets.sides[border], outward, np.full(len(border), 0.5 * np.pi))

    @cached_property
    def corner_angles(self) -> FloatArray:
        """Angle inside the facet at the first vertex of each side [rad], in (0, 2 pi)."""
        onward = self.side_directions
        back = -self.side_directions[self.facets.preceding]
        normals = self.normals[self.facets.owner]
        sine = np.einsum("ij,ij->i", np.cross(onward, back), normals)
        return np.arctan2(sine, np.einsum("ij,ij->i", onward, back)) % (2.0 * np.pi)

    @cached_property
    def plain_vertices(self) -> BoolArray:
        """Vertices of a closed surface with convex edges only, in one fan; shape [vertex_count]."""
        plain = np.zeros(len(self.vertices), bool)
        if not self.closed or not self.facets.count:
            return plain
        sides = self.facets.sides
        plain[sides] = True
        plain[sides[self.side_angles < -1e-12]] = False  # flat but for rounding is plain
        paired = np.flatnonzero(self.twin >= 0)
        fan = connected(len(sides), paired, self.facets.following[self.twin[paired]])
        fans = np.bincount(sides[np.unique(fan), 0], minlength=len(plain))
        return plain & (fans == 1)

    @cached_property
    def caps(self) -> list[tuple[int, Cap]]:
        """Normal cones of the vertices that are not plain, but for those without facet or edge."""
        starts, spokes, convex = self._spokes()
        found = []
        for rows in np.split(np.arange(len(starts)), np.flatnonzero(np.diff(starts)) + 1):
            cone = normal_cap(spokes[rows]) if len(rows) else None
            # a cone bounded by a concave edge points into the solid
            if cone is not None and convex[rows[cone[1]]]:
                found.append((int(starts[rows[0]]), cone[0]))
        return found

    def _spokes(self) -> tuple[IntArray, FloatArray, BoolArray]:
        """Edges out of the vertices that may have caps: vertex, unit vector, is not concave."""
        sides, directions = self.facets.sides, self.side_directions
        border = self.twin < 0
        along = self.vertices[self.wires[:, 1]] - self.vertices[self.wires[:, 0]]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        starts = np.concatenate([sides[:, 0], sides[border, 1], self.wires[:, 0], self.wires[:, 1]])
        spokes = np.concatenate([directions, -directions[border], along, -along])
        convex = np.ones(len(starts), bool)
        convex[: len(sides)] = (self.side_angles > 0.0) | (not self.closed)
        wanted = ~self.plain_vertices
        # the two sides of a corner over pi span a plane: no cone is left but a line
        wanted[sides[self.corner_angles > np.pi, 0]] = False
        order = np.argsort(starts, kind="stable")
        order = order[wanted[starts[order]]]
        return starts[order], spokes[order], convex[order]
