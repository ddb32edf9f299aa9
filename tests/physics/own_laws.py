"""A contact law of the user's own, as the tests of custom laws name it."""

import warp as wp
from warpdem.kernels.custom import Kinematics, Parameters, Touch, real


@wp.func
def hertz(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:
    """A power law of the overlap: parameters are its factor [N/m^1.5]."""
    return parameters[0] * wp.pow(touch.overlap, real(1.5))


def not_a_device_function(touch):
    """Lacks the decorator."""
    return touch
