"""The normal force of a scene's contacts, composed of the laws its pairs of groups have.

Each gives the force [N] before any constant attraction, the part of the step for which the contact
was there, and its elastic part [N]: the stored energy is half of that times the overlap.
"""

import functools

import warp as wp
from warpdem.kernels.avalanche import avalanche
from warpdem.kernels.cohesion import documented
from warpdem.kernels.custom import Parameters, Touch
from warpdem.kernels.kinematics import Kinematics
from warpdem.kernels.laws import AVALANCHE, CUSTOM, Laws
from warpdem.kernels.normal import hooke, onset, predicted_force
from warpdem.kernels.precision import real
from warpdem.kernels.variant import variant
from warpdem.kernels.views import Material


@functools.cache
def normal_law(laws: Laws) -> wp.Function:
    """Function of the normal force [N], the part of the step, and the elastic part [N]."""
    choices = []
    if laws.hooke:
        choices.append((0, _hooke(laws)))
    if laws.avalanche:
        choices.append((AVALANCHE, _avalanche(laws)))
    for number, law in enumerate(laws.custom):
        choices.append((CUSTOM + number, _custom(law, laws)))
    chosen = choices[0][1]
    for kind, law in choices[1:]:
        chosen = _either(kind, law, chosen)
    return chosen


def _either(kind: int, law: wp.Function, other: wp.Function) -> wp.Function:
    """Function that asks the pair's material which of two laws it has."""

    @wp.func
    def either(motion: Kinematics, material: Material, touch: Touch):
        fn = real(0.0)
        phi = real(1.0)
        elastic = real(0.0)
        if material.kind == wp.static(kind):
            fn, phi, elastic = law(motion, material, touch)
        else:
            fn, phi, elastic = other(motion, material, touch)
        return fn, phi, elastic

    return either


def _part(laws: Laws) -> wp.Function:
    """Function of the part of the step for which a contact was there."""

    @wp.func
    def whole(motion: Kinematics, touch: Touch) -> real:
        return real(1.0)

    @wp.func
    def since_onset(motion: Kinematics, touch: Touch) -> real:
        phi = real(1.0)
        if touch.fresh:
            phi = onset(touch.overlap, motion.approach, touch.dt)
        return phi

    return since_onset if laws.predicted else whole


def _hooke(laws: Laws) -> wp.Function:
    part = _part(laws)

    @wp.func
    def lagged(motion: Kinematics, material: Material, touch: Touch):
        elastic = touch.stiffness * touch.overlap
        fn = hooke(touch.stiffness, touch.overlap, touch.tau, motion.approach)
        if wp.static(laws.documented):
            if material.dncut > real(0.0):
                free = elastic + touch.stiffness * touch.tau * motion.approach
                fn = documented(-touch.overlap, material.dncut, material.fc, free)
        return fn, real(1.0), elastic

    @wp.func
    def predicted(motion: Kinematics, material: Material, touch: Touch):
        k = touch.stiffness
        d = touch.overlap
        elastic = k * d
        # unclamped: what the dashpot would do with the velocity of the step's end
        ahead = k * (d + touch.tau * motion.approach_end)
        free = predicted_force(ahead, touch.beta, touch.before)
        fn = wp.max(free, real(0.0))
        phi = part(motion, touch)
        if phi < real(1.0):
            # the dashpot acts for phi dt before and dt / 2 after this instant; friction and the
            # next prediction see the same force, or their impulses are of first order
            fn = wp.max(
                elastic + (real(0.5) + phi) * (ahead / (real(1.0) + touch.beta) - elastic),
                real(0.0),
            )
        if wp.static(laws.documented):
            if material.dncut > real(0.0):
                fn = documented(-d, material.dncut, material.fc, free)
        return fn, phi, elastic

    return predicted if laws.predicted else lagged


def _avalanche(laws: Laws) -> wp.Function:
    part = _part(laws)

    @wp.func
    def unloading(motion: Kinematics, material: Material, touch: Touch):
        k = touch.stiffness
        fn = avalanche(k, material.en2, -touch.overlap, touch.last, touch.before)
        return fn, part(motion, touch), material.en2 * k * touch.overlap

    return unloading


def trial(law: wp.Function) -> wp.Kernel:
    """Kernel of nothing but a custom law: it builds where the law does."""

    @variant
    def alone(
        # in
        touch: Touch,
        motion: Kinematics,
        parameters: Parameters,
        # out
        force: wp.array(dtype=real),
    ):
        force[0] = law(touch, motion, parameters)

    return alone


def _custom(law: wp.Function, laws: Laws) -> wp.Function:
    part = _part(laws)

    @wp.func
    def custom(motion: Kinematics, material: Material, touch: Touch):
        fn = law(touch, motion, material.parameters)
        return fn, part(motion, touch), real(0.0)

    return custom
