"""What a body does between two force passes: gather, half kick, half kick, drift.

Kick-drift-kick on linear momentum and world angular momentum; Tuckerman, Berne & Martyna (1992),
doi:10.1063/1.463137, for the scheme; tools/design for the measurements. The last half of a step
and the first of the next are one pass over the bodies, one thread each.
"""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.driving import follow, respond
from warpdem.kernels.external import Forces, external_forces
from warpdem.kernels.gathering import gathering
from warpdem.kernels.integrate import book, place_arms, world_inverse
from warpdem.kernels.precision import mat33, wide, wide3
from warpdem.kernels.rotation import arc
from warpdem.kernels.sleep import dormancy, time_slow
from warpdem.kernels.variant import compiled, inlined, place
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
from warpdem.kernels.watching import watching


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
    fused: bool  # products and sums are rounded once
    sleeps: bool  # bodies at rest may sleep


def gathered(motion: Motion) -> wp.Function:
    """Function of the forces that bodies get from one another."""
    return gathering(
        contacts=motion.contacts,
        summed=motion.summed,
        braking=motion.braking,
        bonds=motion.bonds,
    )


@functools.cache
def driving(motion: Motion) -> wp.Function:
    """Function of the second and first half of a step of a body without inverse mass."""
    gather_all = gathered(motion)
    follow_drives = follow(controlled=motion.controlled, stepwise=motion.stepwise)
    watch = watching(paths=motion.paths, surfaces=motion.surfaces, turns=True, deforming=False)

    @inlined()
    def driving(
        geometry: Geometry,
        inertia: Inertia,
        lever: wide,
        dt: wide,
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
            bodies.rotation[body] = mat33(wp.quat_to_matrix(bodies.orientation[body]))
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
                bodies.spin[body],
                lever,
                wide(0.0),
                wide(0.0),
            )

    return driving


@functools.cache
def kicking(torque_of: wp.Function, forces: Forces, motion: Motion) -> wp.Function:
    """Function of the force and torque on a free body now, and what its momentum jumps by."""
    gather_all = gathered(motion)
    act = external_forces(forces)

    @inlined()
    def kicking(
        inertia: Inertia,
        gravity: wide3,
        external: External,
        dt: wide,
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        cell: Cell,
        bodies: Bodies,
        energy: Account,
        body: int,
    ):
        jump = wide3()
        force, torque = gather_all(pairs, incidence, glue, joined, bodies, body)
        weight = gravity * inertia.mass[body]
        if wp.static(forces.some):
            force, torque, power = act(inertia, external, bodies, weight, body, force, torque, dt)
            if wp.static(forces.account):
                book(energy, body, power, dt)
        else:
            force += weight
        torque = torque_of(torque, bodies.spin[body], bodies.angular_momentum[body])
        if wp.static(motion.deforming):
            # the homogeneous flow accelerates with the cell
            x = (bodies.position[body] - cell.centre[0]) * inertia.mass[body]
            force += cell.acceleration[0] * x
            jump = cell.jump[0] * x
        return force, torque, jump

    return kicking


@functools.cache
def turning(rotate: wp.Function, motion: Motion) -> wp.Function:
    """Function of the first half kick and drift of a body's turning.

    Angular momentum, spin at the half step, and how much the torque adds to it until the end.
    """

    @inlined()
    def turning(
        geometry: Geometry,
        inertia: Inertia,
        bodies: Bodies,
        body: int,
        spun: wide3,
        torque: wide3,
        dt: wide,
    ):
        half = wide(0.5) * dt
        inverse = inertia.inverse_moment[body]
        if wp.static(not motion.turns):
            kicked = spun + torque * half
            return kicked, kicked * inverse[0], torque * (half * inverse[0])
        q, turned = rotate(bodies.orientation[body], spun, torque, inertia.moment[body], dt)
        bodies.orientation[body] = q
        rotation = wp.quat_to_matrix(q)
        bodies.rotation[body] = mat33(rotation)
        place_arms(geometry, bodies, body)
        if wp.static(motion.spherical):
            return turned, turned * inverse[0], torque * (half * inverse[0])
        spin = world_inverse(rotation, inverse, turned)
        return turned, spin, world_inverse(rotation, inverse, torque * half)

    return turning


@functools.cache
def drifting(rotate: wp.Function, motion: Motion) -> wp.Function:
    """Function of the first half kick and the drift of a free body: its momenta after them."""
    turn = turning(rotate, motion)
    watch = watching(
        paths=motion.paths,
        surfaces=motion.surfaces,
        turns=motion.paths,
        deforming=motion.deforming,
    )

    @inlined()
    def drifting(
        geometry: Geometry,
        inertia: Inertia,
        lever: wide,
        dt: wide,
        cell: Cell,
        bodies: Bodies,
        clock: Clock,
        body: int,
        momentum: wide3,
        spun: wide3,
        force: wide3,
        torque: wide3,
    ):
        half = wide(0.5) * dt
        inverse_mass = inertia.inverse_mass[body]
        kicked = momentum + force * half
        velocity = kicked * inverse_mass
        bodies.velocity[body] = velocity
        bodies.position[body] = bodies.position[body] + velocity * dt
        before = bodies.spin[body]
        turned, spin, ahead = turn(geometry, inertia, bodies, body, spun, torque, dt)
        bodies.spin[body] = spin
        if wp.static(motion.predicted):
            bodies.velocity_end[body] = velocity + force * (half * inverse_mass)
        if wp.static(motion.ending_spins):
            bodies.spin_end[body] = spin + ahead
        if wp.static(motion.sleeps):
            time_slow(geometry, bodies, body, dt)
        watched = dt
        if wp.static(not motion.contacts):
            watched = wide(0.0)
        watch(geometry, bodies, cell, clock, body, velocity, before, spin, lever, dt, watched)
        return kicked, turned

    return drifting


@functools.cache
def advance(
    rotate: wp.Function, torque_of: wp.Function, forces: Forces, motion: Motion
) -> wp.Kernel:
    """Kernel of what a body does between two force passes.

    It gathers the wrenches and ends one step with the second half kick where ``kicks`` is not 0,
    and begins the next with the first half kick and the drift where ``drifts`` is not 0; ``rotate``
    is a drift of kernels.rotation.
    """
    drive = driving(motion)
    dormant = dormancy(gathered(motion))
    kick = kicking(torque_of, forces, motion)
    drift = drifting(rotate, motion)

    @compiled(fuses=motion.fused)
    def advance(
        # model
        geometry: Geometry,
        inertia: Inertia,
        gravity: wide3,
        external: External,
        # in
        lever: wide,
        dt: wide,
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
        if inertia.inverse_mass[body] == wide(0.0):
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
        momentum = bodies.momentum[body]
        spun = bodies.angular_momentum[body]
        force = wide3()
        torque = wide3()
        if kicks != 0:
            # fmt: off
            force, torque, jump = kick(
                inertia, gravity, external, dt, pairs, incidence, glue, joined, cell, bodies,
                energy, body,
            )
            # fmt: on
            momentum += jump + force * (wide(0.5) * dt)
            spun += torque * (wide(0.5) * dt)
            if drifts == 0:
                bodies.force[body] = force
                bodies.torque[body] = torque
        else:
            force = bodies.force[body]
            torque = bodies.torque[body]
        if drifts != 0:
            # fmt: off
            momentum, spun = drift(
                geometry, inertia, lever, dt, cell, bodies, clock, body, momentum, spun, force,
                torque,
            )
            # fmt: on
        bodies.momentum[body] = momentum
        bodies.angular_momentum[body] = spun

    return advance
