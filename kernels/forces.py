"""The pair kernel: contact wrench of each body pair, composed of the laws the scene chose.

A thread owns one body pair. Pass 1 finds the gaps and packs what touches; the pair's own frequency
follows from all of them. Pass 2 applies the laws, contact by contact, and writes the wrench once.
"""

import functools
from typing import NamedTuple

import warp as wp

from warpdem.kernels.integrate import world_inverse
from warpdem.kernels.matching import hand_over
from warpdem.kernels.narrow import feature_pair
from warpdem.kernels.normal import hooke, hooke_predicted, onset, pair_frequency
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.tangential import coulomb, follow, radial_return
from warpdem.kernels.variant import variant
from warpdem.kernels.views import (
    Account,
    Bodies,
    Candidates,
    Clock,
    Geometry,
    Inertia,
    Material,
    Pairs,
)


class Laws(NamedTuple):
    """What the contacts of a scene need; every field that is False is compiled out."""

    polyhedra: bool  # not only spheres
    convex: bool  # every face is convex
    two_sided: bool  # some open surface acts on both sides
    cones: bool  # some shape restricts the directions of its edges and vertices
    damped: bool
    pair_damping: bool  # dashpot by the pair's frequency; else by each contact's
    predicted: bool  # contact update of second order; else the velocities of the half step
    friction: bool
    elastic_cap: bool  # cap from k d instead of the whole normal force
    objective: bool  # friction follows the contact frame
    keep: bool  # friction survives an opening (Rockable)
    rolling: bool
    branch_arm: bool  # rolling cap over the branch length
    cohesion: bool
    account: bool  # energy bookkeeping


@wp.struct
class Kinematics:
    """Motion at one contact; approach and sliding are of the owner against the partner."""

    approach: real  # at the half step [m/s]
    approach_end: real  # predicted for the end of the step [m/s]
    sliding: vec3  # at the half step [m/s]
    turn: real  # angle of the frame about its normal over the step [rad]
    spin: vec3  # of the partner relative to the owner [rad/s]


@functools.cache
def kinematics(*, predicted: bool) -> wp.Function:
    """Function of the motion at a contact point."""

    @wp.func
    def kinematics(
        bodies: Bodies, i: int, j: int, d: vec3, normal: vec3, point: vec3, dt: real
    ) -> Kinematics:
        arm = point - d
        motion = Kinematics()
        relative = bodies.velocity[j] + wp.cross(bodies.spin[j], point)
        relative -= bodies.velocity[i] + wp.cross(bodies.spin[i], arm)
        motion.approach = wp.dot(relative, normal)
        motion.sliding = relative - normal * motion.approach
        motion.spin = bodies.spin[j] - bodies.spin[i]
        motion.turn = real(0.5) * dt * wp.dot(bodies.spin[i] + bodies.spin[j], normal)
        motion.approach_end = motion.approach
        if wp.static(predicted):
            end = bodies.velocity_end[j] + wp.cross(bodies.spin_end[j], point)
            end -= bodies.velocity_end[i] + wp.cross(bodies.spin_end[i], arm)
            motion.approach_end = wp.dot(end, normal)
        return motion

    return kinematics


@functools.cache
def frequency() -> wp.Function:
    """Function of the square of a pair's own frequency over its stiffness."""

    @wp.func
    def frequency(
        inertia: Inertia,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        d: vec3,
        start: int,
        touching: int,
    ) -> real:
        force = vec3()
        torque_i = vec3()
        torque_j = vec3()
        squares = real(0.0)
        for slot in range(start, start + touching):
            overlap = -candidates.gap[slot]
            f = candidates.normal[slot] * overlap
            point = candidates.point[slot]
            force += f
            torque_i += wp.cross(point - d, f)
            torque_j += wp.cross(point, f)
            squares += overlap * overlap
        spin_i = world_inverse(bodies.rotation[i], inertia.inverse_moment[i], torque_i)
        spin_j = world_inverse(bodies.rotation[j], inertia.inverse_moment[j], torque_j)
        inverse_mass = inertia.inverse_mass[i] + inertia.inverse_mass[j]
        return pair_frequency(
            force, torque_i, torque_j, spin_i, spin_j, squares, inverse_mass
        )

    return frequency


@functools.cache
def find_touching(laws: Laws) -> wp.Function:
    """Function of pass 1: packs the touching candidates of a pair, settles those that ended."""
    gap_of = feature_pair(
        polyhedra=laws.polyhedra,
        convex=laws.convex,
        two_sided=laws.two_sided,
        cones=laws.cones,
    )
    hand = hand_over(gap_of, rolling=laws.rolling)

    @wp.func
    def find_touching(
        geometry: Geometry,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        d: vec3,
        start: int,
        end: int,
        margin: real,
    ):
        touching = int(0)
        ended = int(0)
        freed = real(0.0)
        unrolled = real(0.0)
        for c in range(start, end):
            hit = gap_of(geometry, bodies, i, j, d, margin, candidates.code[c])
            past = candidates.past[c]
            if hit.gap < real(0.0) and hit.admissible:
                slot = start + touching
                candidates.which[slot] = c
                candidates.normal[slot] = hit.normal
                candidates.point[slot] = hit.point
                candidates.gap[slot] = hit.gap
                touching += 1
            elif past[3] >= real(0.0):
                if wp.static(laws.keep):
                    if not hit.admissible or hit.gap >= margin:
                        candidates.past[c] = vec4(real(0.0), real(0.0), real(0.0), real(-1.0))
                        if wp.static(laws.rolling):
                            candidates.rolled[c] = vec4()
                elif hit.gap < real(0.0):
                    candidates.past[c] = vec4(past[0], past[1], past[2], real(-2.0) - past[3])
                    ended += 1
                else:
                    if wp.static(laws.account):
                        freed += past[0] * past[0] + past[1] * past[1] + past[2] * past[2]
                    candidates.past[c] = vec4(real(0.0), real(0.0), real(0.0), real(-1.0))
                    if wp.static(laws.rolling):
                        rolled = candidates.rolled[c]
                        unrolled += wp.dot(rolled, rolled)
                        candidates.rolled[c] = vec4()
        if ended > 0:
            hand(geometry, bodies, candidates, i, j, d, start, end, touching)
        return touching, freed, unrolled

    return find_touching


@functools.cache
def normal_law(laws: Laws) -> wp.Function:
    """Function of the normal force: stored fn, and its part that acts on the bodies [N]."""

    @wp.func
    def lasting(motion: Kinematics, k: real, d: real, tau: real, beta: real, fn_old: real, dt: real):
        fn = hooke(k, d, tau, motion.approach)
        return fn, fn, real(1.0)

    @wp.func
    def predicted(
        motion: Kinematics, k: real, d: real, tau: real, beta: real, fn_old: real, dt: real
    ):
        fn = hooke_predicted(k, d, tau, motion.approach_end, beta, wp.max(fn_old, real(0.0)))
        phi = real(1.0)
        if fn_old < real(0.0):
            phi = onset(d, motion.approach, dt)
        if phi == real(1.0):
            return fn, fn, phi
        # the dashpot acts for phi dt before and dt / 2 after this instant
        free = (k * (d + tau * motion.approach_end)) / (real(1.0) + beta)
        acting = wp.max(k * d + (real(0.5) + phi) * (free - k * d), real(0.0))
        return fn, acting, phi

    return predicted if laws.predicted else lasting


@functools.cache
def tangential_law(laws: Laws) -> wp.Function:
    """Function of the frictional force carried to this step [N], and where it came from."""

    @wp.func
    def objective(
        motion: Kinematics, law: Material, normal: vec3, past: vec4, cap: real, step: real
    ):
        old = vec3(past[0], past[1], past[2])
        start = follow(old, normal, motion.turn)
        limit = law.mu * wp.max(past[3], real(0.0))
        if wp.static(laws.elastic_cap or not laws.predicted):
            return radial_return(start + motion.sliding * step, cap), start
        slid = past[3] >= real(0.0) and wp.length(old) >= (real(1.0) - real(1.0e-9)) * limit
        return coulomb(start, motion.sliding, step, cap, limit, slid), start

    @wp.func
    def fixed(motion: Kinematics, law: Material, normal: vec3, past: vec4, cap: real, step: real):
        start = vec3(past[0], past[1], past[2])
        return radial_return(start + motion.sliding * step, cap), start

    return objective if laws.objective else fixed


@functools.cache
def rolling_law(laws: Laws) -> wp.Function:
    """Function of the rolling moment: tangent vector and part about the normal [N m]."""

    @wp.func
    def objective(
        motion: Kinematics, law: Material, normal: vec3, past: vec4, rolled: vec4,
        fn: real, arm: real, step: real,
    ):
        tangent = follow(vec3(rolled[0], rolled[1], rolled[2]), normal, motion.turn)
        start = tangent + normal * rolled[3]
        cap = law.mur * arm * fn
        limit = law.mur * arm * wp.max(past[3], real(0.0))
        if wp.static(not laws.predicted):
            return radial_return(start + motion.spin * step, cap), start
        slid = past[3] >= real(0.0) and wp.length(start) >= (real(1.0) - real(1.0e-9)) * limit
        return coulomb(start, motion.spin, step, cap, limit, slid), start

    @wp.func
    def fixed(
        motion: Kinematics, law: Material, normal: vec3, past: vec4, rolled: vec4,
        fn: real, arm: real, step: real,
    ):
        # unrotated: the whole vector is kept, its fourth number stays zero
        start = vec3(rolled[0], rolled[1], rolled[2])
        return radial_return(start + motion.spin * step, law.mur * arm * fn), start

    return objective if laws.objective else fixed


@wp.func
def branch(inertia: Inertia, i: int, j: int, d: vec3, point: vec3) -> real:
    """Branch length: between two free bodies their centres, else from the free one to the contact."""
    if inertia.inverse_mass[i] == real(0.0):
        return wp.length(point)
    if inertia.inverse_mass[j] == real(0.0):
        return wp.length(point - d)
    return wp.length(d)


@functools.cache
def apply_laws(laws: Laws) -> wp.Function:
    """Function of pass 2: the wrench of one touching contact, its history, its energy account."""
    motion_at = kinematics(predicted=laws.predicted)
    normal_force = normal_law(laws)
    tangential_force = tangential_law(laws)
    rolling_moment = rolling_law(laws)

    @wp.func
    def apply_laws(
        inertia: Inertia, bodies: Bodies, candidates: Candidates, law: Material,
        i: int, j: int, d: vec3, slot: int, tau: real, beta: real, dt: real,
    ):
        c = candidates.which[slot]
        normal = candidates.normal[slot]
        point = candidates.point[slot]
        overlap = -candidates.gap[slot]
        past = candidates.past[c]
        motion = motion_at(bodies, i, j, d, normal, point, dt)
        fn, acting, phi = normal_force(motion, law.kn, overlap, tau, beta, past[3], dt)
        lasted = real(0.5) + phi
        if phi == real(1.0):
            lasted = real(1.0)
        account = vec4()
        if wp.static(laws.account):
            elastic = law.kn * overlap
            account[0] = real(0.5) * elastic * overlap
            account[1] = (acting - elastic) * motion.approach_end * dt
        if wp.static(laws.cohesion):
            acting -= law.fc * lasted
            if wp.static(laws.account):
                account[0] = account[0] - law.fc * overlap
        force = normal * acting
        moment = vec3()
        tangential = vec3()
        if wp.static(laws.friction):
            cap = law.mu * fn
            if wp.static(laws.elastic_cap):
                cap = law.mu * law.kn * overlap
            step = law.kt * dt * phi
            tangential, carried = tangential_force(motion, law, normal, past, cap, step)
            force += tangential
            if wp.static(laws.account):
                if law.kt > real(0.0):
                    stored = wp.dot(tangential, tangential) / (real(2.0) * law.kt)
                    before = wp.dot(carried, carried) / (real(2.0) * law.kt)
                    mean = real(0.5) * (tangential + carried)
                    account[0] = account[0] + stored
                    account[2] = wp.dot(mean, motion.sliding) * dt * phi - stored + before
        candidates.past[c] = vec4(tangential[0], tangential[1], tangential[2], fn)
        if wp.static(laws.rolling):
            if law.kr > real(0.0):
                arm = real(1.0)
                if wp.static(laws.branch_arm):
                    arm = branch(inertia, i, j, d, point)
                step = law.kr * dt * phi
                rolled = candidates.rolled[c]
                moment, carried = rolling_moment(motion, law, normal, past, rolled, fn, arm, step)
                about = real(0.0)
                tangent = moment
                if wp.static(laws.objective):
                    about = wp.dot(moment, normal)
                    tangent = moment - normal * about
                candidates.rolled[c] = vec4(tangent[0], tangent[1], tangent[2], about)
                if wp.static(laws.account):
                    stored = wp.dot(moment, moment) / (real(2.0) * law.kr)
                    before = wp.dot(carried, carried) / (real(2.0) * law.kr)
                    mean = real(0.5) * (moment + carried)
                    account[0] = account[0] + stored
                    account[3] = wp.dot(mean, motion.spin) * dt * phi - stored + before
        return force, wp.cross(point, force) + moment, account

    return apply_laws


@functools.cache
def pair_forces(laws: Laws) -> wp.Kernel:
    """Kernel of the contact wrench of each body pair."""
    find = find_touching(laws)
    apply = apply_laws(laws)
    frequency_of = frequency()

    @variant
    def pair_forces(
        # model
        geometry: Geometry,
        inertia: Inertia,
        materials: wp.array(dtype=Material),
        # in
        dt: real,
        margin: real,
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        clock: Clock,
        # in and out
        pairs: Pairs,
        candidates: Candidates,
        # out
        energy: Account,
    ):
        pair = wp.tid() + span[0]
        if pair >= span[1] or clock.halted[0] != 0:
            return
        start = pairs.start[pair]
        end = pairs.start[pair + 1]
        if start == end:
            return
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        d = bodies.position[i] - bodies.position[j]
        touching, freed, unrolled = find(
            geometry, bodies, candidates, i, j, d, start, end, margin
        )
        pairs.touching[pair] = touching
        law = materials[pairs.material[pair]]
        account = vec4()
        if wp.static(laws.account):
            if freed > real(0.0):
                account[2] = freed / (real(2.0) * law.kt)
            if unrolled > real(0.0):
                account[3] = unrolled / (real(2.0) * law.kr)
        force = vec3()
        torque = vec3()
        if touching > 0:
            tau = real(0.0)
            beta = real(0.0)
            if wp.static(laws.damped):
                inverse_mass = inertia.inverse_mass[i] + inertia.inverse_mass[j]
                square = inverse_mass
                if wp.static(laws.pair_damping or laws.predicted):
                    square = frequency_of(
                        inertia, bodies, candidates, i, j, d, start, touching
                    )
                omega = wp.sqrt(law.kn * square)
                tau = real(2.0) * law.zeta / omega
                beta = law.zeta * omega * dt
                if wp.static(not laws.pair_damping):
                    tau = real(2.0) * law.zeta / wp.sqrt(law.kn * inverse_mass)
                    beta = real(0.5) * dt * tau * omega * omega
            for slot in range(start, start + touching):
                f, t, a = apply(
                    inertia, bodies, candidates, law, i, j, d, slot, tau, beta, dt
                )
                force += f
                torque += t
                account += a
        pairs.force[pair] = force
        pairs.torque[pair] = torque - wp.cross(d, force)
        pairs.torque_partner[pair] = -torque
        if wp.static(laws.account):
            since = energy.pair[pair]
            energy.pair[pair] = vec4(
                account[0], since[1] + account[1], since[2] + account[2], since[3] + account[3]
            )

    return pair_forces
