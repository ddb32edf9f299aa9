"""The stages of a step: which kernel, over what, with which arguments. Nothing else."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from warpdem.features import KICKED
from warpdem.kernels.advance import Motion
from warpdem.kernels.advance import advance as advance_kernel
from warpdem.kernels.bonds import BondLaws, bond_forces
from warpdem.kernels.cell import drift_cell, kick_cell, sum_stress
from warpdem.kernels.driving import measure_areas
from warpdem.kernels.external import Forces
from warpdem.kernels.forces import pair_forces
from warpdem.kernels.integrate import halt as halt_kernel
from warpdem.kernels.laws import Laws
from warpdem.kernels.meeting import meet as meet_kernel
from warpdem.kernels.precision import wide3
from warpdem.kernels.refresh import refresh
from warpdem.kernels.rotation import (
    euler_drift,
    free_drift,
    free_torque,
    rkmk4_drift,
    spherical_drift,
    taylor_drift,
    taylor_torque,
)
from warpdem.kernels.sphere_forces import sphere_forces
from warpdem.kernels.views import Bonds, Joints
from warpdem.materials import load_custom_law

if TYPE_CHECKING:
    import warp as wp

    from warpdem.features import Features
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State


DRIFTS = {
    "no_squish": free_drift,
    "rkmk4": rkmk4_drift,
    "taylor": taylor_drift,
    "euler": euler_drift,
}
"""Drift of orientations, by run.rotation."""
# what may touch within so many steps is hot, or within such a part of the first skin
AHEAD, MARGIN = 10, 0.01


@dataclass(frozen=True)
class Stage:
    """One kernel over a share of all bodies or pairs.

    Attributes:
        name: What a profile calls it.
        kernel: The kernel.
        over: What a thread of it owns.
        arguments: In the kernel's order.
    """

    name: str
    kernel: wp.Kernel
    over: Literal["bodies", "pairs", "interfaces", "gauges", "chunks", "one"]
    arguments: tuple[Any, ...]


def halt(share: Share) -> Stage:
    """Count the step; stop where a body left its skin."""
    return Stage("halt", halt_kernel, "one", (share.clock,))


def forces(model: Model, state: State, lists: Lists, share: Share, dt: float) -> Stage:
    """Contact wrench of each pair."""
    has = model.features
    inputs = (
        model.geometry,
        model.inertia,
        model.materials,
        dt,
        max(model.keep_within, model.reach, model.skin if has.sticky else 0.0),
        share.pairs,
        state.bodies,
        share.clock,
        state.cell,
    )
    if has.single:
        outputs = (lists.pairs, lists.candidates, lists.incidence, state.account)
        return Stage("pair forces", sphere_forces(laws(has)), "bodies", (*inputs, *outputs))
    outputs = (state.drives, lists.pairs, lists.candidates, state.account)
    return Stage("pair forces", pair_forces(laws(has)), "pairs", (*inputs, *outputs))


def bonds(model: Model, state: State, share: Share, dt: float) -> tuple[Stage, ...]:
    """Wrench of each interface, where there are bonds."""
    if not state.bonding:
        return ()
    has = model.features
    laws = BondLaws(
        polyhedra=has.polyhedra,
        convex=has.convex,
        two_sided=has.two_sided,
        predicted=has.predicted,
        objective=has.objective,
        damping=has.bond_damping,
        moments=has.bond_moments,
        creep=has.bond_creep,
    )
    arguments = (
        model.geometry,
        dt,
        share.interfaces,
        state.bodies,
        share.clock,
        state.bonding.bonds,
    )
    return (Stage("bond forces", bond_forces(laws), "interfaces", arguments),)


def advance(
    model: Model,
    state: State,
    lists: Lists,
    share: Share,
    dt: float,
    *,
    kicks: bool,
    drifts: bool,
    contacts: bool | None = None,
) -> Stage:
    """Gather the wrenches and end a step, where it kicks; begin the next one, where it drifts.

    ``contacts`` False: those of this instant do not act.
    """
    has = model.features
    chosen = {name: getattr(has, name) for name in Motion._fields if hasattr(has, name)}
    motion = Motion(
        **chosen | {"contacts": has.contacts if contacts is None else contacts},
        paths=has.hot_lists,
        summed=has.single,
    )
    torque = free_torque if has.rotation in KICKED else taylor_torque
    kernel = advance_kernel(_rotate(has), torque, forces_on_bodies(has), motion)
    glue, joined = Bonds(), Joints()
    if state.bonding:
        glue, joined = state.bonding.bonds, state.bonding.joined
    arguments = (
        model.geometry,
        model.inertia,
        wide3(*model.gravity),
        model.external,
        model.lever,
        dt,
        int(kicks),
        int(drifts),
        share.bodies,
        lists.pairs,
        lists.incidence,
        glue,
        joined,
        state.cell,
        state.drives,
        state.bodies,
        share.clock,
        state.account,
    )
    name = "gather, kick and drift" if kicks and drifts else "kick" if kicks else "drift"
    return Stage(name, kernel, "bodies", arguments)


def hot_lists(model: Model, state: State, lists: Lists, share: Share, dt: float) -> Stage:
    """Renew the hot lists of pairs that have moved."""
    has = model.features
    arguments = (
        model.geometry,
        model.reach,
        MARGIN * model.skin,
        AHEAD * dt,
        share.pairs,
        state.bodies,
        share.clock,
        state.cell,
        lists.pairs,
        lists.candidates,
    )
    kernel = refresh(surfaces=has.surfaces, periodic=has.periodic)
    return Stage("hot lists", kernel, "pairs", arguments)


def cell_drift(model: Model, state: State, share: Share, dt: float) -> tuple[Stage, ...]:
    """Begin a step of the cell, where it deforms."""
    if not model.features.deforming:
        return ()
    return (Stage("cell drift", drift_cell, "one", (dt, share.clock, state.cell)),)


def cell(
    model: Model, state: State, lists: Lists, share: Share, dt: float, *, onward: bool
) -> tuple[Stage, ...]:
    """End a step of the cell, where it deforms, and begin the next one.

    The first host thread does it for all: they meet when the stresses are summed, and again when
    the cell has its new motion.
    """
    has = model.features
    if not has.deforming:
        return ()
    waits = (meet(share),) if share.members > 1 else ()
    stages: list[Stage] = []
    if has.cell_sums:
        arguments = (
            model.inertia,
            model.body_count,
            share.chunks,
            state.bodies,
            lists.pairs,
            lists.incidence,
            share.clock,
            state.cell,
        )
        kernel = sum_stress(predicted=has.predicted)
        stages = [Stage("stress", kernel, "chunks", arguments), *waits]
    if share.member == 0:
        kernel = kick_cell(sums=has.cell_sums, onward=onward)
        stages.append(Stage("cell", kernel, "one", (dt, share.clock, state.cell)))
    return (*stages, *waits)


def areas(model: Model, state: State, share: Share) -> Stage:
    """Areas that pressures act on, where no body is moving."""
    arguments = (model.gauges, state.bodies, share.clock, state.drives)
    return Stage("areas", measure_areas, "gauges", arguments)


def meet(share: Share) -> Stage:
    """Wait for the other host threads."""
    arguments = (share.member, share.members, share.arrived)
    return Stage("meet", meet_kernel, "one", arguments)


@functools.cache
def laws(has: Features) -> Laws:
    """The contact laws a scene chose."""
    chosen = {name: getattr(has, name) for name in Laws._fields}
    chosen["custom"] = tuple(load_custom_law(file, name) for file, name in has.custom)
    return Laws(**chosen)


def forces_on_bodies(has: Features) -> Forces:
    """The forces on single bodies that a scene chose."""
    return Forces(**{name: getattr(has, name) for name in Forces._fields})


def _rotate(has: Features) -> wp.Function:
    if has.spherical and has.rotation in KICKED:
        return spherical_drift
    return DRIFTS[has.rotation]


def acting(model: Model, state: State, lists: Lists, share: Share, dt: float) -> tuple[Stage, ...]:
    """Everything that acts between bodies."""
    hot = (hot_lists(model, state, lists, share, dt),) if model.features.hot_lists else ()
    glued = bonds(model, state, share, dt)
    return (*hot, forces(model, state, lists, share, dt), *glued)


def after_drift(
    model: Model, state: State, lists: Lists, share: Share, dt: float, *, onward: bool = False
) -> tuple[Stage, ...]:
    """The stages of a step that follow its drift; ``onward`` those of the next drift too."""
    has = model.features
    contacts = has.contacts
    kicked = advance(model, state, lists, share, dt, kicks=True, drifts=onward)
    deformed = cell(model, state, lists, share, dt, onward=onward)
    measured = (areas(model, state, share),) if len(model.gauges) and share.member == 0 else ()
    # the kick of one thread reads what the forces of another wrote; the next drift may halt
    waits = (meet(share),) if share.members > 1 else ()
    if not contacts:
        return (*measured, *waits, *deformed, kicked)
    return (*measured, *acting(model, state, lists, share, dt), *waits, *deformed, kicked)


def cycle(model: Model, state: State, lists: Lists, share: Share, dt: float) -> tuple[Stage, ...]:
    """From drift to drift."""
    waits = (meet(share),) if share.members > 1 else ()
    return (
        *after_drift(model, state, lists, share, dt, onward=True),
        *waits,
        halt(share),
    )
