"""Breakable bonds between bodies: where they are made, how they bear load, when they break."""

from typing import Annotated, Literal

from pydantic import Field

from warpdem.input.scene_values import Name, NotNegative, Positive, Section


class Weibull(Section):
    """Spread of strengths: one random factor of mean 1 for each interface."""

    modulus: Annotated[float, Field(ge=0.5, le=1e3)]
    """Shape parameter; the larger, the narrower the spread."""


class Bond(Section):
    """Elastic bonds that glue bodies together until they break.

    All bonds of two bodies form one interface; when one of them yields the interface breaks, and
    the two bodies are in ordinary contact from then on. A pair of bodies takes its bonds from one
    [[bond]] only. A bond yields where (|ft|/ft0)^power + (|M|/m0)^power - fn/fn0 > 1.

    Bodies are bonded as they lie at the start: in a periodic cell not across its boundary, with
    an image of one another. Planes, cylinders and balls given by a formula have no features to
    bond to.
    """

    name: str = ""
    """By which messages refer to it; default: bond[i]."""

    groups: Annotated[tuple[Name, ...], Field(min_length=2, max_length=2, strict=False)] | None = (
        None
    )
    """The groups of the two bodies, in any order; default: any."""

    between: Literal["inner", "outer"]
    """"inner": bodies of the same cluster; "outer": bodies of different clusters."""

    rule: Literal["vertices", "clusters", "faces"]
    """Which places are bonded. "vertices": every two vertices closer than their roundings and the
    tolerance; "clusters": one bond for two bodies, at the one of their sub-contacts that is closest
    to the mean of all; "faces": the corners of the overlap of two opposite faces."""

    tolerance: Positive
    """Largest gap that is bonded [m]."""

    angle: Annotated[float, Field(gt=0, le=0.5)] = 0.01
    """With rule = "faces": largest angle between the two planes [rad]."""

    walls: bool = False
    """true: free bodies are bonded to fixed ones too."""

    kn: Positive
    """Normal stiffness of each bond [N/m]."""

    kt: NotNegative
    """Tangential stiffness of each bond [N/m]."""

    kr: NotNegative = 0.0
    """Stiffness of each bond against bending and twisting [N m/rad]."""

    en2: Annotated[float, Field(gt=0, le=1)] = 1.0
    """Energy kept by one rebound of the bonded pair, damped along its bonds [-]; 1: no dashpots."""

    damping_ratio: NotNegative | None = None
    """Damping ratio of the bonded pair [-], instead of en2."""

    fn0: Positive | None = None
    """Tensile strength of each bond [N]; default: tension does not break it."""

    ft0: Positive | None = None
    """Shear strength of each bond [N]; default: shear does not break it."""

    m0: Positive | None = None
    """Strength of each bond against bending [N m]; default: bending does not break it."""

    power: Positive = 2.0
    """Exponent of shear and bending in the yield surface [-]."""

    gc: Positive | None = None
    """Fracture energy [J/m^2]: an interface breaks when its elastic energy exceeds 2 A gc, A its
    area; compressed bonds count with their shear alone."""

    gc_normal: Positive | None = None
    """The same for the energy of stretching alone [J/m^2]."""

    gc_tangential: Positive | None = None
    """The same for the energy of shear alone [J/m^2]."""

    share: bool = False
    """true: kn and kt are the interface's and divided among its bonds."""

    weibull: Weibull | None = None
    """Spread of the strengths (and fracture energies) from one interface to the next."""
