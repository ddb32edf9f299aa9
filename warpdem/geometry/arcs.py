"""Normal cones of edges and vertices: the directions in which they are a core's nearest point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class EdgeArcs:
    """Directions normal to edges: cos(phi) middle + sin(phi) (u x middle), |phi| <= half.

    Attributes:
        ends: Vertices p, q of each edge, u the unit vector from p to q, shape [arc_count, 2].
        middle: Unit vectors, shape [arc_count, 3].
        half: Half angles [rad], shape [arc_count].
    """

    ends: IntArray
    middle: FloatArray
    half: FloatArray

    def selected(self, kept: BoolArray) -> EdgeArcs:
        """Only the arcs in ``kept``, shape [arc_count]."""
        return EdgeArcs(self.ends[kept], self.middle[kept], self.half[kept])


@dataclass(frozen=True, eq=False)
class Cap:
    """A convex spherical polygon: the normal cone of one vertex.

    Attributes:
        corners: Unit vectors, counter-clockwise seen from outside, shape [corner_count, 3].
        outward: Unit conormal of the arc from each corner to the next, shape [corner_count, 3].
    """

    corners: FloatArray
    outward: FloatArray

    @property
    def angles(self) -> FloatArray:
        """Length of each arc [rad]."""
        following = np.roll(self.corners, -1, axis=0)
        across = np.einsum("ij,ij->i", np.cross(self.corners, following), -self.outward)
        return np.arctan2(across, np.einsum("ij,ij->i", self.corners, following))

    @property
    def solid_angle(self) -> float:
        """Area on the unit sphere [sr], by Gauss and Bonnet."""
        before = np.roll(self.outward, 1, axis=0)
        turn = np.arctan2(
            np.linalg.norm(np.cross(before, self.outward), axis=1),
            np.einsum("ij,ij->i", before, self.outward),
        )
        return float(2.0 * np.pi - turn.sum())


def convex_angle(first: FloatArray, second: FloatArray, along: FloatArray) -> FloatArray:
    """Angle from normal ``first`` to ``second`` about ``along`` [rad]: positive on convex edges.

    ``along`` runs as the side of the facet with normal ``first`` does. Shapes [n, 3].
    """
    sine = np.einsum("ij,ij->i", np.cross(first, second), along)
    return np.arctan2(sine, np.einsum("ij,ij->i", first, second))


def middle_direction(first: FloatArray, second: FloatArray, along: FloatArray) -> FloatArray:
    """Unit vector halfway from normal ``first`` to ``second`` of a convex edge.

    The sum of the normals vanishes on a knife edge, that of the outward side vectors on a flat
    one: the longer is taken.
    """
    normals = first + second
    outward = np.cross(second - first, along)
    keen = np.einsum("ij,ij->i", first, second) < 0.0
    middle = np.where(keen[:, None], outward, normals)
    return middle / np.linalg.norm(middle, axis=1, keepdims=True)


def perpendicular(direction: FloatArray) -> FloatArray:
    """A unit vector normal to each unit vector, shape [n, 3]."""
    axis = np.eye(3)[np.argmin(np.abs(direction), axis=1)]
    normal = np.cross(direction, axis)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def normal_cap(tangents: FloatArray) -> tuple[Cap, int] | None:
    """Directions n with n . e <= 0 for all e, by clipping a hemisphere.

    Args:
        tangents: Unit vectors e that span the tangent cone of a vertex, shape [n, 3], n > 0.

    Returns:
        The polygon, and the number of the vector that bounds its longest arc; None when it has no
        area.
    """
    if np.any(tangents @ tangents[0] < -1.0 + 1e-14):  # a straight edge runs through
        return None
    pole = -tangents[0]
    side = perpendicular(pole[None])[0]
    other = np.cross(pole, side)
    corners = [side, other, -side, -other]
    source = [0, 0, 0, 0]
    for number, tangent in enumerate(tangents[1:], 1):
        corners, source = _clipped(corners, source, tangent, number)
        if len(corners) < 3:
            return None
    cap = Cap(np.array(corners), tangents[source])
    lengths = np.bincount(source, cap.angles)
    return (cap, int(lengths.argmax())) if cap.solid_angle > 1e-12 else None


def _clipped(
    corners: list[FloatArray], source: list[int], tangent: FloatArray, number: int
) -> tuple[list[FloatArray], list[int]]:
    """Part of a spherical polygon where n . tangent <= 0; source[k] bounds the arc after k."""
    height = [float(corner @ tangent) for corner in corners]
    kept: list[FloatArray] = []
    bound: list[int] = []
    for k, corner in enumerate(corners):
        after = (k + 1) % len(corners)
        if height[k] <= 0.0:
            kept.append(corner)
            bound.append(source[k])
            if height[after] > 0.0:
                leaving = _crossing(corner, corners[after], height[k], height[after])
                kept += [leaving, _unit(np.cross(leaving, tangent))]
                bound += [number, number]
        elif height[after] <= 0.0:
            kept.append(_crossing(corner, corners[after], height[k], height[after]))
            bound.append(source[k])
    return _within_arc(kept, bound, number)


def _crossing(a: FloatArray, b: FloatArray, height_a: float, height_b: float) -> FloatArray:
    """Where the arc from a to b, on two sides of a plane, meets it."""
    return _unit(a * abs(height_b) + b * abs(height_a))


def _unit(vector: FloatArray) -> FloatArray:
    return vector / np.linalg.norm(vector)


def _within_arc(
    corners: list[FloatArray], source: list[int], number: int
) -> tuple[list[FloatArray], list[int]]:
    """Without the corner a quarter turn into the new arc where that arc is shorter.

    The corner is there because an arc of half a turn is not given by its ends.
    """
    for k in range(1, len(corners)):
        if source[k] == source[k - 1] == number:
            after = corners[(k + 1) % len(corners)]
            if float(after @ corners[k - 1]) >= 0.0:
                return corners[:k] + corners[k + 1 :], source[:k] + source[k + 1 :]
    return corners, source
