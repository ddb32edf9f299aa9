"""Friction and rolling resistance of a scene, composed of the small laws of tangential.py."""

import functools

import warp as wp
from warpdem.kernels.kinematics import Kinematics
from warpdem.kernels.laws import Laws
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.tangential import SLID, coulomb, laid, radial_return, spun
from warpdem.kernels.views import Material


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
        least = SLID * limit
        slid = past[3] >= real(0.0) and wp.dot(old, old) >= least * least
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
        least = SLID * limit
        slid = past[3] >= real(0.0) and wp.dot(start, start) >= least * least
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
