"""The state: arrays that a step changes, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.allocation import allocate
from warpdem.kernels.cell import CHUNKS
from warpdem.kernels.meeting import LINE
from warpdem.kernels.views import Account, Bodies, Cell, Clock, Drives

if TYPE_CHECKING:
    from warpdem.bonding import Bonding
    from warpdem.features import Features


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


def allocate_state(
    device: Any, has: Features, body_count: int, arm_count: int, cell: Cell
) -> State:
    """A state of zeros, its drives to be given."""
    bodies, clock, account = Bodies(), Clock(), Account()
    allocate(bodies, "bodies", "body", body_count, has, device)
    allocate(bodies, "bodies", "vertex", max(arm_count, 1), has, device)
    for name in ("moved", "fault", "halted", "steps", "left", "going"):
        setattr(clock, name, wp.zeros(1, dtype=wp.int32, device=device))
    allocate(account, "account", "body", body_count, has, device)
    return State(bodies, clock, account, cell, Drives())


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
            for name in ("halted", "steps", "left", "going"):
                setattr(clock, name, wp.zeros(1, dtype=wp.int32, device=device))
        bodies = wp.array(cuts[member : member + 2], dtype=wp.int32, device=device)
        pairs = wp.zeros(2, dtype=wp.int32, device=device)
        interfaces = wp.array(places[member : member + 2], dtype=wp.int32, device=device)
        chunks = wp.array(parts[member : member + 2], dtype=wp.int32, device=device)
        parts_of = (bodies, pairs, interfaces, chunks)
        shares.append(Share(member, members, *parts_of, clock, arrived))
    return shares
