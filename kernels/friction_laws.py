"""Friction and rolling resistance of a scene, composed of the small laws of tangential.py."""

import functools

import warp as wp
from warpdem.kernels.kinematics import Kinematics
from warpdem.kernels.laws import Laws
from warpdem.kernels.precision import wide, wide3, wide4
from warpdem.kernels.tangential import SLID, coulomb, laid, radial_return, spun
from warpdem.kernels.views import Material


@functools.cache
def tangential_law(laws: Laws) -> wp.Function:
    """Function of the frictional force carried to this step [N], and where it came from."""

    @wp.func
    def objective(
        motion: Kinematics, law: Material, normal: wide3, past: wide4, cap: wide, step: wide
    ):
        # half of the spin before and half after: second order also while slip turns
        half = wide(0.5) * wide(motion.turn)
        old = wide3(past[0], past[1], past[2])
        start = spun(laid(old, normal), normal, half)
        limit = wide(law.mu) * wp.max(past[3], wide(0.0))
        if wp.static(laws.elastic_cap or not laws.predicted):
            force = radial_return(start + wide3(motion.sliding) * step, cap)
            return spun(force, normal, half), spun(start, normal, half)
        least = SLID * limit
        slid = past[3] >= wide(0.0) and wp.dot(old, old) >= least * least
        force = coulomb(start, wide3(motion.sliding), step, cap, limit, slid)
        return spun(force, normal, half), spun(start, normal, half)

    @wp.func
    def fixed(motion: Kinematics, law: Material, normal: wide3, past: wide4, cap: wide, step: wide):
        start = wide3(past[0], past[1], past[2])
        return radial_return(start + wide3(motion.sliding) * step, cap), start

    return objective if laws.objective else fixed


@functools.cache
def rolling_law(laws: Laws) -> wp.Function:
    """Function of the rolling moment: tangent vector and part about the normal [N m]."""

    @wp.func
    def objective(
        motion: Kinematics,
        law: Material,
        normal: wide3,
        past: wide4,
        rolled: wide4,
        fn: wide,
        arm: wide,
        step: wide,
    ):
        half = wide(0.5) * wide(motion.turn)
        tangent = laid(wide3(rolled[0], rolled[1], rolled[2]), normal)
        start = spun(tangent, normal, half) + normal * rolled[3]
        cap = wide(law.mur) * arm * fn
        limit = wide(law.mur) * arm * wp.max(past[3], wide(0.0))
        if wp.static(not laws.predicted):
            moment = radial_return(start + wide3(motion.spin) * step, cap)
            return spun(moment, normal, half), spun(start, normal, half)
        least = SLID * limit
        slid = past[3] >= wide(0.0) and wp.dot(start, start) >= least * least
        moment = coulomb(start, wide3(motion.spin), step, cap, limit, slid)
        return spun(moment, normal, half), spun(start, normal, half)

    @wp.func
    def fixed(
        motion: Kinematics,
        law: Material,
        normal: wide3,
        past: wide4,
        rolled: wide4,
        fn: wide,
        arm: wide,
        step: wide,
    ):
        # unrotated: the whole vector is kept, its fourth number stays zero
        start = wide3(rolled[0], rolled[1], rolled[2])
        return radial_return(start + wide3(motion.spin) * step, wide(law.mur) * arm * fn), start

    return objective if laws.objective else fixed
