"""The time step: what the stiffest contacts allow, and what a scene asks for."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, hypot, inf, pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from warpdem.bonds.stiffness import stiffest
from warpdem.checks.restitution import damping_ratio
from warpdem.driving.plan import plan_of
from warpdem.driving.rates import period_limit
from warpdem.errors import Problem, SceneError
from warpdem.input.decode import problem_at
from warpdem.input.scene_references import meeting_groups

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.bonds.creation import Interfaces
    from warpdem.driving.plan import Plan
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.input.scene_contact import Contact

STEPS_IN_CONTACT = 20
"""Steps of the shortest contact under ``dt = "auto"``: restitution right to 1e-3 or better."""

SHARE_OF_BOUND = 0.5
"""Part of the stability bound under ``dt = "auto"``: room for contacts not foreseen."""

LARGEST_TURN = 0.1
"""Largest turn in one step under ``dt = "auto"`` [rad], but for bodies with a ball's inertia."""

LARGEST_ADVANCE = 0.25
"""Largest advance in one step under ``dt = "auto"``, in bounding radii."""

LEAST_LOADED = 8
"""Vertices of a body loaded at once, at least (if it has as many)."""


@dataclass(frozen=True)
class TimeStep:
    """The step of a run.

    Attributes:
        dt: Time step [s].
        bound: Stability bound of the densest contacts foreseen [s]; infinite without contacts.
        contact_time: Duration of the shortest contact [s]; infinite without contacts.
        chosen: ``dt`` was chosen here rather than given by the scene.
        message: A warning, or nothing.
    """

    dt: float
    bound: float
    contact_time: float
    chosen: bool
    message: str


def contact_time(stiffness: float, mass: float) -> float:
    """Duration of a contact between centres, without damping [s].

    Args:
        stiffness: kn [N/m].
        mass: Effective mass of the pair [kg].
    """
    return pi * sqrt(mass / stiffness)


def single_contact_limit(stiffness: float, mass: float) -> float:
    """Largest stable step of one undamped contact between centres [s].

    Args:
        stiffness: kn [N/m].
        mass: Effective mass of the pair [kg].
    """
    return 2.0 * sqrt(mass / stiffness)


def block_bound(
    mass: float,
    inertia: FloatArray,
    arms: FloatArray,
    normals: FloatArray,
    stiffness: tuple[float, float, float],
) -> float:
    """Upper bound of the square of the highest frequency a body takes part in [1/s^2].

    The largest eigenvalue of M^-1 sum K over the contacts, each weighed as between two bodies
    that move (twice): a bound of the whole assembly's highest eigenvalue. dt < 2/sqrt of it is
    stable.

    Args:
        mass: Of the body [kg].
        inertia: Principal moments [kg m^2], shape [3].
        arms: Contact points about the centre of mass, principal frame [m],
            shape [contact_count, 3].
        normals: Unit normals, principal frame, shape [contact_count, 3].
        stiffness: kn, kt [N/m] and kr [N m/rad] of each contact.
    """
    kn, kt, kr = stiffness
    scale = np.sqrt(1.0 / np.array([mass, mass, mass, *inertia]))
    tangent = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    block = kn * normals[:, :, None] * normals[:, None, :] + kt * tangent
    # The velocity of the contact point is v - arm x spin.
    x, y, z = arms.T
    zero = np.zeros_like(x)
    turn = -np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
    motion = np.concatenate([np.broadcast_to(np.eye(3), turn.shape), turn], axis=2)
    total = np.einsum("cki,ckl,clj->ij", motion, block, motion)
    total[3:, 3:] += kr * len(arms) * np.eye(3)
    return float(np.linalg.eigvalsh(2.0 * scale[:, None] * total * scale)[-1])


def automatic_step(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    interfaces: Interfaces | None = None,
) -> TimeStep:
    """The time step of a placed scene.

    Before the first step nothing touches, so contacts are assumed (see `loaded_points`). With
    ``dt = "auto"`` the step is the least of a twentieth of the shortest contact, half of the
    stability bound (contacts and bonds together), a tenth of a radian at the fastest initial spin
    (but for balls) and a quarter of a bounding radius at the initial velocity, or where nothing can
    touch at the velocity of a fall for the whole run, and what resolves the motion of the drivers
    (a hundredth of a period); then it is reduced to divide the time between frames.

    Raises:
        SceneError: The given step is unstable for a single contact, or bodies have masses beyond
            the range of numbers.
    """
    _refuse_impossible_masses(scene, placement, polyhedra)
    plan = plan_of(scene, placement, polyhedra)
    stiff = [kn / mass for kn, mass in _pairs(scene, placement, polyhedra, plan)]
    shortest = contact_time(max(stiff), 1.0) if stiff else inf
    bound = _bound(scene, placement, polyhedra)
    if interfaces is not None:
        movable = movable_masses(placement, polyhedra, plan)
        square, frequency = stiffest(interfaces, placement, *movable)
        bound = 1.0 / sqrt(1.0 / bound**2 + 0.25 * square)
        shortest = min(shortest, pi / frequency)
    if scene.run.dt == "auto":
        fall = 0.0 if stiff else float(np.linalg.norm(scene.gravity.vector)) * scene.run.duration
        limits = [shortest / STEPS_IN_CONTACT, SHARE_OF_BOUND * bound, scene.frame_interval]
        limits.append(_motion_limit(placement, polyhedra, fall))
        limits.append(period_limit(plan, scene.run.duration))
        dt = _dividing(min(limits), scene.frame_interval)
        return TimeStep(dt, bound, shortest, chosen=True, message="")
    dt = scene.run.dt
    if stiff and dt >= single_contact_limit(max(stiff), 1.0):
        limit = single_contact_limit(max(stiff), 1.0)
        rule = f"unstable: even a single contact of the stiffest pair needs less than {limit:.4g} s"
        problem = problem_at(scene, ("run", "dt"), f'{rule}; "auto" chooses a good step', dt)
        raise SceneError(str(scene.source or "scene"), [problem])
    message = (
        ""
        if dt <= bound
        else (
            f"dt = {dt:.4g} s is above the stability bound {bound:.4g} s of a body in contact all "
            f"around: dense packings may blow up"
        )
    )
    return TimeStep(dt, bound, shortest, chosen=False, message=message)


def loaded_points(shape: Polyhedron) -> tuple[FloatArray, FloatArray, float]:
    """Where a body is assumed to be touched, before any contact is known.

    A ball carries a contact on each side of each axis. Other shapes carry two sub-contacts on
    every vertex, along the line from the centre of mass: a cube is pressed by 16. Shapes with many
    vertices are not loaded on all of them at once: the load is spread evenly over them and amounts
    to that of as many vertices as two of the largest faces have, at least eight.

    Returns:
        Arms about the centre of mass [m], shape [contact_count, 3]; unit normals, shape
        [contact_count, 3]; and what to multiply the stiffness of each by.
    """
    if len(shape.vertices) == 1:
        normals = np.concatenate([np.eye(3), -np.eye(3)])
        return normals * shape.radius, normals, 1.0
    lengths = np.linalg.norm(shape.vertices, axis=1)
    directions = shape.vertices / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    corners = np.diff(shape.side_start)
    loaded = max(LEAST_LOADED, 2 * int(corners.max(initial=0)))
    share = min(1.0, loaded / len(lengths))
    return shape.vertices + shape.radius * directions, directions, 2.0 * share


def masses(
    placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> tuple[FloatArray, FloatArray]:
    """Masses [kg], shape [body_count], and principal moments [kg m^2], shape [body_count, 3].

    Those of fixed bodies are infinite.
    """
    shapes = list(polyhedra.values())
    volume = np.array([shape.volume for shape in shapes])[placement.shape]
    over_mass = np.array([shape.inertia_over_mass for shape in shapes]).reshape(-1, 3)
    free = ~placement.fixed
    mass = np.full(len(free), inf)
    mass[free] = (volume * placement.scale**3 * placement.density)[free]
    moments = np.full((len(free), 3), inf)
    moments[free] = (over_mass[placement.shape] * placement.scale[:, None] ** 2)[free] * mass[
        free, None
    ]
    return mass, moments


def movable_masses(
    placement: Placement, polyhedra: Mapping[str, Polyhedron], plan: Plan
) -> tuple[FloatArray, FloatArray]:
    """As ``masses``, with their own for walls that follow a force, along their loosest axis."""
    mass, moments = masses(placement, polyhedra)
    with np.errstate(divide="ignore"):
        mass[plan.bodies] = 1.0 / plan.walls.inverse_mass.max(axis=1, initial=0.0)
        turning = 1.0 / plan.walls.inverse_inertia.max(axis=1, initial=0.0)
    moments[plan.bodies] = turning[:, None]
    return mass, moments


def _refuse_impossible_masses(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> None:
    inertia = np.column_stack(masses(placement, polyhedra))[~placement.fixed]
    # Products of two of these and their inverses must stay within the range of numbers.
    wrong = ~np.all((inertia > 1e-150) & (inertia < 1e150), axis=1)
    if wrong.any():
        file = str(scene.source or "scene")
        body = np.flatnonzero(~placement.fixed)[wrong][0]
        name, mass = placement.names[body], inertia[wrong][0]
        rule = f'"{name}" has the mass {mass[0]:g} kg and the moments {mass[1:]} kg m^2'
        way = "look at the unit of its size and density"
        raise SceneError(file, [Problem(file, "", f"{rule}: {way}")])


def _laws(scene: Scene, placement: Placement) -> dict[tuple[str, str], Contact]:
    """Laws between groups of which bodies can meet, each once."""
    table = scene.contact_table(placement.groups)
    return {pair: table[pair] for pair in meeting_groups(scene) if pair in table}


def _pairs(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron], plan: Plan
) -> Iterator[tuple[float, float]]:
    """Stiffness [N/m] and least effective mass [kg] of each two groups that can meet."""
    mass = movable_masses(placement, polyhedra, plan)[0]
    lightest = {
        name: [*np.sort(mass[placement.group == index])[:2], inf, inf][:2]
        for index, name in enumerate(placement.groups)
    }
    for (a, b), law in _laws(scene, placement).items():
        first = lightest[a][0]
        second = lightest[b][a == b]
        if min(first, second) < inf:
            yield law.kn, float(1.0 / (1.0 / first + 1.0 / second))


def _kinds(placement: Placement) -> tuple[IntArray, IntArray]:
    """The smallest free body of each shape, group and density, and of which kind each free one is.

    Smaller bodies bound the step.
    """
    density = placement.density
    free = np.flatnonzero(~placement.fixed)
    order = free[
        np.lexsort(
            [key[free] for key in (placement.scale, density, placement.group, placement.shape)]
        )
    ]
    keys = np.stack([placement.shape[order], placement.group[order], density[order]], axis=1)
    first = np.ones(len(order), dtype=bool)
    first[1:] = np.any(keys[1:] != keys[:-1], axis=1)
    kind = np.empty(len(placement.fixed), dtype=np.int64)
    kind[order] = np.cumsum(first) - 1
    return order[first], kind[free]


def foreseen(scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> FloatArray:
    """Largest stable step of each body in the densest contacts foreseen [s], shape [body_count].

    Infinite for fixed bodies, and for those that nothing can touch.
    """
    mass, moments = masses(placement, polyhedra)
    shapes = list(polyhedra.values())
    laws = _laws(scene, placement)
    smallest, kind = _kinds(placement)
    squares = np.zeros(len(smallest))
    for number, body in enumerate(smallest):
        group = placement.groups[placement.group[body]]
        own = [law for pair, law in laws.items() if group in pair]
        arms, normals, share = loaded_points(shapes[placement.shape[body]])
        stiffness = [max((getattr(law, k) for law in own), default=0.0) for k in ("kn", "kt", "kr")]
        kn, kt, kr = (share * k for k in stiffness)
        kn *= _steepening(scene)
        arms = arms * placement.scale[body]
        squares[number] = block_bound(float(mass[body]), moments[body], arms, normals, (kn, kt, kr))
    free = ~placement.fixed
    steps = np.full(len(free), inf)
    with np.errstate(divide="ignore"):
        of_smallest = 2.0 / np.sqrt(squares) * _damped_share(scene, laws)
        steps[free] = of_smallest[kind] * np.sqrt(mass[free] / mass[smallest][kind])
    return steps


def _bound(scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> float:
    """Stability bound of the densest contacts foreseen [s]."""
    return float(foreseen(scene, placement, polyhedra).min(initial=inf))


def _steepening(scene: Scene) -> float:
    """Slope of one of two equal sub-contacts, in kn, when the other stays as it is."""
    p = scene.run.partnership_exponent
    if scene.partnership != "pnorm":
        return 1.0
    return max(1.0, (p - 1.0) * 2.0 ** (2.0 / p - 1.0))


def _damped_share(scene: Scene, laws: Mapping[tuple[str, str], Contact]) -> float:
    """What damping leaves of the bound when dashpots see the velocity of the half step."""
    how = scene.run.resolved()
    if how.contact_update == "predicted" or not laws:
        return 1.0
    zeta = max(damping_ratio(law, how) for law in laws.values())
    return hypot(1.0, zeta) - zeta


def _motion_limit(placement: Placement, polyhedra: Mapping[str, Polyhedron], fall: float) -> float:
    """Longest step in which no free body turns or advances much [s].

    They have their initial spins and their initial velocities, or ``fall`` more [m/s].
    """
    shapes = list(polyhedra.values())
    spherical = [np.ptp(s.inertia_over_mass) <= 1e-9 * s.inertia_over_mass[0] for s in shapes]
    ball = np.array(spherical, dtype=bool)
    bound = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    free = ~placement.fixed
    turning = np.linalg.norm(placement.spin, axis=1)[free & ~ball[placement.shape]]
    advance = ((np.linalg.norm(placement.velocity, axis=1) + fall) / bound)[free]
    rate = max(
        turning.max(initial=0.0) / LARGEST_TURN,
        advance.max(initial=0.0) / LARGEST_ADVANCE,
    )
    return 1.0 / rate if rate > 0.0 else inf


def _dividing(dt: float, interval: float) -> float:
    """The largest step up to ``dt`` of which a whole number makes the interval."""
    # An interval that is a multiple but for rounding is not one step short.
    return interval / ceil(interval / dt * (1.0 - 1e-12))
