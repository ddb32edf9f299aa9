"""The law of rock avalanches: a spring that unloads along en2 times its stiffness, no dashpot."""

import warp as wp
from warpdem.kernels.precision import FARTHEST, real, vec3


@wp.func
def avalanche(k: real, en2: real, gap: real, last: real, before: real) -> real:
    """Normal force [N] from that of the last step, ``before``, and the gaps of both steps [m].

    Loading adds k times the approach, unloading puts it on en2 k |dn|; an open contact (last > 0)
    counts as one that just touched.
    """
    moved = gap - wp.min(last, real(0.0))
    fn = before
    if moved > real(0.0):
        fn = -k * en2 * gap
    elif moved < real(0.0):
        fn = before - k * moved
    return wp.max(fn, real(0.0))


@wp.func
def axis_distance(branch: vec3, spin: vec3) -> real:
    """Distance of a contact point from the axis its body turns about, ``branch`` from the centre.

    Infinite, so that nothing is cut, while the body does not turn [m].
    """
    square = wp.dot(spin, spin)
    if square == real(0.0):
        return real(FARTHEST)
    return wp.length(branch - spin * (wp.dot(branch, spin) / square))
