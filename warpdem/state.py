"""The state: arrays that a step changes, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.kernels.cell import CHUNKS
from warpdem.kernels.meeting import LINE
from warpdem.kernels.precision import mat33, quat, real, vec3, vec4
from warpdem.kernels.views import Account, Bodies, Cell, Clock, Drives

if TYPE_CHECKING:
    from warpdem.bonding import Bonding


@dataclass(frozen=True)
class State:
    """What moves; shapes [body_count] unless said (see kernels.views for each array).

    Attributes:
        bodies: Positions, orientations, momenta, last forces and what derives from them;
            ``arm`` has shape [total vertex count of all bodies].
        clock: Flags and the step counter, shape [1] each.
        account: Energy bookkeeping; ``pair`` is owned by the lists.
        cell: The periodic cell; without arrays where the scene has none.
        drives: Imposed motion, a block of steps at a time (see warpdem.drives).
        bonding: The bonds, where there are any.
    """

    bodies: Bodies
    clock: Clock
    account: Account
    cell: Cell
    drives: Drives
    bonding: Bonding | None = None


def allocate(
    device: Any,
    body_count: int,
    arm_count: int,
    cell: Cell,
    *,
    work: bool,
    braking: bool,
    paths: bool,
) -> State:
    """A state of zeros, its drives to be given.

    ``work``: that of drivers or forces is kept; ``braking``: dashpots ask how many pairs act on a
    body; ``paths``: there are hot lists.
    """

    def zeros(dtype: Any, count: int = body_count) -> wp.array:
        return wp.zeros(count, dtype=dtype, device=device)

    bodies = Bodies()
    for name in ("position", "momentum", "angular_momentum", "force", "torque"):
        setattr(bodies, name, zeros(vec3))
    for name in ("velocity", "spin", "velocity_end", "spin_end", "listed_position"):
        setattr(bodies, name, zeros(vec3))
    bodies.orientation = zeros(quat)
    bodies.listed_orientation = zeros(quat)
    bodies.rotation = zeros(mat33)
    bodies.arm = zeros(vec3, max(arm_count, 1))
    bodies.braked = zeros(wp.int32, body_count if braking else 1)
    bodies.path = zeros(real, body_count if paths else 1)
    bodies.reach = zeros(real)
    clock = Clock()
    for name in ("moved", "fault", "halted", "steps"):
        setattr(clock, name, zeros(wp.int32, 1))
    energy = Account()
    kept = body_count if work else 1
    energy.body_power = zeros(real, kept)
    energy.work = zeros(real, kept)
    energy.pair = zeros(vec4, 1)
    energy.power = zeros(vec4, 1)
    return State(bodies, clock, energy, cell, Drives())


@dataclass(frozen=True)
class Share:
    """A host thread's part of every stage.

    Attributes:
        member, members: Which thread of how many.
        bodies, pairs, interfaces, chunks: First and last + 1, shape [2] each.
        clock: Shared flags, own counters.
        arrived: Counters of the meetings of all threads, shape [members * LINE].
    """

    member: int
    members: int
    bodies: wp.array
    pairs: wp.array
    interfaces: wp.array
    chunks: wp.array
    clock: Clock
    arrived: wp.array


def cut(state: State, body_count: int, members: int, device: Any) -> list[Share]:
    """Shares of ``members`` host threads; the first one has the state's own clock."""
    cuts = np.linspace(0, body_count, members + 1).astype(np.int32)
    glued = len(state.bonding) if state.bonding else 0
    places = np.linspace(0, glued, members + 1).astype(np.int32)
    parts = np.linspace(0, CHUNKS, members + 1).astype(np.int32)
    arrived = wp.zeros(members * LINE, dtype=wp.int32, device=device)
    shares = []
    for member in range(members):
        clock = state.clock
        if member > 0:
            clock = Clock()
            clock.moved, clock.fault = state.clock.moved, state.clock.fault
            clock.halted = wp.zeros(1, dtype=wp.int32, device=device)
            clock.steps = wp.zeros(1, dtype=wp.int32, device=device)
        bodies = wp.array(cuts[member : member + 2], dtype=wp.int32, device=device)
        pairs = wp.zeros(2, dtype=wp.int32, device=device)
        interfaces = wp.array(places[member : member + 2], dtype=wp.int32, device=device)
        chunks = wp.array(parts[member : member + 2], dtype=wp.int32, device=device)
        parts_of = (bodies, pairs, interfaces, chunks)
        shares.append(Share(member, members, *parts_of, clock, arrived))
    return shares
