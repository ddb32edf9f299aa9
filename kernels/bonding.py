"""Laws of one breakable bond (Rockable's sticked links) and of its rupture.

Symbols: fn along the normal, positive in compression [N]; ft, M tangential force and moment; kn, cn
stiffness [N/m] and damping [N s/m]; beta the share of a bond's own force that is taken implicitly.
"""

import warp as wp
from warpdem.kernels.precision import real, vec3

# of an interface
BROKEN = wp.constant(0)
INTACT = wp.constant(1)
YIELDED = wp.constant(2)  # its forces act for the last time

# what broke an interface
TENSION = wp.constant(1)
SHEAR = wp.constant(2)
BENDING = wp.constant(3)
ENERGY = wp.constant(4)


@wp.func
def glued(elastic: real, cn: real, vn: real, beta: real, before: real) -> real:
    """Force of a bond along its normal, pulling or pushing [N].

    ``before`` is that of the last pass, by which vn was predicted; see predicted_force.
    """
    return (elastic + cn * vn + beta * before) / (real(1.0) + beta)


@wp.func
def glued_across(elastic: vec3, cn: real, u: vec3, beta: real, before: vec3) -> vec3:
    """The same across it, elastic and viscous together; only the elastic part is remembered [N]."""
    return (elastic + u * cn + before * beta) / (real(1.0) + beta)


@wp.func
def implicit_share(rate: real, decay: real, dt: real) -> real:
    """beta of a bond: that of its own pair, or what keeps many dashpots on a body stable.

    The predicted update of dashpots alone is stable for X = decay dt < 1 + 2 beta.
    """
    return wp.max(rate * dt, real(0.5) * decay * dt - real(0.125))


@wp.func
def yielding(fn: real, ft: real, moment: real, fn0: real, ft0: real, m0: real, power: real) -> real:
    """(|ft|/ft0)^p + (|M|/m0)^p - fn/fn0 - 1: a bond yields where it is positive."""
    bent = wp.pow(ft / ft0, power) + wp.pow(moment / m0, power)
    return bent - fn / fn0 - real(1.0)


@wp.func
def leading(fn: real, ft: real, moment: real, fn0: real, ft0: real, m0: real, power: real) -> int:
    """Which of tension, shear and bending has the largest part in ``yielding``."""
    pulled = -fn / fn0
    sheared = wp.pow(ft / ft0, power)
    bent = wp.pow(moment / m0, power)
    if pulled >= sheared and pulled >= bent:
        return TENSION
    if sheared >= bent:
        return SHEAR
    return BENDING


@wp.func
def cracking(stretched: real, sheared: real, stretching: real, shearing: real, both: real) -> bool:
    """Whether the elastic energy of an interface exceeds 2 A Gc, by part or in sum [J]."""
    return stretched > stretching or sheared > shearing or stretched + sheared > both
