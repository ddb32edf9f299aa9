"""How fast the dashpots of a pair can bring its bodies to rest, against the time step.

The dashpot of a pair is made for the mode that is being hit; others, rocking say, may be faster and
are braked more. Where that exceeds what a step can follow the dashpots get a larger implicit share.
"""

import functools

import warp as wp
from warpdem.kernels.measures import direction
from warpdem.kernels.precision import mat66, real, vec3
from warpdem.kernels.sharing import SHARES
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Inertia

# pairs that may brake one body along one line, from both sides
SIDES = wp.constant(real(2.0))


@wp.func
def implicit_share(decay: real) -> real:
    """Least beta for which dashpots are stable, ``decay`` = dt c/m of the fastest mode of a body.

    decay < 1 + 2 beta, with room for the springs. Of no effect where zeta omega dt is larger: one
    contact, or steps fine enough.
    """
    return real(0.5) * decay - real(0.125)


@wp.func
def largest_eigenvalue(b: mat66) -> real:
    """Upper bound for a symmetric matrix without negative eigenvalues: trace(b^8)^(1/8)."""
    size = wp.trace(b)
    if size == real(0.0):
        return real(0.0)
    b = b / size
    b = b * b
    b = b * b
    b = b * b
    return size * wp.pow(wp.trace(b), real(0.125))


@functools.cache
def fastest_mode(partnership: str) -> wp.Function:
    """Function of a body's part of the square of a pair's highest frequency, per stiffness."""
    share_of = SHARES.get(partnership)

    @inlined()
    def fastest_mode(
        inertia: Inertia,
        bodies: Bodies,
        candidates: Candidates,
        body: int,
        shift: vec3,
        start: int,
        touching: int,
        total: real,
        exponent: real,
    ) -> real:
        """[1/kg]; ``shift`` leads from the partner's centre to the body's."""
        inverse = wp.transpose(bodies.rotation[body])
        inverse_mass = inertia.inverse_mass[body]
        if inverse_mass == real(0.0):
            return real(0.0)
        b = mat66()
        for slot in range(start, start + touching):
            overlap = -candidates.gap[slot]
            if overlap > real(0.0):
                arm = inverse * (candidates.point[slot] - shift)
                n = inverse * candidates.normal[slot]
                row = direction(n, arm, inverse_mass, inertia.inverse_moment[body])
                share = real(1.0)
                if wp.static(partnership != "sum"):
                    share = share_of(overlap, total, exponent)
                b += wp.outer(row, row) * share
        return largest_eigenvalue(b)

    return fastest_mode
