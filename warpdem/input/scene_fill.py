"""Generated bodies of a scene: how many, where, how large, which way up."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from warpdem.input.scene_values import Name, NotNegative, Positive, Quaternion, Section, Vector


class Region(Section):
    """An upright box in space."""

    min: Vector
    """Its lowest corner [m]."""

    max: Vector
    """Its highest corner [m]."""


class _CutSize(Section):
    min: Positive
    """Smallest factor drawn."""

    max: Positive
    """Largest factor drawn."""


class ConstantSize(Section):
    """All bodies equally large."""

    kind: Literal["constant"] = "constant"
    mean: Positive = 1.0
    """The factor."""


class UniformSize(_CutSize):
    """Factors spread evenly between two bounds."""

    kind: Literal["uniform"]


class NormalSize(_CutSize):
    """Normally distributed factors, drawn again when outside the bounds."""

    kind: Literal["normal"]
    mean: Positive
    """Mean factor before the bounds."""

    sd: Positive
    """Standard deviation before the bounds."""


class LognormalSize(_CutSize):
    """Lognormally distributed factors, drawn again when outside the bounds."""

    kind: Literal["lognormal"]
    mean: Positive
    """Mean factor (not of its logarithm) before the bounds."""

    sd: Positive
    """Standard deviation of the factor (not of its logarithm) before the bounds."""


class PowerSize(_CutSize):
    """Factors whose number density goes as a power of the factor: p(h) ~ h^exponent."""

    kind: Literal["power"]
    exponent: Annotated[float, Field(ge=-1e3, le=1e3)]
    """The power; negative where small bodies abound."""


Size = Annotated[
    ConstantSize | UniformSize | NormalSize | LognormalSize | PowerSize,
    Field(discriminator="kind"),
]

Turn = Annotated[
    Annotated[Literal["random", "aligned"], Tag("word")] | Annotated[Quaternion, Tag("number")],
    Discriminator(lambda value: "word" if isinstance(value, str) else "number"),
]


class Fill(Section):
    """Free bodies generated inside a region; none overlaps another at the start.

    They keep clear of one another and of the bodies given one by one. Bounding spheres do not
    meet, so a fill is looser than a packing: let it settle.
    """

    name: Name
    """By which reports refer to it; its bodies are called name[0], name[1], ..."""

    shapes: Annotated[tuple[Name, ...], Field(min_length=1, strict=False)]
    """Names of the shapes drawn from."""

    weights: Annotated[tuple[Positive, ...], Field(strict=False)] | None = None
    """How often each shape is drawn, relative to the others; default: equally often."""

    group: Name = "default"
    """Group of the bodies."""

    cluster: Annotated[int, Field(ge=0, le=2**31 - 1)] = 0
    """Number of the cluster the bodies are part of."""

    density: Positive | None = None
    """Mass per volume [kg/m^3]; default: that of the group."""

    kind: Literal["lattice", "random"]
    """"lattice": a simple cubic lattice; "random": one after the other at random places."""

    count: Annotated[int, Field(ge=1, le=10_000_000)] | None = None
    """How many bodies at most; default for a lattice: as many as fit."""

    region: Region
    """The bodies lie inside it entirely [m]."""

    size: Size = ConstantSize()
    """Distribution of the homothety factor: each body is so many times its shape's size."""

    orientation: Turn = "random"
    """"random": every orientation equally likely; "aligned": the shape's own axes; or one unit
    quaternion w, x, y, z for all."""

    velocity: Vector = (0.0, 0.0, 0.0)
    """Initial velocity [m/s]."""

    spin: Vector = (0.0, 0.0, 0.0)
    """Initial angular velocity, along the world's axes [rad/s]."""

    spacing: NotNegative = 0.0
    """Clear distance between the bounding spheres of a lattice [m]."""

    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] | None = None
    """Of the random numbers; default: run.seed plus the fill's place in the file."""

    must_fit: bool = False
    """true: fewer bodies than count is an error; false: their number is reported."""
