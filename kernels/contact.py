"""Pass 2 of the pair kernel: one sub-contact's wrench, what it remembers, its energies."""

import functools

import warp as wp
from warpdem.kernels.avalanche import axis_distance
from warpdem.kernels.codes import kind_of
from warpdem.kernels.cohesion import (
    adhesion,
    at_distance,
    at_distance_energy,
    curvature_radius,
)
from warpdem.kernels.custom import Touch
from warpdem.kernels.friction_laws import rolling_law, tangential_law
from warpdem.kernels.kinematics import Kinematics, branch, kinematics
from warpdem.kernels.laws import AVALANCHE, Laws
from warpdem.kernels.normal_laws import normal_law
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.sharing import SHARES, carried_share, passive_share
from warpdem.kernels.tangential import spun
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Geometry, Inertia, Material


@functools.cache
def attraction(laws: Laws) -> wp.Function:
    """Function of the pull of a sub-contact in overlap, and of its potential [N, J]."""

    @wp.func
    def attraction(law: Material, gap: real, radius: real, lasted: real):
        pull = real(0.0)
        energy = real(0.0)
        constant = law.fc
        if wp.static(laws.reaching):
            if law.dncut > real(0.0):
                # it was there before they touched
                constant = real(0.0)
                if wp.static(laws.documented):
                    energy = at_distance_energy(law.fc, real(0.0), law.dncut)
                else:
                    pull = law.fc
                    energy = at_distance_energy(law.fc, gap, law.dncut)
        if wp.static(laws.adhesion):
            constant += adhesion(radius, law.gamma)
        pull += constant * lasted
        return pull, energy + constant * gap

    return attraction


@functools.cache
def shared(laws: Laws) -> wp.Function:
    """Function of a sub-contact's share now, and what its tangential spring makes of it.

    Share [-], its mean over the step, the part of the force it keeps, the share before.
    """
    plain = laws.partnership == "sum"
    share_of = SHARES.get(laws.partnership)

    @inlined()
    def whole(candidates: Candidates, c: int, d: real, total: real, law: Material, fresh: bool):
        return real(1.0), real(1.0), real(1.0), real(1.0)

    @inlined()
    def moving(candidates: Candidates, c: int, d: real, total: real, law: Material, fresh: bool):
        share = share_of(d, total, law.exponent)
        before = candidates.share[c]
        if fresh:
            before = share
        candidates.share[c] = share
        mean = share
        keeps = real(1.0)
        if wp.static(laws.passive):
            mean = passive_share(before, share)
            keeps = carried_share(before, share)
        return share, mean, keeps, before

    return whole if plain else moving


@functools.cache
def normal_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's normal force: cap, acting force, part of the step, energies."""
    normal_force = normal_law(laws)
    pull_of = attraction(laws)

    @wp.func
    def normal_part(motion: Kinematics, law: Material, touch: Touch):
        fn, phi, elastic = normal_force(motion, law, touch)
        stored = real(0.0)
        lost = real(0.0)
        if wp.static(laws.account):
            stored = real(0.5) * elastic * touch.overlap
            approach = motion.approach_end
            if wp.static(laws.predicted and laws.damped):
                # as the force of this step leaves it, not the one of the last
                if touch.tau > real(0.0):
                    renewed = touch.before - fn
                    approach += renewed * touch.beta / (touch.stiffness * touch.tau)
            lost = (fn - elastic) * approach * touch.dt
        acting = fn
        fn = wp.max(fn, real(0.0))
        if wp.static(laws.cohesion):
            lasted = real(0.5) + phi
            if phi == real(1.0):
                lasted = real(1.0)
            pull, energy = pull_of(law, -touch.overlap, touch.radius, lasted)
            acting -= pull
            stored += energy
        return fn, acting, phi, stored, lost

    return normal_part


@functools.cache
def apart(laws: Laws) -> wp.Function:
    """Function of a pair of features that attract each other without touching."""

    @inlined()
    def apart(candidates: Candidates, law: Material, c: int, gap: real, normal: vec3, point: vec3):
        account = vec4()
        past = candidates.past[c]
        if wp.static(laws.account):
            account[0] = at_distance_energy(law.fc, gap, law.dncut)
            if law.kt > real(0.0):
                held = past[0] * past[0] + past[1] * past[1] + past[2] * past[2]
                if wp.static(laws.partnership != "sum"):
                    if held > real(0.0):
                        held = held / candidates.share[c]
                account[2] = held / (real(2.0) * law.kt)
            if wp.static(laws.rolling):
                if law.kr > real(0.0):
                    rolled = candidates.rolled[c]
                    account[3] = wp.dot(rolled, rolled) / (real(2.0) * law.kr)
        candidates.past[c] = vec4(real(0.0), real(0.0), real(0.0), real(-1.0))
        if wp.static(laws.rolling):
            candidates.rolled[c] = vec4()
        if wp.static(laws.avalanche):
            candidates.last[c] = gap
        force = normal * at_distance(law.fc, gap, law.dncut)
        return force, wp.cross(point, force), account

    return apart


@functools.cache
def touch_of(laws: Laws) -> wp.Function:
    """Function of what the normal laws see of a sub-contact."""

    @inlined()
    def touch_of(
        geometry: Geometry,
        inertia: Inertia,
        candidates: Candidates,
        law: Material,
        i: int,
        j: int,
        c: int,
        overlap: real,
        share: real,
        tau: real,
        beta: real,
        dt: real,
    ) -> Touch:
        touch = Touch()
        past = candidates.past[c]
        touch.overlap = overlap
        touch.share = share
        touch.stiffness = share * law.kn
        touch.before = wp.max(past[3], real(0.0))
        touch.fresh = past[3] < real(0.0)
        touch.tau = tau
        touch.beta = beta
        touch.dt = dt
        if wp.static(laws.partnership != "sum" and not laws.pair_damping):
            touch.tau = tau / wp.sqrt(share)
        if wp.static(laws.avalanche):
            touch.last = candidates.last[c]
            if wp.static(not laws.keep):
                if touch.fresh:
                    touch.last = real(0.0)
            candidates.last[c] = -overlap
        if wp.static(laws.adhesion or len(laws.custom) > 0):
            radius_i = geometry.radius[i]
            radius_j = geometry.radius[j]
            touch.radius = curvature_radius(kind_of(candidates.code[c]), radius_i, radius_j)
            touch.mass = real(1.0) / (inertia.inverse_mass[i] + inertia.inverse_mass[j])
        return touch

    return touch_of


@functools.cache
def friction_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's friction: force, energy stored, energy lost."""
    tangential_force = tangential_law(laws)

    @wp.func
    def friction_part(
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: vec4,
        cap: real,
        mean: real,
        keeps: real,
        share: real,
        before: real,
        step: real,
    ):
        """``step`` is the time it has lasted; shares as in ``shared``."""
        kept = vec4(past[0] * keeps, past[1] * keeps, past[2] * keeps, past[3])
        tangential, carried = tangential_force(motion, law, normal, kept, cap, mean * law.kt * step)
        stored = real(0.0)
        lost = real(0.0)
        if wp.static(laws.account):
            if law.kt > real(0.0):
                stored = wp.dot(tangential, tangential) / (real(2.0) * share * law.kt)
                old = carried / keeps
                had = wp.dot(old, old) / (real(2.0) * before * law.kt)
                sliding = motion.sliding
                if wp.static(laws.objective):
                    # as seen from the frame of the step's end
                    sliding = spun(sliding, normal, real(0.5) * motion.turn)
                lost = real(0.5) * wp.dot(tangential + old, sliding) * step - stored + had
        return tangential, stored, lost

    return friction_part


@functools.cache
def rolling_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's rolling moment: moment, energy stored, energy lost."""
    rolling_moment = rolling_law(laws)

    @wp.func
    def rolling_part(
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: vec4,
        rolled: vec4,
        fn: real,
        arm: real,
        mean: real,
        keeps: real,
        share: real,
        before: real,
        step: real,
    ):
        """``step`` is the time it has lasted; shares as in ``shared``."""
        moment, carried = rolling_moment(
            motion, law, normal, past, rolled * keeps, fn, arm, mean * law.kr * step
        )
        stored = real(0.0)
        lost = real(0.0)
        if wp.static(laws.account):
            stored = wp.dot(moment, moment) / (real(2.0) * share * law.kr)
            old = carried / keeps
            had = wp.dot(old, old) / (real(2.0) * before * law.kr)
            spin = motion.spin
            if wp.static(laws.objective):
                spin = spun(spin, normal, real(0.5) * motion.turn)
            lost = real(0.5) * wp.dot(moment + old, spin) * step - stored + had
        return moment, stored, lost

    return rolling_part


@functools.cache
def rolling_arm(laws: Laws) -> wp.Function:
    """Function of the length that multiplies mur in the rolling cap."""

    @inlined()
    def rolling_arm(
        inertia: Inertia, bodies: Bodies, law: Material, i: int, j: int, d: vec3, point: vec3
    ) -> real:
        arm = real(1.0)
        if wp.static(laws.branch_arm):
            arm = branch(inertia, i, j, d, point)
        if wp.static(laws.avalanche):
            if law.kind == AVALANCHE:
                if inertia.inverse_mass[i] == real(0.0):
                    arm = axis_distance(point, bodies.spin[j])
                else:
                    arm = axis_distance(point - d, bodies.spin[i])
        return arm

    return rolling_arm


@functools.cache
def apply_laws(laws: Laws) -> wp.Function:
    """Function of pass 2: the wrench of one contact, its history, its energy account."""
    motion_at = kinematics(predicted=laws.predicted)
    touch_at = touch_of(laws)
    share_at = shared(laws)
    normal_force = normal_part(laws)
    tangential_force = friction_part(laws)
    rolling_moment = rolling_part(laws)
    arm_of = rolling_arm(laws)
    attract = apart(laws)

    @inlined()
    def apply_laws(
        geometry: Geometry,
        inertia: Inertia,
        bodies: Bodies,
        candidates: Candidates,
        law: Material,
        i: int,
        j: int,
        d: vec3,
        slot: int,
        total: real,
        tau: real,
        beta: real,
        dt: real,
    ):
        c = candidates.which[slot]
        normal = candidates.normal[slot]
        point = candidates.point[slot]
        force = vec3()
        torque = vec3()
        account = vec4()
        overlap = -candidates.gap[slot]
        distant = bool(False)
        if wp.static(laws.reaching):
            distant = overlap <= real(0.0)
            if distant:
                force, torque, account = attract(candidates, law, c, -overlap, normal, point)
        if not distant:
            past = candidates.past[c]
            fresh = past[3] < real(0.0)
            share, mean, keeps, before = share_at(candidates, c, overlap, total, law, fresh)
            motion = motion_at(bodies, i, j, d, normal, point, dt)
            touch = touch_at(
                geometry, inertia, candidates, law, i, j, c, overlap, share, tau, beta, dt
            )
            fn, acting, phi, stored, lost = normal_force(motion, law, touch)
            force = normal * acting
            if wp.static(laws.account):
                account[0] = stored
                account[1] = lost
            moment = vec3()
            tangential = vec3()
            if wp.static(laws.friction):
                cap = law.mu * fn
                if wp.static(laws.elastic_cap):
                    if wp.static(laws.total_cap):
                        if law.elastic_cap != 0:
                            cap = law.mu * touch.stiffness * overlap
                    else:
                        cap = law.mu * touch.stiffness * overlap
                tangential, held, slipped = tangential_force(
                    motion, law, normal, past, cap, mean, keeps, share, before, dt * phi
                )
                force += tangential
                account[0] = account[0] + held
                account[2] = slipped
            candidates.past[c] = vec4(tangential[0], tangential[1], tangential[2], fn)
            if wp.static(laws.rolling):
                if law.kr > real(0.0):
                    arm = arm_of(inertia, bodies, law, i, j, d, point)
                    rolled = candidates.rolled[c]
                    moment, held, slipped = rolling_moment(
                        motion,
                        law,
                        normal,
                        past,
                        rolled,
                        fn,
                        arm,
                        mean,
                        keeps,
                        share,
                        before,
                        dt * phi,
                    )
                    about = real(0.0)
                    tangent = moment
                    if wp.static(laws.objective):
                        about = wp.dot(moment, normal)
                        tangent = moment - normal * about
                    candidates.rolled[c] = vec4(tangent[0], tangent[1], tangent[2], about)
                    account[0] = account[0] + held
                    account[3] = slipped
            torque = wp.cross(point, force) + moment
        return force, torque, account

    return apply_laws
