"""The stages of a step: which kernel, over what, with which arguments. Nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from warpdem.kernels import integrate, rotation
from warpdem.kernels.forces import Laws, pair_forces
from warpdem.kernels.precision import vec3

if TYPE_CHECKING:
    import warp as wp

    from warpdem.features import Features
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State


@dataclass(frozen=True)
class Stage:
    """One kernel over all bodies or pairs.

    Attributes:
        name: What a profile calls it.
        kernel: The kernel.
        over: What a thread owns; its ranges may be split among host threads.
        arguments: In the kernel's order.
        first: Index of the argument that holds the first thread of a range; -1 without.
    """

    name: str
    kernel: wp.Kernel
    over: Literal["bodies", "pairs", "one"]
    arguments: tuple[Any, ...]
    first: int


def drift(model: Model, state: State, dt: float) -> Stage:
    """First half kick and drift."""
    has = model.features
    kernel = integrate.drift(_rotate(has), predicted=has.predicted, driven=has.driven)
    arguments = (
        model.geometry, model.inertia, dt, 0.5 * model.skin, 0, state.bodies, state.clock,
    )
    return Stage("drift", kernel, "bodies", arguments, 4)


def halt(state: State) -> Stage:
    """Count the step; stop where a body left its skin."""
    return Stage("halt", integrate.halt, "one", (state.clock,), -1)


def forces(model: Model, state: State, lists: Lists, dt: float) -> Stage:
    """Contact wrench of each pair."""
    arguments = (
        model.geometry, model.inertia, model.materials, dt, model.keep_within, 0,
        state.bodies, state.clock, lists.pairs, lists.candidates, state.account,
    )
    return Stage("pair forces", pair_forces(laws(model.features)), "pairs", arguments, 5)


def kick(model: Model, state: State, lists: Lists, dt: float, *, contacts: bool) -> Stage:
    """Gather the wrenches, add body forces, second half kick."""
    has = model.features
    torque = rotation.taylor_torque if has.taylor else rotation.free_torque
    account = has.account and has.driven
    kernel = integrate.kick(torque, contacts=contacts, account=account)
    arguments = (
        model.inertia, vec3(*model.gravity), dt, 0, lists.pairs, lists.incidence, state.clock,
        state.bodies, state.account,
    )
    return Stage("gather and kick", kernel, "bodies", arguments, 3)


def laws(has: Features) -> Laws:
    """The contact laws a scene chose."""
    return Laws(**{name: getattr(has, name) for name in Laws._fields})


def _rotate(has: Features) -> wp.Function:
    if has.taylor:
        return rotation.taylor_drift
    return rotation.spherical_drift if has.spherical else rotation.free_drift
