"""Kick-drift-kick on linear momentum and world angular momentum; one thread a body.

A step is: half kick and drift (``drift``), forces, half kick (``kick``). Tuckerman, Berne & Martyna
(1992), doi:10.1063/1.463137, for the scheme; tools/design for the measurements.
"""

import functools

import warp as wp
from warpdem.kernels.driving import follow, respond
from warpdem.kernels.external import Forces, external_forces
from warpdem.kernels.precision import mat33, real, vec3
from warpdem.kernels.rotation import arc
from warpdem.kernels.surfaces import tilt
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import (
    Account,
    Bodies,
    Bonds,
    Cell,
    Clock,
    Drives,
    External,
    Geometry,
    Incidence,
    Inertia,
    Pairs,
)


@wp.func
def world_inverse(rotation: mat33, inverse_moment: vec3, momentum: vec3) -> vec3:
    """World I^-1 L from the rotation matrix; zero for a fixed body."""
    return rotation * wp.cw_mul(wp.transpose(rotation) * momentum, inverse_moment)


@inlined()
def place_arms(geometry: Geometry, bodies: Bodies, body: int):
    """Vertices of a body about its centre in world axes [m]."""
    shape = geometry.shape[body]
    first = geometry.vertex_start[shape]
    scale = geometry.scale[body]
    start = geometry.arm_start[body]
    for k in range(geometry.vertex_start[shape + 1] - first):
        bodies.arm[start + k] = bodies.rotation[body] * geometry.vertex[first + k] * scale


@inlined()
def turn(geometry: Geometry, bodies: Bodies, body: int) -> real:
    """How far a body has turned since the lists were made [rad]."""
    return arc(bodies.orientation[body], bodies.listed_orientation[body])


@functools.cache
def watching(*, surfaces: bool) -> wp.Function:
    """Function that notes a body that left its skin, or flew off; ``surfaces``: some move."""
    turn_of = tilt if surfaces else turn

    @inlined()
    def watch(geometry: Geometry, bodies: Bodies, clock: Clock, body: int, dt: real):
        """Note a body that left its skin, or moved more than its own size in one step (or NaN).

        ``dt`` 0 looks for NaN alone.
        """
        bound = geometry.bound[body]
        speed = wp.length(bodies.velocity[body])
        turn = wp.length(bodies.spin[body])
        if not ((speed + real(0.3) * turn * bound) * dt <= bound):
            clock.fault[0] = 1
        moved = wp.length(bodies.position[body] - bodies.listed_position[body])
        turned = turn_of(geometry, bodies, body)
        if not (moved + bound * turned <= clock.reach[0]):
            clock.moved[0] = 1

    return watch


@inlined()
def watch_flow(geometry: Geometry, bodies: Bodies, cell: Cell, clock: Clock, body: int, dt: real):
    """``watch`` in a cell that deforms: motion against the cell's since the lists were made.

    With F = H H_listed^-1 and u = x - F x_listed, d = u_i - u_j + F d_listed for every image.
    """
    bound = geometry.bound[body]
    centre = cell.centre[0]
    x = bodies.position[body] - centre
    speed = wp.length(bodies.velocity[body] - cell.rate[0] * wp.inverse(cell.edges[0]) * x)
    turn = wp.length(bodies.spin[body])
    if not ((speed + real(0.3) * turn * bound) * dt <= bound):
        clock.fault[0] = 1
    moved = wp.length(x - cell.since[0] * (bodies.listed_position[body] - centre))
    turned = arc(bodies.orientation[body], bodies.listed_orientation[body])
    stretched = cell.stretch[0] * (bound + clock.reach[0])
    if not (moved + bound * turned + stretched <= clock.reach[0]):
        clock.moved[0] = 1


@plain
def orient(
    # model
    geometry: Geometry,
    # in and out
    bodies: Bodies,
):
    """Rotation matrix and vertices of every body from its orientation."""
    body = wp.tid()
    bodies.rotation[body] = wp.quat_to_matrix(bodies.orientation[body])
    place_arms(geometry, bodies, body)


@functools.cache
def drift(
    rotate: wp.Function,
    *,
    predicted: bool,
    driven: bool,
    controlled: bool,
    stepwise: bool,
    contacts: bool,
    surfaces: bool,
    deforming: bool,
) -> wp.Kernel:
    """Kernel of the first half kick and the drift; ``rotate`` is a drift of kernels.rotation."""
    watch = watching(surfaces=surfaces and driven)
    follow_drives = follow(controlled=controlled, stepwise=stepwise)

    @variant
    def drift(
        # model
        geometry: Geometry,
        inertia: Inertia,
        # in
        dt: real,
        span: wp.array(dtype=wp.int32),
        cell: Cell,
        # in and out
        drives: Drives,
        bodies: Bodies,
        # out
        clock: Clock,
    ):
        body = wp.tid() + span[0]
        if body >= span[1] or clock.halted[0] != 0:
            return
        half = real(0.5) * dt
        if inertia.inverse_mass[body] == real(0.0):
            if wp.static(driven):
                if inertia.driven[body] != 0:
                    follow_drives(inertia, drives, bodies, body, dt)
                    bodies.rotation[body] = wp.quat_to_matrix(bodies.orientation[body])
                    place_arms(geometry, bodies, body)
                    watch(geometry, bodies, clock, body, real(0.0))
            return
        force = bodies.force[body]
        torque = bodies.torque[body]
        momentum = bodies.momentum[body] + force * half
        velocity = momentum * inertia.inverse_mass[body]
        bodies.momentum[body] = momentum
        bodies.velocity[body] = velocity
        bodies.position[body] = bodies.position[body] + velocity * dt
        q, spun = rotate(
            bodies.orientation[body],
            bodies.angular_momentum[body],
            torque,
            inertia.moment[body],
            dt,
        )
        bodies.orientation[body] = q
        bodies.angular_momentum[body] = spun
        rotation = wp.quat_to_matrix(q)
        bodies.rotation[body] = rotation
        inverse = inertia.inverse_moment[body]
        bodies.spin[body] = world_inverse(rotation, inverse, spun)
        if wp.static(predicted):
            bodies.velocity_end[body] = velocity + force * (half * inertia.inverse_mass[body])
            bodies.spin_end[body] = world_inverse(rotation, inverse, spun + torque * half)
        place_arms(geometry, bodies, body)
        watched = dt
        if wp.static(not contacts):
            watched = real(0.0)
        if wp.static(deforming):
            watch_flow(geometry, bodies, cell, clock, body, watched)
        else:
            watch(geometry, bodies, clock, body, watched)

    return drift


@plain
def halt(
    # in and out
    clock: Clock,
):
    """End of a step's drift: count it, and stop the batch where the host has to act."""
    if clock.halted[0] == 0:
        clock.steps[0] = clock.steps[0] + 1
        if clock.moved[0] != 0 or clock.fault[0] != 0:
            clock.halted[0] = 1


@inlined()
def gather(pairs: Pairs, incidence: Incidence, body: int):
    """Contact force and torque on a body, summed over its pairs in a fixed order; how many act."""
    acting = int(0)
    force = vec3()
    torque = vec3()
    for k in range(incidence.start[body], incidence.start[body + 1]):
        code = incidence.pair[k]
        pair = code >> 1
        if pairs.touching[pair] > 0:
            acting += 1
            if (code & 1) == 0:
                force += pairs.force[pair]
                torque += pairs.torque[pair]
            else:
                force -= pairs.force[pair]
                torque += pairs.torque_partner[pair]
    return force, torque, acting


@inlined()
def book(energy: Account, body: int, power: real, dt: real):
    """Add the work of a step, whose powers at both ends are known, to a body's account."""
    mean = real(0.5) * (power + energy.body_power[body])
    energy.work[body] = energy.work[body] + mean * dt
    energy.body_power[body] = power


@inlined()
def gather_bonds(bonds: Bonds, joined: Incidence, body: int):
    """Force and torque of the bonds on a body, summed over its interfaces in a fixed order."""
    force = vec3()
    torque = vec3()
    for k in range(joined.start[body], joined.start[body + 1]):
        code = joined.pair[k]
        interface = code >> 1
        if bonds.state[interface] != 0:
            if (code & 1) == 0:
                force += bonds.force[interface]
                torque += bonds.torque[interface]
            else:
                force -= bonds.force[interface]
                torque += bonds.torque_partner[interface]
    return force, torque


@functools.cache
def kick(
    torque_of: wp.Function,
    forces: Forces,
    *,
    contacts: bool,
    braking: bool,
    bonds: bool,
    controlled: bool,
    work: bool,
    deforming: bool,
) -> wp.Kernel:
    """Kernel of the gathering of forces and the second half kick.

    ``braking``: dashpots ask how many pairs act on a body; ``controlled``: some driven bodies
    follow a force; ``work``: account of the work of all.
    """
    act = external_forces(forces)

    @variant
    def kick(
        # model
        inertia: Inertia,
        gravity: vec3,
        external: External,
        # in
        dt: real,
        span: wp.array(dtype=wp.int32),
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Incidence,
        clock: Clock,
        cell: Cell,
        # in and out
        drives: Drives,
        bodies: Bodies,
        # out
        energy: Account,
    ):
        body = wp.tid() + span[0]
        if body >= span[1] or clock.halted[0] != 0:
            return
        free = inertia.inverse_mass[body] != real(0.0)
        if not free:
            if wp.static(not (controlled or work)):
                return
            if inertia.driven[body] == 0:
                return
        force = vec3()
        torque = vec3()
        if wp.static(contacts):
            force, torque, acting = gather(pairs, incidence, body)
            if wp.static(braking):
                bodies.braked[body] = acting
        if wp.static(bonds):
            held, turning = gather_bonds(glue, joined, body)
            force += held
            torque += turning
        if free:
            weight = gravity / inertia.inverse_mass[body]
            if wp.static(forces.some):
                force, torque, power = act(
                    inertia, external, bodies, weight, body, force, torque, dt
                )
                if wp.static(forces.account):
                    book(energy, body, power, dt)
            else:
                force += weight
            spun = bodies.angular_momentum[body]
            torque = torque_of(torque, bodies.spin[body], spun)
            half = real(0.5) * dt
            if wp.static(deforming):
                # the homogeneous flow accelerates with the cell
                x = (bodies.position[body] - cell.centre[0]) / inertia.inverse_mass[body]
                force += cell.acceleration[0] * x
                bodies.momentum[body] = bodies.momentum[body] + cell.jump[0] * x
            bodies.force[body] = force
            bodies.torque[body] = torque
            bodies.momentum[body] = bodies.momentum[body] + force * half
            bodies.angular_momentum[body] = spun + torque * half
        else:
            if wp.static(controlled):
                respond(inertia, drives, bodies, body, force, torque, dt)
            if wp.static(work):
                power = -wp.dot(force, bodies.velocity_end[body])
                power -= wp.dot(torque, bodies.spin_end[body])
                book(energy, body, power, dt)

    return kick
