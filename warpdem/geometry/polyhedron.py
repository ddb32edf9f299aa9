"""A shape: a core of vertices, edges and planar faces with a rounding laid around it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry import surface
from warpdem.geometry.activity import active_edges, active_vertices, borders
from warpdem.geometry.assembly import (
    assembled,
    check_crossing,
    checked_edges,
    convex_faces,
    is_convex,
)
from warpdem.geometry.facets import Facets, twins
from warpdem.geometry.inertia import solid_properties
from warpdem.geometry.moments import MassProperties
from warpdem.geometry.orientation import from_matrix, principal_axes
from warpdem.geometry.polygon import triangulated
from warpdem.geometry.quadrature import overlapping_properties
from warpdem.geometry.remembered import remembered

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.analytic import Analytic
    from warpdem.geometry.core import Core

_OPEN = 1000  # faces beyond which an open surface is taken for a wall, without mass


class Face(NamedTuple):
    """A planar face.

    Attributes:
        loops: Vertex numbers of the outer border, counter-clockwise about the normal, and of the
            holes, clockwise.
        normal: Unit normal, shape [3].
    """

    loops: tuple[IntArray, ...]
    normal: FloatArray


@dataclass(frozen=True, eq=False)
class Polyhedron:
    """A sphero-polyhedron in its principal frame, the origin its centre of mass.

    A point x of the frame lies at frame_origin + R(frame_rotation) x in the shape's own frame.

    Attributes:
        name: Of the shape.
        radius: Minkowski radius of the rounding [m].
        vertices: Of the core [m], shape [vertex_count, 3].
        edges: Vertices of each edge, shape [edge_count, 2].
        side_start: First side of each face, shape [face_count + 1].
        side_vertices: Directed sides a -> b of the faces, holes included, each loop after the
            other; the face lies on the left seen against its normal. Shape [side_count, 2].
        side_neighbour: Face on the other side, or -1, shape [side_count].
        face_normals: Unit normals, outward for closed solids, shape [face_count, 3].
        face_offsets: Distance of each face's plane from the origin along its normal [m],
            shape [face_count].
        face_convex: Convex polygon without holes, shape [face_count].
        closed: The faces bound a solid.
        convex: The core is a convex set, within 1e-6 rad and 1e-6 of its size.
        two_sided: Faces can be touched from both sides: an open surface that is no terrain.
        terrain: Faces are ground, touched from above only.
        vertex_active: Vertices that can touch other bodies, shape [vertex_count].
        edge_active: Edges that can touch other bodies, shape [edge_count].
        cone_start: First plane of the cone of each vertex, then of each edge, shape
            [vertex_count + edge_count + 1]; all 0 but for terrain.
        cone_planes: A feature of a terrain touches along the direction d, outward, where d . c >= 0
            for all its planes c; shape [cone_plane_count, 3].
        volume: Of the rounded solid [m^3]; 0 when the mass is unknown.
        inertia_over_mass: Principal moments over the mass [m^2], shape [3].
        volume_error: Estimated relative error of volume and inertia; 0 where exact or declared.
        mass_known: Volume and inertia are computed or declared; False for open surfaces without.
        frame_origin: Origin in the shape's own frame [m], shape [3].
        frame_rotation: Unit quaternion w, x, y, z from this frame to the shape's own, shape [4].
        notes: Repairs made, as sentences.
        analytic: The surface this stands for instead, whose origin is the only vertex; or None.
    """

    name: str
    radius: float
    vertices: FloatArray
    edges: IntArray
    side_start: IntArray
    side_vertices: IntArray
    side_neighbour: IntArray
    face_normals: FloatArray
    face_offsets: FloatArray
    face_convex: BoolArray
    closed: bool
    convex: bool
    two_sided: bool
    terrain: bool
    vertex_active: BoolArray
    edge_active: BoolArray
    cone_start: IntArray
    cone_planes: FloatArray
    volume: float
    inertia_over_mass: FloatArray
    volume_error: float
    mass_known: bool
    frame_origin: FloatArray
    frame_rotation: FloatArray
    notes: tuple[str, ...] = ()
    analytic: Analytic | None = None

    @cached_property
    def bound(self) -> float:
        """Radius of the bounding sphere about the origin, rounding included [m].

        A length of its size for an analytic surface, which has no bounds.
        """
        if self.analytic:
            return self.analytic.bound
        return float(np.sqrt(np.einsum("ij,ij->i", self.vertices, self.vertices).max())) + (
            self.radius
        )

    @cached_property
    def core_min(self) -> FloatArray:
        """Lowest corner of the core's box [m], shape [3]."""
        return self.vertices.min(axis=0)

    @cached_property
    def core_max(self) -> FloatArray:
        """Highest corner of the core's box [m], shape [3]."""
        return self.vertices.max(axis=0)

    @cached_property
    def facets(self) -> Facets:
        """The faces as rows of sides."""
        return Facets(self.side_start, self.side_vertices)

    @cached_property
    def faces(self) -> tuple[Face, ...]:
        """The faces one by one."""
        return tuple(
            Face(tuple(self.facets.loops(face)), normal)
            for face, normal in enumerate(self.face_normals)
        )

    @cached_property
    def triangles(self) -> tuple[IntArray, IntArray]:
        """The faces cut into triangles: vertices, shape [n, 3], and the face of each, shape [n]."""
        return triangulated(self.vertices, self.facets, self.face_normals, self.face_convex)

    @cached_property
    def surface(self) -> surface.Surface:
        """The rounded surface as drawn, in this frame."""
        return surface.rounded_surface(self)


def build(
    vertices: FloatArray | Sequence[Sequence[float]],
    faces: IntArray | Sequence[Sequence[int]],
    *,
    name: str,
    radius: float,
    edges: IntArray | Sequence[Sequence[int]] | None = None,
    declared: tuple[float, Sequence[float]] | None = None,
    repair: bool = True,
    keep_features: bool = False,
) -> Polyhedron:
    """A polyhedron from its core.

    Volume and inertia of the rounded solid are exact for convex cores and converged, with an
    estimate of the error, for others: a second for some hundred facets, half a minute for some
    thousand. They stay unknown for open surfaces without rounding, of more than 1000 faces, or
    with more than two faces on an edge.

    Args:
        vertices: Positions in the shape's own frame [m], shape [vertex_count, 3].
        faces: Vertex numbers of planar polygons; those of a closed surface are turned outward.
        name: Of the shape.
        radius: Minkowski radius [m].
        edges: Segments, shape [edge_count, 2]; default: the borders of the faces. Given edges
            exclude repairs.
        declared: Volume [m^3] and principal moments over mass [m^2]; the shape's own frame is then
            taken as the principal one.
        repair: Weld vertices, drop degenerate and duplicate facets, merge coplanar ones.
        keep_features: All vertices and edges can touch, flat and concave ones too.

    Raises:
        GeometryError: The core is no solid, plate, frame or set of points that can be simulated;
            names the shape, the cause and a remedy.
    """
    try:
        core, notes = assembled(vertices, faces, edges, repair=repair and edges is None)
        segments = borders(core.facets) if edges is None else checked_edges(edges, len(vertices))
        convex = is_convex(core)
        mass = _mass(core, radius, declared, convex=convex)
    except GeometryError as error:
        raise GeometryError(f'shape "{name}": {error}') from None
    count = len(core.vertices)
    edge_active = np.ones(len(segments), bool)
    vertex_active = np.ones(count, bool)
    if not keep_features:
        edge_active = active_edges(core, segments)
        vertex_active = active_vertices(count, segments, edge_active)
    return in_frame(
        core,
        mass,
        name=name,
        radius=radius,
        edges=segments.astype(np.int32),
        convex=convex,
        two_sided=not core.closed,
        terrain=False,
        vertex_active=vertex_active,
        edge_active=edge_active,
        cone_start=np.zeros(count + len(segments) + 1, np.int32),
        cone_planes=np.zeros((0, 3)),
        notes=tuple(notes),
    )


def _mass(
    core: Core, radius: float, declared: tuple[float, Sequence[float]] | None, *, convex: bool
) -> MassProperties | None:
    """Mass properties, declared or computed; None where they are unknown."""
    if declared is not None:
        volume, moments = declared
        return MassProperties(volume, np.zeros(3), np.diag(np.array(moments, float)))
    if core.closed and not convex:
        check_crossing(core)
    if convex or (core.closed and radius == 0.0):
        return solid_properties(core, radius) if core.closed or radius > 0.0 else None
    if not core.closed and (radius == 0.0 or core.facets.count > _OPEN or _is_crowded(core)):
        return None
    return remembered(overlapping_properties, core, radius)


def _is_crowded(core: Core) -> bool:
    """Whether more than two faces meet in an edge."""
    return bool(twins(core.facets)[1].any())


def in_frame(
    core: Core, mass: MassProperties | None, *, origin: FloatArray | None = None, **known: Any
) -> Polyhedron:
    """The polyhedron of a core moved to its principal frame.

    Args:
        core: In the shape's own frame, or, with ``origin``, already about it.
        mass: Mass properties, None when unknown.
        origin: Point of the shape's own frame that the core has been moved from.
        known: The attributes of the polyhedron that do not follow from core and mass.
    """
    start, moments, axes = np.zeros(3), np.zeros(3), np.eye(3)
    if mass is not None:
        start = mass.centre
        moments, axes = principal_axes(mass.inertia_over_mass, mass.error)
    moved = replace(core, vertices=(core.vertices - start) @ axes)
    sides = core.facets.sides
    height = np.einsum("ij,ij->i", moved.vertices[sides[:, 0]], moved.normals[core.facets.owner])
    length = np.diff(core.facets.start)
    owner = np.append(core.facets.owner, -1)
    return Polyhedron(
        vertices=moved.vertices,
        side_start=core.facets.start.astype(np.int32),
        side_vertices=sides.astype(np.int32),
        side_neighbour=owner[core.twin].astype(np.int32),
        face_normals=moved.normals,
        face_offsets=np.bincount(core.facets.owner, height, minlength=len(length)) / length,
        face_convex=convex_faces(core),
        closed=core.closed,
        volume=mass.volume if mass else 0.0,
        inertia_over_mass=moments,
        volume_error=mass.error if mass else 0.0,
        mass_known=mass is not None,
        frame_origin=start if origin is None else origin,
        frame_rotation=from_matrix(axes),
        **known,
    )
