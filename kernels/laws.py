"""The contact laws of a scene, composed of the small laws of normal.py and tangential.py."""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.kinematics import Flow, Kinematics, branch, kinematics
from warpdem.kernels.normal import hooke, hooke_predicted, onset
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.tangential import SLID, coulomb, laid, radial_return, spun
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Inertia, Material


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
    periodic: bool  # pairs with images
    deforming: bool  # images that move against one another
    account: bool  # energy bookkeeping


@functools.cache
def normal_law(laws: Laws) -> wp.Function:
    """Function of the normal force [N], and of the part of the step for which it was there."""

    @wp.func
    def lagged(motion: Kinematics, k: real, d: real, tau: real, beta: real, fn_old: real, dt: real):
        return hooke(k, d, tau, motion.approach), real(1.0)

    @wp.func
    def predicted(
        motion: Kinematics, k: real, d: real, tau: real, beta: real, fn_old: real, dt: real
    ):
        fn = hooke_predicted(k, d, tau, motion.approach_end, beta, wp.max(fn_old, real(0.0)))
        phi = real(1.0)
        if fn_old < real(0.0):
            phi = onset(d, motion.approach, dt)
        if phi < real(1.0):
            # the dashpot acts for phi dt before and dt / 2 after this instant; friction and the
            # next prediction see the same force, or their impulses are of first order
            free = (k * (d + tau * motion.approach_end)) / (real(1.0) + beta)
            fn = wp.max(k * d + (real(0.5) + phi) * (free - k * d), real(0.0))
        return fn, phi

    return predicted if laws.predicted else lagged


@functools.cache
def tangential_law(laws: Laws) -> wp.Function:
    """Function of the frictional force carried to this step [N], and where it came from."""

    @wp.func
    def objective(
        motion: Kinematics, law: Material, normal: vec3, past: vec4, cap: real, step: real
    ):
        # half of the spin before and half after: second order also while slip turns
        half = real(0.5) * motion.turn
        old = vec3(past[0], past[1], past[2])
        start = spun(laid(old, normal), normal, half)
        limit = law.mu * wp.max(past[3], real(0.0))
        if wp.static(laws.elastic_cap or not laws.predicted):
            force = radial_return(start + motion.sliding * step, cap)
            return spun(force, normal, half), spun(start, normal, half)
        slid = past[3] >= real(0.0) and wp.length(old) >= SLID * limit
        force = coulomb(start, motion.sliding, step, cap, limit, slid)
        return spun(force, normal, half), spun(start, normal, half)

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
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: vec4,
        rolled: vec4,
        fn: real,
        arm: real,
        step: real,
    ):
        half = real(0.5) * motion.turn
        tangent = laid(vec3(rolled[0], rolled[1], rolled[2]), normal)
        start = spun(tangent, normal, half) + normal * rolled[3]
        cap = law.mur * arm * fn
        limit = law.mur * arm * wp.max(past[3], real(0.0))
        if wp.static(not laws.predicted):
            moment = radial_return(start + motion.spin * step, cap)
            return spun(moment, normal, half), spun(start, normal, half)
        slid = past[3] >= real(0.0) and wp.length(start) >= SLID * limit
        moment = coulomb(start, motion.spin, step, cap, limit, slid)
        return spun(moment, normal, half), spun(start, normal, half)

    @wp.func
    def fixed(
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: vec4,
        rolled: vec4,
        fn: real,
        arm: real,
        step: real,
    ):
        # unrotated: the whole vector is kept, its fourth number stays zero
        start = vec3(rolled[0], rolled[1], rolled[2])
        return radial_return(start + motion.spin * step, law.mur * arm * fn), start

    return objective if laws.objective else fixed


@functools.cache
def apply_laws(laws: Laws) -> wp.Function:
    """Function of pass 2: the wrench of one touching contact, its history, its energy account."""
    motion_at = kinematics(predicted=laws.predicted, deforming=laws.deforming)
    normal_force = normal_law(laws)
    tangential_force = tangential_law(laws)
    rolling_moment = rolling_law(laws)

    @inlined()
    def apply_laws(
        inertia: Inertia,
        bodies: Bodies,
        candidates: Candidates,
        law: Material,
        flow: Flow,
        i: int,
        j: int,
        d: vec3,
        slot: int,
        tau: real,
        beta: real,
        dt: real,
    ):
        c = candidates.which[slot]
        normal = candidates.normal[slot]
        point = candidates.point[slot]
        overlap = -candidates.gap[slot]
        past = candidates.past[c]
        motion = motion_at(bodies, flow, i, j, d, normal, point, dt)
        fn, phi = normal_force(motion, law.kn, overlap, tau, beta, past[3], dt)
        lasted = real(0.5) + phi
        if phi == real(1.0):
            lasted = real(1.0)
        account = vec4()
        if wp.static(laws.account):
            elastic = law.kn * overlap
            account[0] = real(0.5) * elastic * overlap
            approach = motion.approach_end
            if wp.static(laws.predicted and laws.damped):
                # as the force of this step leaves it, not the one of the last
                if tau > real(0.0):
                    renewed = wp.max(past[3], real(0.0)) - fn
                    approach += renewed * beta / (law.kn * tau)
            account[1] = (fn - elastic) * approach * dt
        acting = fn
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
                    sliding = motion.sliding
                    if wp.static(laws.objective):
                        # as seen from the frame of the step's end
                        sliding = spun(sliding, normal, real(0.5) * motion.turn)
                    account[2] = wp.dot(mean, sliding) * dt * phi - stored + before
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
                    spin = motion.spin
                    if wp.static(laws.objective):
                        spin = spun(spin, normal, real(0.5) * motion.turn)
                    account[3] = wp.dot(mean, spin) * dt * phi - stored + before
        return force, wp.cross(point, force) + moment, account

    return apply_laws
