"""The bond kernel: wrench of each interface, and whether it breaks; one thread an interface.

A bond is a feature pair that keeps together wherever its foot goes; gap, normal and point are those
of a contact. What breaks acts for the last time in this step; kernels.release then hands it over.
"""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.bonding import (
    ENERGY,
    YIELDED,
    cracking,
    glued,
    glued_across,
    implicit_share,
    leading,
    yielding,
)
from warpdem.kernels.narrow import FAR, Hit, feature_pair
from warpdem.kernels.precision import wide, wide3, wide4
from warpdem.kernels.tangential import laid, spun
from warpdem.kernels.variant import inlined, variant
from warpdem.kernels.views import Bodies, BondLaw, Bonds, Clock, Geometry


class BondLaws(NamedTuple):
    """What the bonds of a scene need; every field that is False is compiled out."""

    polyhedra: bool  # not only spheres
    convex: bool  # every face is convex
    two_sided: bool  # some open surface acts on both sides
    predicted: bool  # dashpots see the velocity of the step's end
    objective: bool  # forces follow the frame of the bond
    damping: bool
    moments: bool  # bonds resist bending and twisting
    creep: bool  # the tangential dashpot's force is accumulated (Rockable)


@wp.struct
class Stretch:
    """Motion at a bond: of the partner against the owner, at the half step and at its end."""

    velocity: wide3
    velocity_end: wide3
    spin: wide3
    middle: wide3  # normal at the half step
    turn: wide  # half the angle of the frame about its normal over the step [rad]


@wp.struct
class Share:
    """What a bond adds to its interface."""

    force: wide3
    torque: wide3  # about the partner's centre
    stretched: wide  # elastic energy of a bond in tension [J]
    sheared: wide
    elastic: wide
    rate: wide  # of the elastic energy [W]
    lost: wide  # in the dashpots [W]
    excess: wide  # beyond the yield surface
    mode: int


@functools.cache
def stretching(*, predicted: bool) -> wp.Function:
    """Function of the motion at a bond; where ``predicted``, the half step's has its own arms."""

    @inlined()
    def stretching(
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        normal: wide3,
        point: wide3,
        old_normal: wide3,
        old_point: wide3,
        dt: wide,
    ) -> Stretch:
        motion = Stretch()
        motion.middle = normal
        p = point
        arm = point - d
        if wp.static(predicted):
            if dt > wide(0.0):
                motion.middle = wp.normalize(normal + old_normal)
                p = (point + old_point) * wide(0.5)
                moved = bodies.velocity[i] - bodies.velocity[j]
                arm = p - d + moved * (wide(0.5) * dt)
        motion.velocity = bodies.velocity[j] + wp.cross(bodies.spin[j], p)
        motion.velocity -= bodies.velocity[i] + wp.cross(bodies.spin[i], arm)
        motion.velocity_end = motion.velocity
        if wp.static(predicted):
            motion.velocity_end = bodies.velocity_end[j] + wp.cross(bodies.spin_end[j], point)
            motion.velocity_end -= bodies.velocity_end[i]
            motion.velocity_end -= wp.cross(bodies.spin_end[i], point - d)
        motion.spin = bodies.spin[j] - bodies.spin[i]
        motion.turn = wide(0.25) * dt * wp.dot(bodies.spin[i] + bodies.spin[j], motion.middle)
        return motion

    return stretching


@functools.cache
def bend(laws: BondLaws) -> wp.Function:
    """Function of a bond's moment [N m], remembered in the bond."""

    @inlined()
    def bend(bonds: Bonds, bond: int, normal: wide3, motion: Stretch, step: wide) -> wide3:
        bent = bonds.bent[bond]
        moment = wide3(bent[0], bent[1], bent[2])
        if wp.static(laws.objective):
            middle = motion.middle
            moment = spun(laid(moment, middle), middle, motion.turn) + middle * bent[3]
            moment += motion.spin * step
            about = wp.dot(moment, middle)
            flat = laid(spun(moment - middle * about, middle, motion.turn), normal)
            moment = flat + normal * about
            bonds.bent[bond] = wide4(flat[0], flat[1], flat[2], about)
        else:
            moment += motion.spin * step
            bonds.bent[bond] = wide4(moment[0], moment[1], moment[2], wide(0.0))
        return moment

    return bend


@functools.cache
def apply_bond(laws: BondLaws) -> wp.Function:
    """Function of one bond: its wrench, its energies and how far it is from yielding."""
    motion_at = stretching(predicted=laws.predicted)
    moment_of = bend(laws)

    @inlined()
    def apply_bond(
        bodies: Bodies,
        bonds: Bonds,
        law: BondLaw,
        i: int,
        j: int,
        d: wide3,
        bond: int,
        hit: Hit,
        beta: wide,
        dt: wide,
    ) -> Share:
        share = Share()
        n = wide3(hit.normal)
        point = wide3(hit.point)
        gap = wide(hit.gap)
        motion = motion_at(bodies, i, j, d, n, point, bonds.normal[bond], bonds.point[bond], dt)
        middle = motion.middle
        sliding = motion.velocity - middle * wp.dot(motion.velocity, middle)
        approach_end = wp.dot(motion.velocity_end, n)
        sliding_end = motion.velocity_end - n * approach_end
        held = bonds.held[bond]
        before = wide3(held[0], held[1], held[2])
        pull = gap - bonds.rest[bond]
        fe = -law.kn * pull
        cn = law.kn * law.tau
        fn = fe
        if wp.static(laws.damping):
            fn = glued(fe, cn, approach_end, beta, held[3])
            if cn > wide(0.0):
                approach_end += (held[3] - fn) * beta / cn
            share.lost += (fn - fe) * approach_end
        elastic = before
        if wp.static(laws.objective):
            start = spun(laid(before, middle), middle, motion.turn)
            elastic = spun(start + sliding * (law.kt * dt), middle, motion.turn)
            elastic = laid(elastic, n)
        else:
            elastic = before + sliding * (law.kt * dt)
        ft = elastic
        if wp.static(laws.damping):
            if wp.static(laws.creep):
                elastic += sliding * cn
                ft = elastic
            else:
                old = laid(before + bonds.viscous[bond], n)
                ft = glued_across(elastic, cn, sliding_end, beta, old)
                if cn > wide(0.0):
                    sliding_end += (old - ft) * (beta / cn)
                share.lost += wp.dot(ft - elastic, sliding_end)
                bonds.viscous[bond] = ft - elastic
        moment = wide3()
        if wp.static(laws.moments):
            if law.kr > wide(0.0):
                moment = moment_of(bonds, bond, n, motion, law.kr * dt)
                share.elastic += wp.dot(moment, moment) / (wide(2.0) * law.kr)
                share.rate += wp.dot(moment, motion.spin)
        bonds.held[bond] = wide4(elastic[0], elastic[1], elastic[2], fn)
        bonds.normal[bond] = n
        bonds.point[bond] = point
        bonds.gap[bond] = gap
        share.force = n * fn + ft
        share.torque = wp.cross(point, share.force) + moment
        stored = wide(0.5) * law.kn * pull * pull
        if pull > wide(0.0):
            share.stretched = stored
        if law.kt > wide(0.0):
            share.sheared = wp.dot(elastic, elastic) / (wide(2.0) * law.kt)
        share.elastic += stored + share.sheared
        share.rate += fe * approach_end + wp.dot(elastic, sliding_end)
        t = wp.length(ft)
        m = wp.length(moment)
        share.excess = yielding(fn, t, m, law.fn0, law.ft0, law.m0, law.power)
        share.mode = leading(fn, t, m, law.fn0, law.ft0, law.m0, law.power)
        return share

    return apply_bond


@functools.cache
def bond_forces(laws: BondLaws) -> wp.Kernel:
    """Kernel of the wrench of each interface."""
    gap_of = feature_pair(
        polyhedra=laws.polyhedra,
        convex=laws.convex,
        two_sided=laws.two_sided,
        cones=False,
        surfaces=False,
    )
    apply = apply_bond(laws)

    @variant
    def bond_forces(
        # model
        geometry: Geometry,
        # in
        dt: wide,
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        # in and out
        clock: Clock,
        bonds: Bonds,
    ):
        k = wp.tid() + span[0]
        if k >= span[1] or clock.halted[0] != 0:
            return
        if bonds.state[k] == 0:
            return
        i = bonds.owner[k]
        j = bonds.partner[k]
        d = bodies.position[i] - bodies.position[j]
        law = bonds.law[k]
        beta = implicit_share(law.rate, law.decay, dt)
        if law.rate == wide(0.0) or dt == wide(0.0):
            beta = wide(0.0)
        force = wide3()
        torque = wide3()
        energy = bonds.energy[k]
        elastic = wide(0.0)
        rate = wide(0.0)
        stretched = wide(0.0)
        sheared = wide(0.0)
        power = wide(0.0)
        excess = wide(0.0)
        mode = int(0)
        for bond in range(bonds.start[k], bonds.start[k + 1]):
            hit = gap_of(geometry, bodies, i, j, d, FAR, True, bonds.code[bond])
            # edges that have become parallel have no closest points: no force while they are so
            if hit.gap < FAR:
                share = apply(bodies, bonds, law, i, j, d, bond, hit, beta, dt)
                force += share.force
                torque += share.torque
                elastic += share.elastic
                rate += share.rate
                stretched += share.stretched
                sheared += share.sheared
                power += share.lost
                if share.excess > excess:
                    excess = share.excess
                    mode = share.mode
        bonds.force[k] = force
        bonds.torque[k] = torque - wp.cross(d, force)
        bonds.torque_partner[k] = -torque
        energy[0] = elastic
        energy[1] = rate
        energy[2] = energy[2] + wide(0.5) * dt * (bonds.power[k] + power)
        bonds.energy[k] = energy
        bonds.power[k] = power
        if mode == 0:
            if cracking(stretched, sheared, law.stretching, law.shearing, law.both):
                mode = ENERGY
        if mode != 0 and bonds.state[k] != YIELDED:
            bonds.state[k] = YIELDED
            bonds.mode[k] = mode
            clock.moved[0] = 1

    return bond_forces
