"""The stages of a step: which kernel, over what, with which arguments. Nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from warpdem.kernels.bonds import BondLaws, bond_forces
from warpdem.kernels.forces import pair_forces
from warpdem.kernels.integrate import drift as drift_kernel
from warpdem.kernels.integrate import halt as halt_kernel
from warpdem.kernels.integrate import kick as kick_kernel
from warpdem.kernels.laws import Laws
from warpdem.kernels.meeting import meet as meet_kernel
from warpdem.kernels.precision import vec3
from warpdem.kernels.rotation import (
    free_drift,
    free_torque,
    spherical_drift,
    taylor_drift,
    taylor_torque,
)
from warpdem.kernels.views import Bonds, Incidence

if TYPE_CHECKING:
    import warp as wp

    from warpdem.features import Features
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State


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
    over: Literal["bodies", "pairs", "interfaces", "one"]
    arguments: tuple[Any, ...]


def drift(model: Model, state: State, share: Share, dt: float) -> Stage:
    """First half kick and drift."""
    has = model.features
    kernel = drift_kernel(
        _rotate(has), predicted=has.predicted, driven=has.driven, contacts=has.contacts
    )
    arguments = (
        model.geometry,
        model.inertia,
        dt,
        share.bodies,
        state.bodies,
        share.clock,
    )
    return Stage("drift", kernel, "bodies", arguments)


def halt(share: Share) -> Stage:
    """Count the step; stop where a body left its skin."""
    return Stage("halt", halt_kernel, "one", (share.clock,))


def forces(model: Model, state: State, lists: Lists, share: Share, dt: float) -> Stage:
    """Contact wrench of each pair."""
    arguments = (
        model.geometry,
        model.inertia,
        model.materials,
        dt,
        model.keep_within,
        share.pairs,
        state.bodies,
        share.clock,
        lists.pairs,
        lists.candidates,
        state.account,
    )
    return Stage("pair forces", pair_forces(laws(model.features)), "pairs", arguments)


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


def kick(
    model: Model, state: State, lists: Lists, share: Share, dt: float, *, contacts: bool
) -> Stage:
    """Gather the wrenches, add body forces, second half kick."""
    has = model.features
    torque = taylor_torque if has.taylor else free_torque
    account = has.account and has.driven
    kernel = kick_kernel(torque, contacts=contacts, account=account, bonds=has.bonds)
    glue, joined = Bonds(), Incidence()
    if state.bonding:
        glue, joined = state.bonding.bonds, state.bonding.joined
    arguments = (
        model.inertia,
        vec3(*model.gravity),
        dt,
        share.bodies,
        lists.pairs,
        lists.incidence,
        glue,
        joined,
        share.clock,
        state.bodies,
        state.account,
    )
    return Stage("gather and kick", kernel, "bodies", arguments)


def meet(share: Share) -> Stage:
    """Wait for the other host threads."""
    arguments = (share.member, share.members, share.arrived)
    return Stage("meet", meet_kernel, "one", arguments)


def laws(has: Features) -> Laws:
    """The contact laws a scene chose."""
    return Laws(**{name: getattr(has, name) for name in Laws._fields})


def _rotate(has: Features) -> wp.Function:
    if has.taylor:
        return taylor_drift
    return spherical_drift if has.spherical else free_drift


def after_drift(
    model: Model, state: State, lists: Lists, share: Share, dt: float
) -> tuple[Stage, ...]:
    """The stages of a step that follow its drift."""
    contacts = model.features.contacts
    kicked = kick(model, state, lists, share, dt, contacts=contacts)
    if not contacts:
        return (kicked,)
    waits = (meet(share),) if share.members > 1 else ()
    glued = bonds(model, state, share, dt)
    return (forces(model, state, lists, share, dt), *glued, *waits, kicked)


def cycle(model: Model, state: State, lists: Lists, share: Share, dt: float) -> tuple[Stage, ...]:
    """From drift to drift.

    A host thread takes the same bodies in each stage, so none waits between kick and drift.
    """
    waits = (meet(share),) if share.members > 1 else ()
    return (
        *after_drift(model, state, lists, share, dt),
        drift(model, state, share, dt),
        *waits,
        halt(share),
    )
