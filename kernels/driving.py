"""Driven bodies: motion imposed in advance, and walls that follow a force along some axes.

A wall that follows a force along the world's axis a obeys m_a dv_a/dt = F_a + f_a - c_a v_a, F the
imposed and f the contact force, on top of the motion imposed on it; about an axis likewise, with a
moment of inertia of its own. The contact laws see it as a body without inverse mass.
"""

import functools

import warp as wp
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.precision import real, wide, wide3
from warpdem.kernels.rotation import exponential
from warpdem.kernels.variant import inlined, plain
from warpdem.kernels.views import (
    Bodies,
    Candidates,
    Clock,
    Drives,
    Gauge,
    Incidence,
    Inertia,
    Material,
    Pairs,
)


@wp.func
def damped_kick(
    momentum: wide3, force: wide3, inverse_mass: wide3, damping: wide3, loose: wide3, half: wide
) -> wide3:
    """Momentum after half a step, damping taken implicitly; zero along axes that are held."""
    kicked = momentum + force * half
    for axis in range(3):
        slowed = wide(1.0) + half * damping[axis] * inverse_mass[axis]
        kicked[axis] = loose[axis] * kicked[axis] / slowed
    return kicked


@functools.cache
def follow(*, controlled: bool, stepwise: bool) -> wp.Function:
    """Function of the drift of a driven body.

    ``controlled``: some bodies follow a force. ``stepwise``: positions are summed up from the
    velocities of the steps' ends, as Rockable does, instead of being imposed themselves.
    """

    @inlined()
    def follow(inertia: Inertia, drives: Drives, bodies: Bodies, body: int, dt: wide):
        place = inertia.driven[body] - 1
        row = (drives.steps[0] - drives.base[0]) * drives.count + place
        position = drives.position[row]
        orientation = drives.orientation[row]
        velocity = drives.velocity[row]
        spin = drives.spin[row]
        velocity_end = drives.velocity_end[row]
        spin_end = drives.spin_end[row]
        if wp.static(controlled):
            half = wide(0.5) * dt
            loose = drives.loose[row]
            loose_spin = drives.loose_spin[row]
            force = wp.cw_mul(loose, bodies.force[body])
            torque = wp.cw_mul(loose_spin, bodies.torque[body])
            momentum = wp.cw_mul(loose, bodies.momentum[body]) + force * half
            turning = wp.cw_mul(loose_spin, bodies.angular_momentum[body]) + torque * half
            bodies.momentum[body] = momentum
            bodies.angular_momentum[body] = turning
            own = wp.cw_mul(momentum, drives.inverse_mass[place])
            own_spin = wp.cw_mul(turning, drives.inverse_inertia[place])
            offset = drives.offset[place] + own * dt
            turn = exponential(drives.turn[place], own_spin, dt)
            drives.offset[place] = offset
            drives.turn[place] = turn
            position += offset
            orientation = turn * orientation
            velocity += own
            spin = own_spin + wp.quat_rotate(turn, spin)
            spin_end = wp.quat_rotate(turn, spin_end)
            drives.now[place] = wp.matrix_from_rows(
                drives.force[row], drives.moment[row], drives.pressure[row]
            )
            drives.now_loose[place] = wp.matrix_from_rows(loose, loose_spin, wide3())
            drives.now_end[place] = wp.matrix_from_rows(velocity_end, spin_end, wide3())
            velocity_end += own + wp.cw_mul(force, drives.inverse_mass[place]) * half
            spin_end += own_spin + wp.cw_mul(torque, drives.inverse_inertia[place]) * half
        if wp.static(stepwise):
            position = bodies.position[body] + velocity * dt
            orientation = exponential(bodies.orientation[body], spin, dt)
        bodies.position[body] = position
        bodies.orientation[body] = orientation
        bodies.velocity[body] = velocity
        bodies.spin[body] = spin
        bodies.velocity_end[body] = velocity_end
        bodies.spin_end[body] = spin_end

    return follow


@inlined()
def respond(
    inertia: Inertia,
    drives: Drives,
    bodies: Bodies,
    body: int,
    force: wide3,
    torque: wide3,
    dt: wide,
):
    """Second half kick of a wall by its contact wrench and what is imposed on it."""
    place = inertia.driven[body] - 1
    half = wide(0.5) * dt
    imposed = drives.now[place]
    loose = drives.now_loose[place]
    end = drives.now_end[place]
    inverse_mass = drives.inverse_mass[place]
    inverse_inertia = drives.inverse_inertia[place]
    area = wide3(drives.area[3 * place], drives.area[3 * place + 1], drives.area[3 * place + 2])
    total = force + imposed[0] + wp.cw_mul(imposed[2], area)
    moment = torque + imposed[1]
    damping = drives.damping[place]
    spin_damping = drives.spin_damping[place]
    momentum = damped_kick(bodies.momentum[body], total, inverse_mass, damping, loose[0], half)
    turning = damped_kick(
        bodies.angular_momentum[body], moment, inverse_inertia, spin_damping, loose[1], half
    )
    own = wp.cw_mul(momentum, inverse_mass)
    own_spin = wp.cw_mul(turning, inverse_inertia)
    bodies.momentum[body] = momentum
    bodies.angular_momentum[body] = turning
    bodies.force[body] = total - wp.cw_mul(damping, own)
    bodies.torque[body] = moment - wp.cw_mul(spin_damping, own_spin)
    bodies.velocity_end[body] = end[0] + own
    bodies.spin_end[body] = end[1] + own_spin


@plain
def measure_areas(
    # in
    gauges: wp.array(dtype=Gauge),
    bodies: Bodies,
    clock: Clock,
    # in and out
    drives: Drives,
):
    """Areas that pressures act on, from where the walls around them stand."""
    if clock.halted[0] != 0:
        return
    gauge = gauges[wp.tid()]
    area = wide(1.0)
    for k in range(2):
        axis = gauge.axis[k]
        low = bodies.position[gauge.low[k]]
        high = bodies.position[gauge.high[k]]
        area *= wp.max(high[axis] - low[axis] - gauge.less[k], wide(0.0))
    drives.area[gauge.place] = area


@wp.func
def mobility(n: wide3, inverse: wide3) -> wide:
    """n . diag(inverse) n."""
    return wp.dot(n, wp.cw_mul(inverse, n))


@plain
def wall_frequency(
    # model
    inertia: Inertia,
    materials: wp.array(dtype=Material),
    # in
    drives: Drives,
    bodies: Bodies,
    pairs: Pairs,
    candidates: Candidates,
    incidence: Incidence,
    # out
    square: wp.array(dtype=real),
):
    """Bound of the square of the frequency of each wall that follows a force [1/s^2].

    Trace of M^-1 sum phi K over its contacts, phi = 2 as between two bodies that move.
    """
    body = wp.tid()
    place = inertia.driven[body] - 1
    if place < 0:
        return
    inverse_mass = drives.inverse_mass[place]
    inverse_inertia = drives.inverse_inertia[place]
    total = wide(0.0)
    first, others, count = pairs_of(incidence, body)
    for k in range(count):
        code = pair_at(incidence, body, first, others, k)
        pair = code >> 1
        law = materials[pairs.material[pair]]
        shift = wide3()
        if (code & 1) == 0:
            shift = bodies.position[pairs.partner[pair]] - bodies.position[body]
        kn = wide(law.kn)
        kt = wide(law.kt)
        kr = wide(law.kr)
        start = pairs.start[pair]
        for slot in range(start, start + pairs.touching[pair]):
            arm = wide3(candidates.point[slot]) + shift
            n = wide3(candidates.normal[slot])
            total += (kn - kt) * mobility(n, inverse_mass)
            total += kt * (inverse_mass[0] + inverse_mass[1] + inverse_mass[2])
            for axis in range(3):
                lever = wide3()
                lever[axis] = wide(1.0)
                lever = wp.cross(lever, arm)
                along = wp.dot(lever, n)
                across = wp.dot(lever, lever) - along * along
                total += inverse_inertia[axis] * (kn * along * along + kt * across)
                total += inverse_inertia[axis] * kr
    square[body] = real(wide(2.0) * total)
