"""Releases of a scene: where and how rocks start."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from warpdem.input.scene_values import (
    Name,
    NotNegative,
    Number,
    Positive,
    Quaternion,
    Section,
    Vector,
)

Place = Annotated[tuple[Number, ...], Field(min_length=2, max_length=3, strict=False)]
PlanPoint = Annotated[tuple[Number, ...], Field(min_length=2, max_length=2, strict=False)]
Dip = Annotated[float, Field(ge=-90, le=90)]


def _shape_of(value: object) -> str:
    return "range" if isinstance(value, list | tuple) else "number"


Amount = Annotated[
    Annotated[NotNegative, Tag("number")]
    | Annotated[
        tuple[NotNegative, ...],
        Field(min_length=2, max_length=2, strict=False),
        Tag("range"),
    ],
    Discriminator(_shape_of),
]
Angle = Annotated[
    Annotated[Number, Tag("number")]
    | Annotated[tuple[Number, ...], Field(min_length=2, max_length=2, strict=False), Tag("range")],
    Discriminator(_shape_of),
]
DipAngle = Annotated[
    Annotated[Dip, Tag("number")]
    | Annotated[tuple[Dip, ...], Field(min_length=2, max_length=2, strict=False), Tag("range")],
    Discriminator(_shape_of),
]
Attitude = Annotated[
    Annotated[Literal["random"], Tag("word")] | Annotated[Quaternion, Tag("number")],
    Discriminator(lambda value: "word" if isinstance(value, str) else "number"),
]


class _Release(Section):
    """What all releases have in common.

    Wherever a range [from, to] is given, each trajectory draws its own number from it, all equally
    likely. What a trajectory draws depends on run.seed and on its number in the ensemble alone.
    """

    rocks: Annotated[tuple[Name, ...], Field(min_length=1, strict=False)] | None = None
    """Names of the rocks drawn from; default: all of the scene."""

    weights: Annotated[tuple[Positive, ...], Field(strict=False)] | None = None
    """How often each of ``rocks`` is drawn, relative to the others; default: equally often."""

    height: Amount | None = None
    """Vertical distance of the rock's lowest point from the ground under it [m], a number or a
    range; default: as the z given says, or else 0.02. A z within the ground is raised to it."""

    velocity: Vector | None = None
    """Initial velocity [m/s]; default: at rest. Or speed."""

    speed: Amount | None = None
    """Initial speed [m/s], a number or a range, along azimuth and dip."""

    azimuth: Angle | None = None
    """Direction of speed, clockwise from north (+y) [degrees], a number or a range."""

    dip: DipAngle | None = None
    """Direction of speed, below the horizontal [degrees], a number or a range; default: 0."""

    spin: Vector | None = None
    """Initial angular velocity, along the world's axes [rad/s]; default: none. Or spin_rate."""

    spin_rate: Amount | None = None
    """Initial angular speed about an axis of any direction [rad/s], a number or a range."""

    orientation: Attitude = "random"
    """"random": every orientation equally likely; or one unit quaternion w, x, y, z that turns the
    rock's own axes, those of its file or shape, into the world's."""

    weight: Positive | None = None
    """Share of the trajectories, relative to the other releases; default: the number of its points
    or rows, 1 for a line or an area. In every stretch of trajectories from the first on, each
    release has its share, rounded; places, points and rows are taken in turn."""


class PointRelease(_Release):
    """Rocks start at points, in turn."""

    kind: Literal["points"]
    points: Annotated[tuple[Place, ...], Field(min_length=1, strict=False)]
    """Centres of mass x, y, or x, y, z, in the coordinates of the terrain [m]; z counts only
    without height."""


class LineRelease(_Release):
    """Rocks start along a line, anywhere equally likely."""

    kind: Literal["line"]
    line: Annotated[tuple[PlanPoint, ...], Field(min_length=2, strict=False)]
    """Points x, y, joined by straight pieces, in the coordinates of the terrain [m]."""


class AreaRelease(_Release):
    """Rocks start within an area, anywhere equally likely on the map."""

    kind: Literal["area"]
    polygon: Annotated[tuple[PlanPoint, ...], Field(min_length=3, strict=False)] | None = None
    """Corners x, y, in the coordinates of the terrain [m]; or file."""

    file: Name | None = None
    """A shapefile (.shp) of polygons, holes left out; needs the extra geo. A relative path starts
    at the scene's folder."""


class Columns(Section):
    """Which column of a table holds what."""

    x: Name = "x"
    """Of the centre of mass, in the coordinates of the terrain [m]."""

    y: Name = "y"
    """Of the centre of mass, in the coordinates of the terrain [m]."""

    z: Name | None = None
    """Of the centre of mass [m]; counts only without height."""

    vx: Name | None = None
    """Initial velocity along x [m/s]."""

    vy: Name | None = None
    """Initial velocity along y [m/s]."""

    vz: Name | None = None
    """Initial velocity along z [m/s]."""

    wx: Name | None = None
    """Initial angular velocity along the world's x [rad/s]."""

    wy: Name | None = None
    """Initial angular velocity along the world's y [rad/s]."""

    wz: Name | None = None
    """Initial angular velocity along the world's z [rad/s]."""

    rock: Name | None = None
    """Name of the rock."""


class TableRelease(_Release):
    """Rocks start as the rows of a table say, in turn."""

    kind: Literal["table"]
    file: Name
    """A text with the names of its columns in the first line, then a row a rock, between commas,
    semicolons or tabs (.csv). A relative path starts at the scene's folder."""

    columns: Columns = Columns()
    """Names of the columns; what is not named is not read."""


Release = Annotated[
    PointRelease | LineRelease | AreaRelease | TableRelease,
    Field(discriminator="kind"),
]
