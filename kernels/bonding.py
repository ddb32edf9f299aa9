"""Laws of one breakable bond (Rockable's sticked links) and of its rupture.

Symbols: fn along the normal, positive in compression [N]; ft, M tangential force and moment; kn, cn
stiffness [N/m] and damping [N s/m]; beta the share of a bond's own force that is taken implicitly.
"""

import warp as wp
from warpdem.kernels.precision import wide, wide3

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
def glued(elastic: wide, cn: wide, vn: wide, beta: wide, before: wide) -> wide:
    """Force of a bond along its normal, pulling or pushing [N].

    ``before`` is that of the last pass, by which vn was predicted; see predicted_force.
    """
    return (elastic + cn * vn + beta * before) / (wide(1.0) + beta)


@wp.func
def glued_across(elastic: wide3, cn: wide, u: wide3, beta: wide, before: wide3) -> wide3:
    """The same across it, elastic and viscous together; only the elastic part is remembered [N]."""
    return (elastic + u * cn + before * beta) / (wide(1.0) + beta)


@wp.func
def implicit_share(rate: wide, decay: wide, dt: wide) -> wide:
    """beta of a bond: that of its own pair, or what keeps many dashpots on a body stable.

    The predicted update of dashpots alone is stable for X = decay dt < 1 + 2 beta.
    """
    return wp.max(rate * dt, wide(0.5) * decay * dt - wide(0.125))


@wp.func
def yielding(fn: wide, ft: wide, moment: wide, fn0: wide, ft0: wide, m0: wide, power: wide) -> wide:
    """(|ft|/ft0)^p + (|M|/m0)^p - fn/fn0 - 1: a bond yields where it is positive."""
    bent = wp.pow(ft / ft0, power) + wp.pow(moment / m0, power)
    return bent - fn / fn0 - wide(1.0)


@wp.func
def leading(fn: wide, ft: wide, moment: wide, fn0: wide, ft0: wide, m0: wide, power: wide) -> int:
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
def cracking(stretched: wide, sheared: wide, stretching: wide, shearing: wide, both: wide) -> bool:
    """Whether the elastic energy of an interface exceeds 2 A Gc, by part or in sum [J]."""
    return stretched > stretching or sheared > shearing or stretched + sheared > both
