"""The rounded surface of a polyhedron as drawn: offset faces, strips round edges, caps on vertices.

Where the core is concave the pieces run into one another inside the solid; what shows is right.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.activity import FLAT, side_of_edges
from warpdem.geometry.arcs import perpendicular
from warpdem.geometry.facets import area_vectors, connected, twins

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.geometry.polyhedron import Polyhedron

_STEP = np.pi / 6.0  # largest turn of a strip's segment
_RING = np.radians(55.0)  # largest reach of a ring of a cap: one for a cube's corner
_DETAILED = 5000  # faces beyond which the rounding is smaller than can be seen


@dataclass(frozen=True, eq=False)
class Surface:
    """Polygons, counter-clockwise seen from outside.

    Attributes:
        points: Corner positions [m], shape [point_count, 3].
        connectivity: Points of the polygons one after the other, shape [corner_count].
        offsets: First corner of each polygon, and the number of corners at the end, shape
            [polygon_count + 1].
    """

    points: FloatArray
    connectivity: IntArray
    offsets: IntArray


@dataclass
class _Drawing:
    """Points and polygons while they are being collected."""

    points: list[FloatArray] = field(default_factory=list)
    polygons: list[Sequence[int]] = field(default_factory=list)
    count: int = 0

    def add(self, points: FloatArray) -> range:
        """Numbers of new points, shape [n, 3]."""
        self.points.append(points)
        self.count += len(points)
        return range(self.count - len(points), self.count)

    def at(self, numbers: Sequence[int]) -> FloatArray:
        """Positions of points, shape [n, 3]."""
        if len(self.points) > 1:
            self.points = [np.concatenate(self.points)]
        return self.points[0][list(numbers)]

    def strip(self, first: Sequence[int], second: Sequence[int]) -> None:
        """Quadrilaterals, triangles where points coincide, between two rows of points."""
        for a, b, c, d in zip(first, first[1:], second[1:], second, strict=False):
            corners = [p for p, q in ((a, d), (b, a), (c, b), (d, c)) if p != q]
            if len(corners) > 2:
                self.polygons.append(corners)

    def fan(self, middle: int, ring: list[int]) -> None:
        """Triangles between a point and a closed row of points."""
        self.polygons += [[middle, p, q] for p, q in zip(ring, ring[1:] + ring[:1], strict=True)]

    def surface(self) -> Surface:
        """What was collected, without unused points."""
        length = np.array([len(polygon) for polygon in self.polygons], np.int64)
        connectivity = np.array([p for polygon in self.polygons for p in polygon], np.int64)
        used, number = np.unique(connectivity, return_inverse=True)
        return Surface(
            np.concatenate([np.zeros((0, 3)), *self.points])[used],
            number.astype(np.int32),
            np.concatenate([[0], np.cumsum(length)]).astype(np.int32),
        )


def rounded_surface(shape: Polyhedron) -> Surface:
    """The surface of a shape in its principal frame.

    Closed cores give a closed surface, open ones a closed pillow around them; terrains and meshes
    of more than 5000 faces their triangles, offset by the rounding along the vertices' normals.
    """
    if shape.terrain or len(shape.face_normals) > _DETAILED or shape.radius == 0.0:
        return _offset_triangles(shape)
    drawing = _Drawing()
    if len(shape.face_normals):
        _draw_faces(drawing, shape)
    wires = shape.edges[side_of_edges(shape.edges, shape.facets) < 0]
    for a, b in shape.vertices[wires]:
        _draw_capsule(drawing, a, b, shape.radius)
    lone = np.ones(len(shape.vertices), bool)
    lone[shape.side_vertices] = False
    lone[wires] = False
    for centre in shape.vertices[lone]:
        _draw_ball(drawing, centre, shape.radius)
    return drawing.surface()


def _offset_triangles(shape: Polyhedron) -> Surface:
    triangles, face = shape.triangles
    area = np.linalg.norm(area_vectors(shape.vertices, shape.facets), axis=1)
    weighted = shape.face_normals[face] * area[face][:, None]
    normals = np.zeros_like(shape.vertices)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], weighted)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    normals /= np.where(length > 0.0, length, 1.0)
    return Surface(
        shape.vertices + shape.radius * normals,
        triangles.reshape(-1).astype(np.int32),
        np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int32),
    )


@dataclass(frozen=True, eq=False)
class _Skin:
    """Sides of a closed surface: of a solid, or of both faces of an open core.

    Attributes:
        sides: Vertices a, b, shape [side_count, 2].
        normals: Unit normal of each side's face, shape [side_count, 3].
        following: Next side along the loop, shape [side_count].
        twin: The side that runs b, a, shape [side_count].
    """

    sides: IntArray
    normals: FloatArray
    following: IntArray
    twin: IntArray


def _skin(shape: Polyhedron) -> _Skin:
    facets = shape.facets
    normals = shape.face_normals[facets.owner]
    twin, _ = twins(facets)
    if shape.closed:
        return _Skin(facets.sides, normals, facets.following, twin)
    count = len(twin)
    upper = np.where(twin >= 0, twin, np.arange(count) + count)
    lower = np.where(twin >= 0, twin + count, np.arange(count))
    return _Skin(
        np.concatenate([facets.sides, facets.sides[:, ::-1]]),
        np.concatenate([normals, -normals]),
        np.concatenate([facets.following, facets.preceding + count]),
        np.concatenate([upper, lower]),
    )


def _draw_faces(drawing: _Drawing, shape: Polyhedron) -> None:
    """Draw faces, edges and vertices of a core with faces."""
    skin = _skin(shape)
    own = np.array(drawing.add(shape.vertices[skin.sides[:, 0]] + shape.radius * skin.normals))
    angles = _turns(shape, skin)
    flat = np.flatnonzero(np.abs(angles) <= FLAT)
    corner = own[connected(len(own), flat, skin.following[skin.twin[flat]])].tolist()
    _draw_polygons(drawing, shape, skin, corner)
    rims: list[list[int]] = [[] for _ in corner]
    for side in np.flatnonzero(skin.twin > np.arange(len(corner))):
        _draw_edge(drawing, shape, skin, int(side), angle=angles[side], corner=corner, rims=rims)
    orbit = skin.following[skin.twin]
    unused = set(range(len(corner)))
    for first in range(len(corner)):
        ring: list[int] = []
        side = first
        while side in unused:
            unused.remove(side)
            ring += rims[side]
            side = int(orbit[side])
        _draw_cap(drawing, shape.vertices[skin.sides[first, 0]], shape.radius, ring[::-1])


def _turns(shape: Polyhedron, skin: _Skin) -> FloatArray:
    """Angle from each side's normal to its twin's, positive where convex, shape [side_count]."""
    along = shape.vertices[skin.sides[:, 1]] - shape.vertices[skin.sides[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    other = skin.normals[skin.twin]
    sine = np.einsum("ij,ij->i", np.cross(skin.normals, other), along)
    cosine = np.einsum("ij,ij->i", skin.normals, other)
    # half a turn, whatever its sign, leads round the border of a sheet
    return np.where(cosine < -1.0 + 1e-12, np.pi, np.arctan2(sine, cosine))


def _draw_polygons(drawing: _Drawing, shape: Polyhedron, skin: _Skin, corner: list[int]) -> None:
    """Draw the offset faces; ``corner`` is the point of each side's first vertex."""
    facets = shape.facets
    triangles, owner = shape.triangles
    first_triangle = np.searchsorted(owner, np.arange(facets.count + 1))
    starts = skin.sides[:, 0].tolist()
    for layer in range(1 if shape.closed else 2):
        turn = -1 if layer else 1
        for face, begin, end in zip(
            range(facets.count), facets.start[:-1], facets.start[1:], strict=True
        ):
            rows = range(begin + layer * len(facets.sides), end + layer * len(facets.sides))
            point = {starts[side]: corner[side] for side in rows}
            loops = [facets.sides[begin:end, 0]]
            if not shape.face_convex[face]:
                loops = list(triangles[first_triangle[face] : first_triangle[face + 1]])
            drawing.polygons += [[point[v] for v in loop.tolist()][::turn] for loop in loops]


def _draw_edge(
    drawing: _Drawing,
    shape: Polyhedron,
    skin: _Skin,
    side: int,
    *,
    angle: float,
    corner: list[int],
    rims: list[list[int]],
) -> None:
    """Draw the strip beside a side, and leave the rows of points at its two ends in ``rims``."""
    twin = int(skin.twin[side])
    a, b = shape.vertices[skin.sides[side]]
    count = max(1, int(np.ceil(angle / _STEP - 1e-9)))
    turn = angle / count * np.arange(1, count)[:, None]
    normal = skin.normals[side]
    across = np.cross((b - a) / np.linalg.norm(b - a), normal)
    offset = shape.radius * (np.cos(turn) * normal + np.sin(turn) * across)
    at_a = [corner[side], *drawing.add(a + offset), corner[skin.following[twin]]]
    at_b = [corner[skin.following[side]], *drawing.add(b + offset), corner[twin]]
    drawing.strip(at_a, at_b)
    rims[side] = at_a[:-1]
    rims[twin] = at_b[:0:-1]


def _draw_cap(drawing: _Drawing, vertex: FloatArray, radius: float, ring: list[int]) -> None:
    """Draw a patch of rings around its middle direction, within a closed row of points."""
    ring = [p for p, q in zip(ring, ring[1:] + ring[:1], strict=True) if p != q]
    if len(ring) < 3:
        return
    rim = (drawing.at(ring) - vertex) / radius
    pole = np.cross(rim, np.roll(rim, -1, axis=0)).sum(axis=0)
    pole /= max(float(np.linalg.norm(pole)), 1e-300)
    angle = np.arccos(np.clip(rim @ pole, -1.0, 1.0))
    count = max(1, int(np.ceil(angle.max() / _RING - 1e-9)))
    outer = ring
    for step in range(count - 1, 0, -1):
        fraction = step / count
        direction = _between(pole, rim, angle, fraction)
        inner = [*drawing.add(vertex + radius * direction)]
        drawing.strip([*outer, outer[0]], [*inner, inner[0]])
        outer = inner
    (middle,) = drawing.add((vertex + radius * pole)[None])
    drawing.fan(middle, outer)


def _between(pole: FloatArray, rim: FloatArray, angle: FloatArray, fraction: float) -> FloatArray:
    """Unit vectors a fraction of the way from the pole to the rim."""
    sine = np.maximum(np.sin(angle), 1e-12)[:, None]
    vectors = np.sin((1.0 - fraction) * angle)[:, None] * pole
    vectors = (vectors + np.sin(fraction * angle)[:, None] * rim) / sine
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _draw_capsule(drawing: _Drawing, a: FloatArray, b: FloatArray, radius: float) -> None:
    """Draw a cylinder with hemispheres at its ends, by rings."""
    along = (b - a) / np.linalg.norm(b - a)
    side = perpendicular(along[None])[0]
    turn = 2.0 * np.pi * np.arange(12)[:, None] / 12
    round_axis = np.cos(turn) * side + np.sin(turn) * np.cross(along, side)
    rings = []
    for centre, latitudes in ((a, (-60.0, -30.0, 0.0)), (b, (0.0, 30.0, 60.0))):
        for latitude in np.radians(latitudes):
            direction = np.cos(latitude) * round_axis + np.sin(latitude) * along
            rings.append([*drawing.add(centre + radius * direction)])
    for lower, upper in pairwise(rings):
        drawing.strip([*lower, lower[0]], [*upper, upper[0]])
    (south, north) = drawing.add(np.array([a - radius * along, b + radius * along]))
    drawing.fan(south, rings[0][::-1])
    drawing.fan(north, rings[-1])


def _draw_ball(drawing: _Drawing, centre: FloatArray, radius: float) -> None:
    """Draw a sphere of 150 quadrilaterals, a cube's grid projected from its centre."""
    points, polygons = _ball()
    first = drawing.add(centre + radius * points)[0]
    drawing.polygons += [[first + corner for corner in polygon] for polygon in polygons]


@cache
def _ball() -> tuple[FloatArray, list[list[int]]]:
    """Unit vectors and quadrilaterals of a sphere."""
    count = 5
    ticks = np.tan(np.linspace(-0.25, 0.25, count + 1) * np.pi)
    u, v = (grid.reshape(-1) for grid in np.meshgrid(ticks, ticks, indexing="ij"))
    one = np.ones_like(u)
    # u x v points outward on each side of the cube
    cube = [(one, u, v), (v, one, u), (u, v, one), (-one, v, u), (u, -one, v), (v, u, -one)]
    directions = np.concatenate([np.column_stack(side) for side in cube])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    corner = np.arange(len(directions)).reshape(6, count + 1, count + 1)
    quads = np.stack(
        [corner[:, :-1, :-1], corner[:, 1:, :-1], corner[:, 1:, 1:], corner[:, :-1, 1:]], axis=-1
    )
    points, number = np.unique(np.round(directions, 12), axis=0, return_inverse=True)
    return points, number.reshape(-1)[quads.reshape(-1, 4)].tolist()
