"""How the sub-contacts of two bodies share their stiffness: k_i = w_i kn (``run.partnership``).

With overlaps d_i: ``number`` w = 1/n, ``overlap`` w = d / sum d (Rockable's NumberWeight and
OverlapWeight, which create energy), ``pnorm`` w = (d/g)^(p - 2), g = (sum d^p)^(1/p), the gradient
of kn g^2 / 2. ``sum`` is w = 1 and needs nothing of this; ``once`` counts by regions and excess:
see regions.py and excess.py.
"""

import functools

import warp as wp
from warpdem.kernels.precision import real
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Candidates


@wp.func
def number_share(d: real, total: real, exponent: real) -> real:
    """1/n, ``total`` being n."""
    return real(1.0) / total


@wp.func
def overlap_share(d: real, total: real, exponent: real) -> real:
    """d / sum d, ``total`` being the sum [m]."""
    return d / total


@wp.func
def pnorm_share(d: real, total: real, exponent: real) -> real:
    """(d/g)^(p - 2), ``total`` being g [m]."""
    return wp.pow(d / total, exponent - real(2.0))


SHARES = {"number": number_share, "overlap": overlap_share, "pnorm": pnorm_share}


@functools.cache
def total_of(rule: str) -> wp.Function:
    """Function of what a pair's shares are measured by: n, sum d or g; 1 where nothing overlaps."""

    @inlined()
    def number(candidates: Candidates, start: int, touching: int, exponent: real) -> real:
        total = real(0.0)
        for slot in range(start, start + touching):
            if candidates.gap[slot] < real(0.0):
                total += real(1.0)
        return wp.max(total, real(1.0))

    @inlined()
    def overlap(candidates: Candidates, start: int, touching: int, exponent: real) -> real:
        total = real(0.0)
        for slot in range(start, start + touching):
            total += wp.max(-candidates.gap[slot], real(0.0))
        if total == real(0.0):
            return real(1.0)
        return total

    @inlined()
    def pnorm(candidates: Candidates, start: int, touching: int, exponent: real) -> real:
        largest = real(0.0)
        for slot in range(start, start + touching):
            largest = wp.max(largest, -candidates.gap[slot])
        if largest == real(0.0):
            return real(1.0)
        total = real(0.0)
        for slot in range(start, start + touching):
            d = wp.max(-candidates.gap[slot], real(0.0))
            total += wp.pow(d / largest, exponent)
        return largest * wp.pow(total, real(1.0) / exponent)

    return {"number": number, "overlap": overlap, "pnorm": pnorm}[rule]


@wp.func
def carried_share(before: real, now: real) -> real:
    """What a tangential spring keeps of its force when its share changes: never more energy."""
    if now < before:
        return now / before
    return real(1.0)


@wp.func
def passive_share(before: real, now: real) -> real:
    """Share of the tangential stiffness over a step in which it went from one value to another."""
    if now < before:
        return now
    return real(0.5) * (now + before)
