"""The laws of contact between groups."""

from typing import Annotated, Literal

from pydantic import Field

from warpdem.input.scene_values import Name, NotNegative, Number, Positive, Section

PARAMETERS = 8
"""Numbers a custom law may be given."""


class Contact(Section):
    """The law of contact between two groups, or within one; parameters of each sub-contact."""

    groups: Annotated[tuple[Name, ...], Field(min_length=2, max_length=2, strict=False)]
    """The two groups, in any order; the same twice for contacts within a group."""

    law: Literal["default", "avalanche", "sticked_links", "custom"] = "default"
    """"default": linear spring and dashpot that never pull, Coulomb friction with a spring;
    "sticked_links": the same once the bonds of two bodies are broken (see [[bond]]);
    "avalanche": no dashpot, the spring unloads along en2 kn; "custom": the normal force is a
    function of yours (file, normal)."""

    kn: Positive
    """Normal stiffness [N/m]."""

    kt: NotNegative
    """Tangential stiffness [N/m]; 0 leaves no friction."""

    en2: Annotated[float | None, Field(gt=0, le=1)] = None
    """Energy kept by a rebound, the square of the restitution coefficient [-]; this, or
    damping_ratio."""

    damping_ratio: NotNegative | None = None
    """Damping ratio of the dashpot, 1 is critical [-]; instead of en2."""

    mu: NotNegative
    """Friction coefficient [-]."""

    kr: NotNegative = 0.0
    """Rolling stiffness [N m/rad]; 0: no rolling resistance."""

    mur: NotNegative = 0.0
    """Rolling cap: the moment stays below mur times the normal force [m] (run.rolling_arm); with
    "avalanche", mur times the distance of the contact from the axis the free body turns about."""

    fc: NotNegative = 0.0
    """Attraction while in contact [N]; with dncut it reaches beyond."""

    dncut: Positive | None = None
    """Gap up to which the attraction fc reaches, falling off linearly [m]."""

    gamma: NotNegative = 0.0
    """Work of adhesion [J/m^2]: attraction 2 pi R gamma while touching, 1/R = 1/R_i + 1/R_j of the
    roundings, a face being flat (Derjaguin, Muller & Toporov)."""

    file: Name | None = None
    """Of a "custom" law: Python file with its functions; a relative path starts at the scene's
    folder."""

    normal: Name | None = None
    """Of a "custom" law: name of its @wp.func of the normal force (kernels/custom.py)."""

    parameters: Annotated[tuple[Number, ...], Field(max_length=PARAMETERS, strict=False)] = ()
    """Of a "custom" law: up to eight numbers of yours."""

    @property
    def damped(self) -> bool:
        """Whether the contact has a dashpot."""
        if self.law in {"avalanche", "custom"}:
            return False
        return self.damping_ratio > 0.0 if self.damping_ratio is not None else self.en2 != 1.0

    @property
    def attracts(self) -> bool:
        """Whether bodies in contact hold together."""
        return self.fc > 0.0 or self.gamma > 0.0
