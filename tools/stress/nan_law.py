"""A contact law that gives no number once the overlap is beyond its parameter [m]."""

import warp as wp
from warpdem.kernels.custom import Kinematics, Parameters, Touch, real


@wp.func
def broken(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:  # noqa: ARG001 - as laws are called
    """Linear spring, NaN beyond an overlap."""
    force = touch.stiffness * touch.overlap
    if touch.overlap > parameters[0]:
        force = wp.sqrt(real(-1.0) - touch.overlap)
    return force
