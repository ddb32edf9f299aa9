"""Small parts of the integration: vertices and orientation, the end of a step, the account."""

from typing import Any

import warp as wp
from warpdem.kernels.precision import mat33, wide
from warpdem.kernels.variant import inlined, plain
from warpdem.kernels.views import Account, Bodies, Clock, Geometry


@wp.func
def world_inverse(rotation: Any, inverse_moment: Any, momentum: Any):
    """World I^-1 L from the rotation matrix; zero for a fixed body."""
    return rotation * wp.cw_mul(wp.transpose(rotation) * momentum, inverse_moment)


@inlined()
def place_arms(geometry: Geometry, bodies: Bodies, body: int):
    """Vertices of a body about its centre in world axes [m]."""
    shape = geometry.shape[body]
    first = geometry.vertex_start[shape]
    grown = bodies.rotation[body] * geometry.scale[body]
    start = geometry.arm_start[body]
    for k in range(geometry.vertex_start[shape + 1] - first):
        bodies.arm[start + k] = grown * geometry.vertex[first + k]


@plain
def orient(
    # model
    geometry: Geometry,
    # in and out
    bodies: Bodies,
):
    """Rotation matrix and vertices of every body from its orientation."""
    body = wp.tid()
    bodies.rotation[body] = mat33(wp.quat_to_matrix(bodies.orientation[body]))
    place_arms(geometry, bodies, body)


@plain
def halt(
    # in and out
    clock: Clock,
):
    """End of a step's drift: count it, and stop where it was the last or the host has to act."""
    if clock.halted[0] == 0:
        clock.steps[0] = clock.steps[0] + 1
        clock.left[0] = clock.left[0] - 1
        if clock.moved[0] != 0 or clock.fault[0] != 0:
            clock.halted[0] = 1
        if clock.halted[0] != 0 or clock.left[0] <= 0:
            clock.going[0] = 0


@inlined()
def book(energy: Account, body: int, power: wide, dt: wide):
    """Add the work of a step, whose powers at both ends are known, to a body's account."""
    mean = wide(0.5) * (power + energy.body_power[body])
    energy.work[body] = energy.work[body] + mean * dt
    energy.body_power[body] = power
