"""Drivers: how fixed bodies are moved, in advance or by a force."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from warpdem.input.scene_values import Name, NotNegative, Number, Positive, Section, Vector


class Axes(Section):
    """A number along some of the world's axes."""

    x: Number | None = None
    """Along or about x."""

    y: Number | None = None
    """Along or about y."""

    z: Number | None = None
    """Along or about z."""

    @property
    def given(self) -> dict[int, float]:
        """Numbers of the axes that have one, by the axis' number."""
        values = enumerate((self.x, self.y, self.z))
        return {axis: value for axis, value in values if value is not None}


class _Driver(Section):
    bodies: Annotated[tuple[Name, ...], Field(min_length=1, strict=False)]
    """Names of the bodies it moves; they have fixed = true. Several drivers of one body add up:
    rotations one after the other, in the order of the file, each about its own point; then the
    sum of all displacements."""

    start: NotNegative = 0.0
    """Before this time it stands still [s]."""

    stop: Positive | None = None
    """From this time on it stands still, where it is [s]; default: never."""


class _Rotating(_Driver):
    point: Vector | None = None
    """A point of the axis of rotation when the driver starts [m]; the axis goes along with the
    driver's own displacement; default: each body's own centre of mass."""


class ConstantDriver(_Rotating):
    """Uniform motion."""

    kind: Literal["constant"]
    velocity: Vector = (0.0, 0.0, 0.0)
    """[m/s]."""

    spin: Vector = (0.0, 0.0, 0.0)
    """Angular velocity, along the world's axes [rad/s]."""


class SineDriver(_Rotating):
    """Shaking, A (sin(2 pi f (t - start) + phase) - sin(phase)), in translation and rotation."""

    kind: Literal["sine"]
    frequency: Positive
    """Periods a second [Hz]."""

    translation: Vector = (0.0, 0.0, 0.0)
    """Amplitude of the displacement [m]."""

    rotation: Vector = (0.0, 0.0, 0.0)
    """Amplitude of the rotation, a vector along its axis [rad]."""

    phase: Number = 0.0
    """At the start [rad]."""

    wave: Literal["sine", "triangle"] = "sine"
    """"triangle": back and forth at constant speed, 4 A f."""


class TableDriver(_Rotating):
    """Motion read from a file, relative to that at the start."""

    kind: Literal["table"]
    file: Name
    """CSV with a header of t [s] and some of x, y, z (displacement [m]), rx, ry, rz (rotation
    vector [rad]); relative to the scene's folder. Before its first and after its last row the
    body stands still."""

    interpolation: Literal["linear", "cubic"] = "linear"
    """"cubic": the spline of continuous acceleration that starts and ends at rest."""


class ExpressionDriver(_Rotating):
    """Motion by functions of the simulated time t, relative to that at the start.

    They know numbers, t, pi, + - * / **, sin cos tan asin acos atan sinh cosh tanh exp log sqrt
    abs, step(x) (1 from x = 0 on), min and max. Velocities are their exact derivatives.
    """

    kind: Literal["expression"]
    x: Name = "0"
    """Displacement along x [m], say "0.01 * sin(2 * pi * 5 * t)"."""

    y: Name = "0"
    """Displacement along y [m]."""

    z: Name = "0"
    """Displacement along z [m]."""

    rx: Name = "0"
    """Rotation vector, x component [rad]."""

    ry: Name = "0"
    """Rotation vector, y component [rad]."""

    rz: Name = "0"
    """Rotation vector, z component [rad]."""


Ramp = Annotated[
    tuple[Annotated[tuple[Number, ...], Field(min_length=2, max_length=2, strict=False)], ...],
    Field(min_length=1, strict=False),
]


class _Forced(_Driver):
    mass: Positive | None = None
    """Mass that the force accelerates [kg]; default: density times volume."""

    damping: NotNegative = 0.0
    """Viscous damping of the motion along the axes that follow a force [N s/m]."""

    ramp: Ramp | None = None
    """Factors in time, [[t, factor], ...] with straight lines between: what is imposed is
    multiplied by it. With a force of 1 it is the table of the force itself."""


class ControlDriver(_Forced):
    """A wall that follows imposed and contact forces along some of the world's axes.

    m dv/dt = F + contact force - damping v along each axis of ``force``, I dw/dt likewise about
    each axis of ``moment``. Outside of start and stop it is held.
    """

    kind: Literal["control"]
    force: Axes = Axes()
    """Imposed force [N] along the axes that follow it, say { z = -500.0 }."""

    moment: Axes = Axes()
    """Imposed moment [N m] about the axes, through the centre of mass, that follow it."""

    velocity: Axes = Axes()
    """Imposed velocity along other axes [m/s]."""

    inertia: Axes = Axes()
    """Moments of inertia about the axes of ``moment`` [kg m^2], kept throughout; default: the
    shape's about these axes, as it stands at the start."""

    spin_damping: NotNegative = 0.0
    """Viscous damping of the rotation about the axes of ``moment`` [N m s]."""

    gravity: bool = False
    """true: gravity acts on it, along the axes of ``force``."""


class PressureDriver(_Forced):
    """A wall that presses: its force is the pressure times an area."""

    kind: Literal["pressure"]
    pressure: Positive
    """[Pa]."""

    axis: Literal["x", "y", "z"]
    """Along which it moves."""

    sign: Literal[1, -1]
    """Direction in which it pushes along the axis."""

    area: Positive | None = None
    """Constant area [m^2]; or give ``between``."""

    between: (
        Annotated[
            tuple[
                Annotated[tuple[Name, ...], Field(min_length=2, max_length=2, strict=False)], ...
            ],
            Field(min_length=2, max_length=2, strict=False),
        ]
        | None
    ) = None
    """Two pairs of opposite walls, [["west", "east"], ["south", "north"]]: the area is the product
    of the clear widths between them, as they stand at each step."""

    @model_validator(mode="after")
    def _one_area(self) -> Self:
        if (self.area is None) == (self.between is None):
            raise ValueError("needs one of area and between: what the pressure acts on")
        return self


Driver = Annotated[
    ConstantDriver | SineDriver | TableDriver | ExpressionDriver | ControlDriver | PressureDriver,
    Field(discriminator="kind"),
]
