"""Shapes of a scene: the solids its bodies are made of."""

from typing import Annotated, Any, Literal

from pydantic import Field

from warpdem.input.scene_values import (
    Loop,
    Name,
    NotNegative,
    Positive,
    PositiveVector,
    Section,
    Segment,
    Vector,
)


def _box_rounding(known: dict[str, Any]) -> float:
    return 0.05 * min(known["size"])


class _Shape(Section):
    name: Name
    """By which bodies refer to it; one shape a name."""


class _Declarable(_Shape):
    """A shape whose mass properties may be declared rather than computed.

    Give both keys or neither. With them the shape's own origin and axes are taken as its centre of
    mass and principal axes.
    """

    volume: Positive | None = None
    """Declared volume of the rounded solid [m^3]; default: computed."""

    inertia_over_mass: PositiveVector | None = None
    """Declared principal moments of inertia over the mass [m^2]; default: computed."""


class BoxShape(_Declarable):
    """A box with rounded edges and corners, centred on its origin, along its axes."""

    kind: Literal["box"]
    size: PositiveVector
    """Outer edge lengths, rounding included [m]."""

    rounding: Positive = Field(default_factory=_box_rounding)
    """Minkowski radius [m]; default: 5 % of the smallest size; at most half of it."""


class SphereShape(_Shape):
    """A sphere, centred on its origin."""

    kind: Literal["sphere"]
    radius: Positive
    """Radius [m]."""


class CapsuleShape(_Shape):
    """A cylinder with hemispherical ends along its z axis, centred on its origin."""

    kind: Literal["capsule"]
    radius: Positive
    """Radius of the cylinder and of its ends [m]."""

    length: Positive
    """Length between the centres of its ends [m]; it is longer by twice the radius."""


class PlaneShape(_Shape):
    """A plane, for fixed bodies: all of z <= 0 in the shape's own axes is solid.

    It is infinite, and pushes back a body however deep. As of all analytic surfaces only vertices
    meet it, which is exact for convex bodies; it costs less than a box or a mesh.
    """

    kind: Literal["plane"]
    extent: Positive | None = None
    """Edge length of the square that is drawn [m]; default: as the bodies need at the start."""


class CylinderShape(_Shape):
    """A cylindrical container, for fixed bodies: what lies beyond its radius of z is solid.

    It has no ends: close it by planes. A solid cylinder is a capsule, or a mesh.
    """

    kind: Literal["cylinder"]
    radius: Positive
    """Radius [m]."""

    inside: bool = True
    """Bodies are inside; nothing else is possible."""

    length: Positive | None = None
    """Length of the tube that is drawn [m]; default: as the bodies need at the start."""


class BallShape(_Shape):
    """A hollow ball, for fixed bodies: a container, solid beyond its radius."""

    kind: Literal["ball"]
    radius: Positive
    """Radius of the hollow [m]."""

    inside: bool = True
    """Bodies are inside; nothing else is possible: a solid ball is a sphere."""


class MeshShape(_Declarable):
    """A solid bounded by the surface in a mesh file (STL, OBJ, PLY), or an open surface."""

    kind: Literal["mesh"]
    file: Name
    """The mesh; a relative path starts at the scene's folder."""

    scale: Positive = 1.0
    """What the file's coordinates are multiplied by to be metres."""

    rounding: Positive
    """Minkowski radius [m]; the mesh is the core, so the solid is larger by it."""


class PolyhedronShape(_Declarable):
    """A solid, plate, frame or set of points given by its core's vertices, edges and faces."""

    kind: Literal["polyhedron"]
    vertices: Annotated[tuple[Vector, ...], Field(min_length=1, strict=False)]
    """Corners of the core [m]."""

    faces: Annotated[tuple[Loop, ...], Field(strict=False)] = ()
    """Planar polygons, each a list of vertex numbers from 0, counter-clockwise seen from
    outside."""

    edges: Annotated[tuple[Segment, ...], Field(strict=False)] | None = None
    """Segments between two vertex numbers; default: the borders of the faces."""

    rounding: Positive
    """Minkowski radius [m]."""


class ShpShape(_Declarable):
    """A shape of a Rockable library file; its rounding stands in that file."""

    kind: Literal["shp"]
    file: Name
    """The library; a relative path starts at the scene's folder."""

    item: Name | None = None
    """Name within the library; default: the shape's name."""


class TerrainShape(_Shape):
    """Ground from a raster of heights (ESRI ASCII grid), for fixed bodies.

    Heights are nodes: row r, column c of the raster lies at x = xllcorner + c cellsize,
    y = yllcorner + (nrows - 1 - r) cellsize. Each cell is two triangles; cells without data are
    holes.
    """

    kind: Literal["terrain"]
    file: Name
    """The raster; a relative path starts at the scene's folder."""

    rounding: NotNegative = 0.0
    """Minkowski radius [m]: the ground lies higher by it."""


Shape = Annotated[
    BoxShape
    | SphereShape
    | CapsuleShape
    | PlaneShape
    | CylinderShape
    | BallShape
    | MeshShape
    | PolyhedronShape
    | ShpShape
    | TerrainShape,
    Field(discriminator="kind"),
]

ANALYTIC = ("plane", "cylinder", "ball")
"""Kinds of the shapes that are surfaces given by a formula."""
