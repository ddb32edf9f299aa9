"""The state: arrays that a step changes, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import warp as wp

from warpdem.kernels.precision import mat33, quat, real, vec3, vec4
from warpdem.kernels.views import Account, Bodies, Clock


@dataclass(frozen=True)
class State:
    """What moves; shapes [body_count] unless said (see kernels.views for each array).

    Attributes:
        bodies: Positions, orientations, momenta, last forces and what derives from them;
            ``arm`` has shape [total vertex count of all bodies].
        clock: Flags and the step counter, shape [1] each.
        account: Energy bookkeeping; ``pair`` is owned by the lists.
    """

    bodies: Bodies
    clock: Clock
    account: Account


def allocate(device: Any, body_count: int, arm_count: int, *, account: bool) -> State:
    """A state of zeros."""

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
    clock = Clock()
    for name in ("moved", "fault", "halted", "steps"):
        setattr(clock, name, zeros(wp.int32, 1))
    energy = Account()
    kept = body_count if account else 1
    energy.power = zeros(real, kept)
    energy.work = zeros(real, kept)
    energy.pair = zeros(vec4, 1)
    return State(bodies, clock, energy)
