"""Pass 2 of the pair kernel: one sub-contact's wrench, what it remembers, its energies."""

import functools

import warp as wp
from warpdem.kernels.attraction import apart, attraction
from warpdem.kernels.avalanche import axis_distance
from warpdem.kernels.codes import kind_of
from warpdem.kernels.cohesion import curvature_radius
from warpdem.kernels.custom import Touch
from warpdem.kernels.friction_laws import rolling_law, tangential_law
from warpdem.kernels.kinematics import Flow, Kinematics, branch, kinematics
from warpdem.kernels.laws import AVALANCHE, Laws
from warpdem.kernels.normal_laws import normal_law
from warpdem.kernels.precision import real, vec3, wide, wide3, wide4
from warpdem.kernels.sharing import SHARES, carried_share, passive_share
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Geometry, Inertia, Material


@functools.cache
def shared(laws: Laws) -> wp.Function:
    """Function of a sub-contact's share now, and what its tangential spring makes of it.

    Share of kn [-]; share of kt, its mean over the step, the part of the force it keeps, the share
    before.
    """
    share_of = SHARES.get(laws.partnership)

    @inlined()
    def whole(candidates: Candidates, c: int, d: real, total: real, law: Material, fresh: bool):
        return real(1.0), real(1.0), real(1.0), real(1.0), real(1.0)

    @inlined()
    def counted(candidates: Candidates, c: int, d: real, total: real, law: Material, fresh: bool):
        # the cap alone makes friction follow the share: its spring keeps what it has
        return candidates.share[c], real(1.0), real(1.0), real(1.0), real(1.0)

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
        return share, share, mean, keeps, before

    if laws.once:
        return counted
    return moving if laws.moving else whole


@functools.cache
def normal_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's normal force.

    What friction sees of it, the acting force [N], the part of the step, the energy stored [J] and
    the power lost [W].
    """
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
                stiffness = touch.stiffness
                if wp.static(laws.once):
                    stiffness = law.kn  # shares go to zero
                if touch.tau > real(0.0):
                    renewed = touch.before - fn
                    approach += renewed * touch.beta / (stiffness * touch.tau)
            lost = (fn - elastic) * approach
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
        touch.before = real(wp.max(past[3], wide(0.0)))
        touch.fresh = past[3] < wide(0.0)
        touch.tau = tau
        touch.beta = beta
        touch.dt = dt
        if wp.static(laws.moving and not laws.pair_damping):
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
            touch.mass = real(wide(1.0) / (inertia.inverse_mass[i] + inertia.inverse_mass[j]))
        return touch

    return touch_of


@wp.func
def spring_account(
    now: wide3, carried: wide3, rate: vec3, keeps: real, share: real, before: real, stiffness: real
):
    """Energies of a tangential or rolling spring now and before [J], and the power it takes [W].

    ``carried`` is what it kept of the last step, ``rate`` the velocity it works against at the
    step's end; shares as in ``shared``.
    """
    stored = wide(0.0)
    had = wide(0.0)
    if stiffness > real(0.0):
        old = carried / wide(keeps)
        stored = wp.dot(now, now) / wide(real(2.0) * share * stiffness)
        had = wp.dot(old, old) / wide(real(2.0) * before * stiffness)
    return stored, had, wp.dot(now, wide3(rate))


@functools.cache
def friction_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's friction: force, energy stored now and before, power taken."""
    tangential_force = tangential_law(laws)

    @wp.func
    def friction_part(
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: wide4,
        cap: wide,
        mean: real,
        keeps: real,
        share: real,
        before: real,
        step: real,
    ):
        """``step`` is the time it has lasted; shares as in ``shared``."""
        part = wide(keeps)
        kept = wide4(past[0] * part, past[1] * part, past[2] * part, past[3])
        tangential, carried = tangential_force(
            motion, law, wide3(normal), kept, cap, wide(mean * law.kt * step)
        )
        stored = wide(0.0)
        had = wide(0.0)
        power = wide(0.0)
        if wp.static(laws.account):
            stored, had, power = spring_account(
                tangential, carried, motion.sliding_end, keeps, share, before, law.kt
            )
        return tangential, stored, had, power

    return friction_part


@functools.cache
def rolling_part(laws: Laws) -> wp.Function:
    """Function of a sub-contact's rolling moment: it, energy stored now and before, power."""
    rolling_moment = rolling_law(laws)

    @wp.func
    def rolling_part(
        motion: Kinematics,
        law: Material,
        normal: vec3,
        past: wide4,
        rolled: wide4,
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
            motion,
            law,
            wide3(normal),
            past,
            rolled * wide(keeps),
            wide(fn),
            wide(arm),
            wide(mean * law.kr * step),
        )
        stored = wide(0.0)
        had = wide(0.0)
        power = wide(0.0)
        if wp.static(laws.account):
            stored, had, power = spring_account(
                moment, carried, motion.spin_end, keeps, share, before, law.kr
            )
        return moment, stored, had, power

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
                if inertia.inverse_mass[i] == wide(0.0):
                    arm = axis_distance(point, vec3(bodies.spin[j]))
                else:
                    arm = axis_distance(point - d, vec3(bodies.spin[i]))
        return arm

    return rolling_arm


@functools.cache
def apply_laws(laws: Laws) -> wp.Function:
    """Function of pass 2: the wrench of one contact, its history, its energy account.

    The account holds the energy stored, and what dashpot, friction and rolling have lost since the
    last step but for the powers [W] that go with it: those act for the step.
    """
    motion_at = kinematics(predicted=laws.predicted, deforming=laws.deforming, central=laws.central)
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
        flow: Flow,
        i: int,
        j: int,
        d: vec3,
        c: int,
        normal: vec3,
        point: vec3,
        overlap: real,
        total: real,
        tau: real,
        beta: real,
        dt: real,
    ):
        force = vec3()
        torque = vec3()
        account = wide4()
        power = wide4()
        distant = bool(False)
        if wp.static(laws.reaching or laws.sticky):
            distant = overlap <= real(0.0)
            if distant:
                motion = motion_at(bodies, flow, i, j, d, normal, point, dt)
                pull, account = attract(geometry, candidates, law, i, j, c, -overlap, motion, dt)
                force = -normal * pull
                torque = wp.cross(point, force)
        if not distant:
            past = candidates.past[c]
            fresh = past[3] < wide(0.0)
            share, held_by, mean, keeps, before = share_at(
                candidates, c, overlap, total, law, fresh
            )
            motion = motion_at(bodies, flow, i, j, d, normal, point, dt)
            touch = touch_at(
                geometry, inertia, candidates, law, i, j, c, overlap, share, tau, beta, dt
            )
            fn, acting, phi, stored, lost = normal_force(motion, law, touch)
            force = normal * acting
            if wp.static(laws.account):
                account[0] = wide(stored)
                power[1] = wide(lost)
            moment = vec3()
            tangential = wide3()
            if wp.static(laws.friction):
                cap = wide(law.mu) * wide(fn)
                if wp.static(laws.elastic_cap):
                    if wp.static(laws.total_cap):
                        if law.elastic_cap != 0:
                            cap = wide(law.mu * touch.stiffness * overlap)
                    else:
                        cap = wide(law.mu * touch.stiffness * overlap)
                tangential, held, had, taken = tangential_force(
                    motion, law, normal, past, cap, mean, keeps, held_by, before, dt * phi
                )
                force += vec3(tangential)
                account[0] = account[0] + held
                account[2] = had - held
                power[2] = taken
            candidates.past[c] = wide4(tangential[0], tangential[1], tangential[2], wide(fn))
            if wp.static(laws.rolling):
                if law.kr > real(0.0):
                    arm = arm_of(inertia, bodies, law, i, j, d, point)
                    rolled = candidates.rolled[c]
                    turned, held, had, taken = rolling_moment(
                        motion,
                        law,
                        normal,
                        past,
                        rolled,
                        fn,
                        arm,
                        mean,
                        keeps,
                        held_by,
                        before,
                        dt * phi,
                    )
                    about = wide(0.0)
                    tangent = turned
                    if wp.static(laws.objective):
                        about = wp.dot(turned, wide3(normal))
                        tangent = turned - wide3(normal) * about
                    moment = vec3(turned)
                    candidates.rolled[c] = wide4(tangent[0], tangent[1], tangent[2], about)
                    account[0] = account[0] + held
                    account[3] = had - held
                    power[3] = taken
            torque = wp.cross(point, force) + moment
        return force, torque, account, power

    return apply_laws
