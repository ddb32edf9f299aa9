"""Rocks of a scene: what falls down a terrain."""

from typing import Annotated, Literal

from pydantic import Field

from warpdem.input.scene_values import Name, NotNegative, Positive, Section, Vector


class _Rock(Section):
    name: Name
    """By which releases refer to it; one rock a name."""

    mass: Positive | None = None
    """Mass [kg]; a builder takes two of volume, mass and density, all others one of mass and
    density."""

    density: Positive | None = None
    """Mass per volume [kg/m^3]; with a mass instead, its density is mass over volume."""


class _Cored(_Rock):
    rounding: NotNegative = 0.0
    """Minkowski radius [m]; 0: sharp corners. The hull is the core: the rock is larger by it."""


class BuilderRock(_Cored):
    """A random convex polyhedron of a chosen form, of exactly the given volume.

    Its corners lie on an ellipsoid, spread at random but apart from one another. Along its own
    axes x, y, z it extends over a >= b >= c:
    "equant" b/a = c/b = 5/6; "flat" b/a = 5/6, c/b = 1/2; "long" b/a = 1/2, c/b = 5/6.
    The forms are Zingg's (1935, doi:10.3929/ethz-a-000103455), whose classes end at the ratio 2/3;
    5/6 is the middle of what lies above it, and 1/2, our choice, that of 1/3 and 2/3.
    """

    kind: Literal["builder"]
    form: Literal["equant", "flat", "long"]
    """"equant": about as thick as long; "flat": a plate; "long": a rod."""

    volume: Positive | None = None
    """Volume, rounding included [m^3]."""

    vertices: Annotated[int, Field(ge=4, le=500)] = 24
    """Number of its corners."""

    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    """Of its form: another seed is another rock of the same class, whatever run.seed."""


class PointsRock(_Cored):
    """The convex hull of a cloud of points."""

    kind: Literal["points"]
    points: Annotated[tuple[Vector, ...], Field(min_length=4, strict=False)] | None = None
    """The points [m]; or file."""

    file: Name | None = None
    """A text of x, y, z in columns between blanks, commas or semicolons (.pts, .xyz, .csv, .txt);
    further columns, a first line of words or of the number of points, and what follows a # are
    left out. A relative path starts at the scene's folder."""

    scale: Positive = 1.0
    """What the coordinates are multiplied by to be metres."""


class MeshRock(_Cored):
    """The convex hull of a mesh (STL, OBJ, PLY)."""

    kind: Literal["mesh"]
    file: Name
    """The mesh; a relative path starts at the scene's folder."""

    scale: Positive = 1.0
    """What the file's coordinates are multiplied by to be metres."""


class ShpRock(_Rock):
    """A shape of a Rockable library file, or its hull where it is not convex.

    Its rounding stands in that file.
    """

    kind: Literal["shp"]
    file: Name
    """The library; a relative path starts at the scene's folder."""

    item: Name | None = None
    """Name within the library; default: the rock's name."""


class ShapeRock(_Rock):
    """A [[shape]] of the scene, or its hull where it is not convex."""

    kind: Literal["shape"]
    shape: Name
    """Name of the shape: a solid, neither a terrain nor a plane, cylinder or ball."""


Rock = Annotated[
    BuilderRock | PointsRock | MeshRock | ShpRock | ShapeRock,
    Field(discriminator="kind"),
]
