"""Where the vertices of a pair lie: about the partner, or in mixed precision about the owner."""

import warp as wp
from warpdem.kernels.precision import NARROW, vec3, wide3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies


@inlined()
def of_owner(bodies: Bodies, index: int, d: wide3) -> vec3:
    """A vertex of the owner about the partner's centre; in mixed precision about its own.

    Partners may be large, and the numbers that remain about a small owner are small.
    """
    arm = bodies.arm[index]
    if wp.static(not NARROW):
        arm = d + arm
    return arm


@inlined()
def of_partner(bodies: Bodies, index: int, d: wide3) -> vec3:
    """A vertex of the partner about the same."""
    arm = bodies.arm[index]
    if wp.static(NARROW):
        arm = vec3(wide3(arm) - d)
    return arm
