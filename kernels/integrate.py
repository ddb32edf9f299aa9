"""Kick-drift-kick on linear momentum and world angular momentum; one thread a body.

A step is: half kick and drift, forces, half kick; the last half of one and the first of the next
are one pass over the bodies (``advance``). Tuckerman, Berne & Martyna
(1992), doi:10.1063/1.463137, for the scheme; tools/design for the measurements.
"""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.driving import follow, respond
from warpdem.kernels.external import Forces, external_forces
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.precision import mat33, real, vec3
from warpdem.kernels.rotation import arc
from warpdem.kernels.sleep import dormancy, time_slow
from warpdem.kernels.surfaces import tilt
from warpdem.kernels.variant import inlined, place, plain, variant
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
    Joints,
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
    grown = bodies.rotation[body] * geometry.scale[body]
    start = geometry.arm_start[body]
    for k in range(geometry.vertex_start[shape + 1] - first):
        bodies.arm[start + k] = grown * geometry.vertex[first + k]


@inlined()
def turn(geometry: Geometry, bodies: Bodies, body: int) -> real:
    """How far a body has turned since the lists were made [rad]."""
    return arc(bodies.orientation[body], bodies.listed_orientation[body])


@inlined()
def turned_not(geometry: Geometry, bodies: Bodies, body: int) -> real:
    """``turn`` of bodies whose turning moves nothing."""
    return real(0.0)


@wp.func
def flies(speed: real, spinning: real, bound: real, dt: real) -> bool:
    """Whether a body moves more than its own size in one step, or has no velocity (NaN)."""
    return not ((speed + real(0.3) * spinning * bound) * dt <= bound)


@functools.cache
def watching(*, paths: bool, surfaces: bool, turns: bool, deforming: bool) -> wp.Function:
    """Function that notes a body that left its skin, or flew off.

    ``paths``: the way of its farthest point is summed up, and spares the look at where it was
    listed; ``surfaces``: some surface moves; ``turns``: turning moves something.
    """
    turn_of = tilt if surfaces else turn
    if not turns:
        turn_of = turned_not

    @inlined()
    def watch(
        geometry: Geometry,
        bodies: Bodies,
        cell: Cell,
        clock: Clock,
        body: int,
        velocity: vec3,
        spin: vec3,
        lever: real,
        dt: real,
        watched: real,
    ):
        """``watched`` is the step for which flying off counts; 0 looks for NaN alone."""
        bound = geometry.bound[body]
        reach = bodies.reach[body]
        own = velocity
        if wp.static(deforming):
            # in a cell that deforms: motion against the cell's
            inside = bodies.position[body] - cell.centre[0]
            gradient = cell.rate[0] * wp.inverse(cell.edges[0])
            own = velocity - gradient * inside
        speed = wp.length(own)
        spinning = wp.length(spin)
        if flies(speed, spinning, bound, watched):
            clock.fault[0] = 1
        if wp.static(paths):
            pace = speed + (bound + lever) * spinning
            if wp.static(deforming):
                pace += wp.sqrt(wp.ddot(gradient, gradient)) * (bound + reach)
            path = bodies.path[body] + pace * dt
            bodies.path[body] = path
            if path <= reach:
                return
        away = bodies.position[body] - bodies.listed_position[body]
        stretched = real(0.0)
        if wp.static(deforming):
            # F = H H_listed^-1 and u = x - F x_listed: d = u_i - u_j + F d_listed of all images
            listed = bodies.listed_position[body] - cell.centre[0]
            away = inside - cell.since[0] * listed
            stretched = cell.stretch[0] * (bound + reach)
        turned = turn_of(geometry, bodies, body)
        if not (wp.length(away) + (bound + lever) * turned + stretched <= reach):
            clock.moved[0] = 1

    return watch


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


@functools.cache
def gather(*, summed: bool) -> wp.Function:
    """Function of the contact force and torque on a body, and how many pairs act on it.

    Summed over its pairs in a fixed order; ``summed``: over those it owns by the pair kernel.
    """

    @inlined()
    def one_by_one(pairs: Pairs, incidence: Incidence, body: int):
        acting = int(0)
        force = vec3()
        torque = vec3()
        first, others, count = pairs_of(incidence, body)
        for k in range(count):
            code = pair_at(incidence, body, first, others, k)
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
    def beyond_own(pairs: Pairs, incidence: Incidence, body: int):
        force = incidence.own_force[body]
        torque = incidence.own_torque[body]
        for k in range(incidence.start[body], incidence.start[body + 1]):
            pair = place(incidence.pair[k])
            if pairs.touching[pair] > 0:
                force -= pairs.force[pair]
                torque += pairs.torque_partner[pair]
        return force, torque, 0

    return beyond_own if summed else one_by_one


@inlined()
def book(energy: Account, body: int, power: real, dt: real):
    """Add the work of a step, whose powers at both ends are known, to a body's account."""
    mean = real(0.5) * (power + energy.body_power[body])
    energy.work[body] = energy.work[body] + mean * dt
    energy.body_power[body] = power


@inlined()
def gather_bonds(bonds: Bonds, joined: Joints, body: int):
    """Force and torque of the bonds on a body, summed over its interfaces in a fixed order."""
    force = vec3()
    torque = vec3()
    for k in range(joined.start[body], joined.start[body + 1]):
        code = joined.interface[k]
        interface = code >> 1
        if bonds.state[interface] != 0:
            if (code & 1) == 0:
                force += bonds.force[interface]
                torque += bonds.torque[interface]
            else:
                force -= bonds.force[interface]
                torque += bonds.torque_partner[interface]
    return force, torque


class Motion(NamedTuple):
    """What moving the bodies of a scene needs; every field that is False is compiled out."""

    predicted: bool  # velocities are predicted for the end of the step
    ending_spins: bool  # and spins
    contacts: bool
    summed: bool  # the pair kernel sums the wrenches of the pairs a body owns
    paths: bool  # there are hot lists
    turns: bool  # orientations are followed
    spherical: bool  # all moments of inertia are alike
    braking: bool  # dashpots ask how many pairs act on a body
    bonds: bool
    driven: bool
    controlled: bool  # some driven bodies follow a force
    stepwise: bool  # positions of driven bodies are summed up
    surfaces: bool  # some surface is driven
    work: bool  # account is kept of the work of all
    deforming: bool
    sleeps: bool  # bodies at rest may sleep


@functools.cache
def gathering(motion: Motion) -> wp.Function:
    """Function of the force and torque on a body from its pairs and bonds."""
    gather_pairs = gather(summed=motion.summed)

    @inlined()
    def gathering(
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        bodies: Bodies,
        body: int,
    ):
        force = vec3()
        torque = vec3()
        if wp.static(motion.contacts):
            force, torque, acting = gather_pairs(pairs, incidence, body)
            if wp.static(motion.braking):
                bodies.braked[body] = acting
        if wp.static(motion.bonds):
            held, turning = gather_bonds(glue, joined, body)
            force += held
            torque += turning
        return force, torque

    return gathering


@functools.cache
def driving(motion: Motion) -> wp.Function:
    """Function of the second and first half of a step of a body without inverse mass."""
    gather_all = gathering(motion)
    follow_drives = follow(controlled=motion.controlled, stepwise=motion.stepwise)
    watch = watching(paths=motion.paths, surfaces=motion.surfaces, turns=True, deforming=False)

    @inlined()
    def driving(
        geometry: Geometry,
        inertia: Inertia,
        lever: real,
        dt: real,
        kicks: int,
        drifts: int,
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        cell: Cell,
        drives: Drives,
        bodies: Bodies,
        clock: Clock,
        energy: Account,
        body: int,
    ):
        if inertia.driven[body] == 0:
            return
        if wp.static(motion.controlled or motion.work):
            if kicks != 0:
                force, torque = gather_all(pairs, incidence, glue, joined, bodies, body)
                if wp.static(motion.controlled):
                    respond(inertia, drives, bodies, body, force, torque, dt)
                if wp.static(motion.work):
                    power = -wp.dot(force, bodies.velocity_end[body])
                    power -= wp.dot(torque, bodies.spin_end[body])
                    book(energy, body, power, dt)
        if drifts != 0:
            before = bodies.position[body]
            faced = bodies.orientation[body]
            follow_drives(inertia, drives, bodies, body, dt)
            bodies.rotation[body] = wp.quat_to_matrix(bodies.orientation[body])
            place_arms(geometry, bodies, body)
            if wp.static(motion.paths):
                moved = wp.length(bodies.position[body] - before)
                moved += (geometry.bound[body] + lever) * arc(bodies.orientation[body], faced)
                bodies.path[body] = bodies.path[body] + moved
            watch(
                geometry,
                bodies,
                cell,
                clock,
                body,
                bodies.velocity[body],
                bodies.spin[body],
                lever,
                real(0.0),
                real(0.0),
            )

    return driving


@functools.cache
def advance(
    rotate: wp.Function, torque_of: wp.Function, forces: Forces, motion: Motion
) -> wp.Kernel:
    """Kernel of what a body does between two force passes.

    It gathers the wrenches and ends one step with the second half kick where ``kicks`` is not 0,
    and begins the next with the first half kick and the drift where ``drifts`` is not 0; ``rotate``
    is a drift of kernels.rotation.
    """
    gather_all = gathering(motion)
    drive = driving(motion)
    act = external_forces(forces)
    dormant = dormancy(gather_all)
    watch = watching(
        paths=motion.paths,
        surfaces=motion.surfaces,
        turns=motion.turns,
        deforming=motion.deforming,
    )

    @variant
    def advance(
        # model
        geometry: Geometry,
        inertia: Inertia,
        gravity: vec3,
        external: External,
        # in
        lever: real,
        dt: real,
        kicks: int,
        drifts: int,
        span: wp.array(dtype=wp.int32),
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        cell: Cell,
        # in and out
        drives: Drives,
        bodies: Bodies,
        # out
        clock: Clock,
        energy: Account,
    ):
        body = place(wp.tid() + span[0])
        if body >= span[1] or clock.halted[0] != 0:
            return
        inverse_mass = inertia.inverse_mass[body]
        if inverse_mass == real(0.0):
            if wp.static(motion.driven):
                # fmt: off
                drive(
                    geometry, inertia, lever, dt, kicks, drifts, pairs, incidence, glue, joined,
                    cell, drives, bodies, clock, energy, body,
                )
                # fmt: on
            return
        if wp.static(motion.sleeps):
            if dormant(geometry, pairs, incidence, glue, joined, bodies, body, kicks):
                return
        half = real(0.5) * dt
        momentum = bodies.momentum[body]
        spun = bodies.angular_momentum[body]
        force = vec3()
        torque = vec3()
        if kicks != 0:
            force, torque = gather_all(pairs, incidence, glue, joined, bodies, body)
            weight = gravity * inertia.mass[body]
            if wp.static(forces.some):
                force, torque, power = act(
                    inertia, external, bodies, weight, body, force, torque, dt
                )
                if wp.static(forces.account):
                    book(energy, body, power, dt)
            else:
                force += weight
            torque = torque_of(torque, bodies.spin[body], spun)
            if wp.static(motion.deforming):
                # the homogeneous flow accelerates with the cell
                x = (bodies.position[body] - cell.centre[0]) * inertia.mass[body]
                force += cell.acceleration[0] * x
                momentum += cell.jump[0] * x
            momentum += force * half
            spun += torque * half
            if drifts == 0:
                bodies.force[body] = force
                bodies.torque[body] = torque
        else:
            force = bodies.force[body]
            torque = bodies.torque[body]
        if drifts != 0:
            momentum += force * half
            velocity = momentum * inverse_mass
            bodies.velocity[body] = velocity
            bodies.position[body] = bodies.position[body] + velocity * dt
            inverse = inertia.inverse_moment[body]
            spin = vec3()
            ahead = vec3()
            if wp.static(motion.turns):
                q, turned = rotate(bodies.orientation[body], spun, torque, inertia.moment[body], dt)
                spun = turned
                bodies.orientation[body] = q
                rotation = wp.quat_to_matrix(q)
                bodies.rotation[body] = rotation
                if wp.static(motion.spherical):
                    spin = spun * inverse[0]
                    ahead = torque * (half * inverse[0])
                else:
                    spin = world_inverse(rotation, inverse, spun)
                    ahead = world_inverse(rotation, inverse, torque * half)
                place_arms(geometry, bodies, body)
            else:
                spun += torque * half
                spin = spun * inverse[0]
                ahead = torque * (half * inverse[0])
            bodies.spin[body] = spin
            if wp.static(motion.predicted):
                bodies.velocity_end[body] = velocity + force * (half * inverse_mass)
            if wp.static(motion.ending_spins):
                bodies.spin_end[body] = spin + ahead
            if wp.static(motion.sleeps):
                time_slow(geometry, bodies, body, dt)
            watched = dt
            if wp.static(not motion.contacts):
                watched = real(0.0)
            watch(geometry, bodies, cell, clock, body, velocity, spin, lever, dt, watched)
        bodies.momentum[body] = momentum
        bodies.angular_momentum[body] = spun

    return advance
