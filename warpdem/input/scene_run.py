"""How a scene is run: the clock, the device and the numerics."""

from typing import Annotated, Literal

from pydantic import AfterValidator, Discriminator, Field, Tag

from warpdem.input.scene_guards import EnergyGuard, Relax
from warpdem.input.scene_values import NotNegative, Positive, Section


def _device(name: str) -> str:
    index = name.removeprefix("cuda:")
    if name in {"auto", "cpu", "cuda"} or (index != name and index.isdecimal()):
        return name
    raise ValueError('must be "auto", "cpu", "cuda" or "cuda:N"')


AutoOrPositive = Annotated[
    Annotated[Literal["auto"], Tag("word")] | Annotated[Positive, Tag("number")],
    Discriminator(lambda value: "word" if isinstance(value, str) else "number"),
]


class Numerics(Section):
    """How the equations are stepped; the defaults are the accurate ones."""

    contact_update: Literal["predicted", "lagged"] = "predicted"
    """Velocity a dashpot sees: "predicted", that of the step's end (second order); "lagged", that
    of the half step (first order)."""

    rotation: Literal["auto", "no_squish", "rkmk4", "taylor", "euler"] = "auto"
    """Drift of orientations: "no_squish", symplectic, second order; "rkmk4", fourth order where
    nothing turns the body; "taylor" and "euler", Rockable's and exaDEM's, for comparison. "auto":
    "rkmk4" where no contact and no bond may turn a body, else "no_squish"."""

    damping: Literal["pair", "contact"] = "pair"
    """What the restitution en2 holds for: "pair", a whole pair of bodies however many sub-contacts
    it has; "contact", one sub-contact between centres."""

    restitution: Literal["clamped", "bilateral"] = "clamped"
    """How en2 becomes a damping ratio: "clamped", right for contacts that never pull;
    "bilateral", the formula of a contact that pulls, which rebounds more than asked."""

    friction_cap: Literal["total", "elastic"] = "total"
    """What mu multiplies: "total", the normal force; "elastic", its elastic part kn |gap|."""

    friction_frame: Literal["objective", "fixed"] = "objective"
    """Whether the tangential force follows the contact as it turns: "objective", with the normal
    and the spin about it; "fixed", it keeps its direction in space."""

    opening: Literal["cancel", "keep"] = "cancel"
    """What becomes of the tangential force when a contact opens: "cancel" or "keep" it."""

    moving_shares: Literal["passive", "plain"] = "passive"
    """What friction does when run.partnership gives a sub-contact another share: "passive", it
    never gains energy; "plain", its stiffness follows at once."""

    first_step: Literal["contacts", "gravity", "forces"] = "contacts"
    """What acts in the very first half kick: "contacts", all; "gravity", gravity and bonds alone;
    "forces", all but torques."""

    rolling_arm: Literal["length", "branch"] = "length"
    """Arm of the rolling cap: "length", mur is a length [m]; "branch", mur is a number that
    multiplies the distance of the two centres of mass, or of the only free one from the contact."""


ROCKABLE = Numerics(
    contact_update="lagged",
    rotation="taylor",
    damping="contact",
    restitution="bilateral",
    friction_cap="elastic",
    friction_frame="fixed",
    opening="keep",
    moving_shares="plain",
    first_step="gravity",
)
"""The numerics of Rockable's program."""


EXADEM = Numerics(
    contact_update="lagged",
    rotation="euler",
    damping="contact",
    restitution="bilateral",
    friction_cap="elastic",
    friction_frame="fixed",
    moving_shares="plain",
    first_step="forces",
)
"""The numerics of exaDEM's kernels."""

PROGRAMS = {"rockable": ROCKABLE, "exadem": EXADEM}
"""The numerics that ``compat`` sets, by its value."""


class Sleep(Section):
    """Bodies at rest stand still until the forces of their contacts change, and cost little.

    Neglected: creep below ``speed``, and what accelerates by less than 2 ``speed`` / ``after``;
    changes of forces, so waves too, below ``tolerance``, to which a sleeper is as a fixed body; the
    kinetic energy of what falls asleep (energy.csv counts it with the dashpots). A body falls
    asleep when it and all that it touches are at rest.
    """

    speed: Positive
    """Speed of its farthest point below which a body is at rest [m/s]."""

    after: Positive
    """For how long it is at rest before it falls asleep [s]."""

    tolerance: Annotated[float, Field(gt=0, lt=1)] = 0.01
    """Change of the force of its contacts at which it wakes, over its weight or, if that is more,
    the largest of these forces when it fell asleep; of their torque likewise, times its bounding
    radius [-]."""


class Run(Numerics):
    """What is simulated for how long, and by which method."""

    duration: Positive
    """Simulated time [s]."""

    dt: AutoOrPositive = "auto"
    """Time step [s]; "auto": a twentieth of the shortest contact and half of the stability bound,
    then reduced to divide output.every. Of "nonsmooth" the largest step; "auto": 5e-3."""

    adaptive_dt: bool = False
    """The step changes, by powers of two times dt, as bodies come and go: longer while nothing can
    touch, or only what is larger or softer than dt is chosen for; shorter where contacts or speeds
    ask for it. Frames come at the nearest step."""

    method: Literal["smooth", "nonsmooth"] = "smooth"
    """"smooth": deformable contacts, resolved in time; "nonsmooth": rockfall, each rock alone on
    hard ground, with impulses."""

    device: Annotated[str, AfterValidator(_device)] = "auto"
    """"auto" (a CUDA device if there is one), "cpu", "cuda" or "cuda:N"."""

    precision: Literal["float64", "mixed"] = "float64"
    """"mixed": shapes relative to a pair of bodies, and forces, in single precision; positions,
    momenta, friction and energies in double. Gaps are then off by some 1e-7 of the distance of two
    centres. Rockfall is in double precision throughout."""

    arithmetic: Literal["separate", "fused"] = "separate"
    """"fused": a product and a sum are rounded once, where the machine can; a fifth faster, and as
    repeatable. "separate": each is rounded, so what a scene does not use changes no bit: the same
    blocks move the same way with the account of energies as without. The step of the smooth method
    alone."""

    seed: Annotated[int, Field(ge=0, le=2**32 - 1)] = 0
    """Of all random numbers."""

    skin: AutoOrPositive = "auto"
    """Distance within which feature pairs are listed as candidates [m]; changes the speed, never
    the result."""

    compat: Literal["none", "rockable", "exadem"] = "none"
    """"rockable", "exadem": the numerics of these programs, to compare with them."""

    partnership: Literal["auto", "once", "sum", "pnorm", "number", "overlap"] = "auto"
    """What counts as a sub-contact of two bodies, and how they share stiffness: "once", a vertex
    with the nearest feature of the other body alone, two edges by what they overlap more than their
    ends, so that the energy of solids in contact is continuous; the others with all features in
    reach: "sum", each has all the stiffness; "pnorm", (d/g)^(p-2) of it, g = (sum d^p)^(1/p), d
    the overlaps; "number", one nth; "overlap", d/sum d: these two, Rockable's, do not conserve
    energy. "auto": "once"; with bonds, compat, or laws other than springs and dashpots "sum"."""

    partnership_exponent: Annotated[float, Field(ge=2, le=16)] = 4.0
    """p of "pnorm" [-]; 2 is "sum"."""

    cohesion: Literal["exadem", "documented"] = "exadem"
    """How attraction at a distance (contact.dncut) goes on in contact: "exadem", fc is taken off
    the repulsion, without a jump; "documented", the force is held at -fc up to an overlap of dncut
    and may pull without bound beyond, with a jump at touch."""

    overlap: Literal["stop", "note"] = "stop"
    """What becomes of a run in which two bodies overlap so far that they would come out on the
    other side (.75 of the way to the middle of the thinner, roundings included): "stop" with their
    names; "note" and go on. At the start it is an error from .5 of the way on, unless [run.relax]
    pushes them apart."""

    stride: NotNegative = 0.03
    """Of "nonsmooth": longest way of any point of a rock in a step, over its bounding radius [-];
    0: all steps have run.dt."""

    tolerance: Annotated[float, Field(gt=0, le=1e-2)] = 1e-4
    """Of "nonsmooth": change of contact velocities, relative to the largest, at which the solution
    of a step is good enough [-]."""

    gyroscope: Literal["midpoint", "leine"] = "midpoint"
    """Of "nonsmooth": how free spin is stepped: "midpoint", second order; "leine", as published,
    first order."""

    skip: Literal["jump", "sphere", "none"] = "jump"
    """Of "nonsmooth": work left out in the air: "jump", whole stretches of flight in one step, and
    the vertices while the bounding sphere is clear of the ground; "sphere", the latter; "none"."""

    lift: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Of "nonsmooth": share of the depth beyond 1 mm by which a step lifts a rock [-]; 0: never."""

    sleep: Sleep | None = None
    """[run.sleep]: bodies at rest may sleep; default: none does."""

    relax: Relax | None = None
    """[run.relax]: bodies that overlap are pushed apart before the run; default: they are not."""

    energy_guard: EnergyGuard | None = None
    """[run.energy_guard]: energy that grows is told; default: nobody looks."""

    list_distance: Positive | None = None
    """Rockable's dVerlet [m]: features farther apart are unseen until lists are renewed; only with
    compat."""

    def resolved(self) -> Numerics:
        """The numerics in force, after ``compat``."""
        if self.compat != "none":
            return PROGRAMS[self.compat]
        return Numerics.model_validate({key: getattr(self, key) for key in Numerics.model_fields})
