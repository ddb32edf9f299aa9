"""Forces on single bodies besides gravity, as a scene writes them."""

from typing import Annotated, Literal

from pydantic import Field

from warpdem.input.scene_values import Name, Positive, Section

Groups = Annotated[tuple[Name, ...], Field(min_length=1, strict=False)]
Fraction = Annotated[float, Field(gt=0, lt=1)]

VISCOSITY = 1.5e-5
DRAG = 0.38


class Drag(Section):
    """Quadratic drag of a medium at rest, F = -viscosity cx |v| v; several drags add up."""

    kind: Literal["drag"]
    viscosity: Positive = VISCOSITY
    """Of the medium; with cx = 1 the coefficient itself [kg/m]."""

    cx: Positive = DRAG
    """Drag coefficient [-]."""

    coefficient: Positive | None = None
    """The product of both, instead of them [kg/m]."""

    groups: Groups | None = None
    """Groups of the bodies it acts on; default: all."""

    @property
    def product(self) -> float:
        """What multiplies |v| v [kg/m]."""
        return self.coefficient or self.viscosity * self.cx


class Fluid(Section):
    """Friction against a fluid that flows steadily, F = cx pi r^2 |u - v| (u - v).

    u is the fluid's velocity at the body's centre of mass, r the radius of the ball of the body's
    volume. Outside the grid the nearest value on its border holds.
    """

    kind: Literal["fluid"]
    file: Name
    """Grid of velocities [m/s]; a relative path starts at the scene's folder. VTK image data
    (.vti), with vectors at its points or its cells; or .npz with velocity, shape [nx, ny, nz, 3],
    origin (the first node) and spacing [m], shape [3] each."""

    array: Name | None = None
    """Which vectors of a .vti; default: the only ones."""

    interpolation: Literal["trilinear", "nearest"] = "trilinear"
    """Between nodes: "trilinear"; "nearest", the value of the nearest node, of the cell the body is
    in where a .vti has its vectors at the cells."""

    cx: Positive = DRAG
    """Friction coefficient, the fluid's density included [kg/m^3]."""

    groups: Groups | None = None
    """Groups of the bodies it acts on; default: all."""


class NumericalDamping(Section):
    """Cundall's damping of all free bodies, against oscillations on the way to a balance.

    Force and moment of contacts, drag and fluid (not the weight) are multiplied by 1 - coefficient
    while they do work, and by 1 + coefficient while they take it. So contacts at rest carry between
    1/(1 + coefficient) and 1/(1 - coefficient) of the weight.
    """

    kind: Literal["numerical_damping"]
    coefficient: Fraction
    """Part by which forces change [-]; Rockable's numericalDampingCoeff."""


class VelocityBarrier(Section):
    """Holds all free bodies back that become too fast.

    Each component of the acceleration is multiplied by (1 - r)/(1 + r), r = |v/velocity|^exponent
    for that component of the velocity, and likewise of the angular one.
    """

    kind: Literal["velocity_barrier"]
    velocity: Positive | None = None
    """Velocity at which no component grows further [m/s]; Rockable's VelocityBarrier."""

    velocity_exponent: Positive = 1.0
    """How sharp the barrier is [-]; Rockable's VelocityBarrierExponent."""

    spin: Positive | None = None
    """Angular velocity at which no component grows further [rad/s]."""

    spin_exponent: Positive = 1.0
    """How sharp that barrier is [-]."""


Force = Annotated[
    Drag | Fluid | NumericalDamping | VelocityBarrier,
    Field(discriminator="kind"),
]
