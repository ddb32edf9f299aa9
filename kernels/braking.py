"""How fast the dashpots of a pair can bring its bodies to rest, against the time step.

The dashpot of a pair is made for the mode that is being hit; others, rocking say, may be faster and
are braked more. Where that exceeds what a step can follow the dashpots get a larger implicit share.
"""

import functools

import warp as wp
from warpdem.kernels.precision import mat33, real, vec3
from warpdem.kernels.sharing import SHARES
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Inertia


@inlined()
def sides(bodies: Bodies, i: int, j: int) -> real:
    """Pairs that brake a body along one line: from both sides, once others act on it too."""
    if bodies.braked[i] > 1 or bodies.braked[j] > 1:
        return real(2.0)
    return real(1.0)


@wp.func
def implicit_share(decay: real) -> real:
    """Least beta for which dashpots are stable, ``decay`` = dt c/m of the fastest mode of a body.

    decay < 1 + 2 beta, with room for the springs. Of no effect where zeta omega dt is larger: one
    contact, or steps fine enough.
    """
    return real(0.5) * decay - real(0.125)


@wp.func
def largest_eigenvalue(b: mat33) -> real:
    """Upper bound for a symmetric matrix without negative eigenvalues: trace(b^8)^(1/8)."""
    size = wp.trace(b)
    if size == real(0.0):
        return real(0.0)
    b = b / size
    b = b * b
    b = b * b
    b = b * b
    return size * wp.pow(wp.trace(b), real(0.125))


@wp.func
def coupled(shift: real, turn: real, coupling: real) -> real:
    """Norm of [[shift, coupling], [coupling, turn]]: bounds that of a matrix of such blocks."""
    half = real(0.5) * (shift - turn)
    return real(0.5) * (shift + turn) + wp.sqrt(half * half + coupling * coupling)


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
        """Bound from above [1/kg]; ``shift`` leads from the partner's centre to the body's."""
        inverse_mass = inertia.inverse_mass[body]
        if inverse_mass == real(0.0):
            return real(0.0)
        own = wp.transpose(bodies.rotation[body])
        inverse_moment = inertia.inverse_moment[body]
        scale = vec3(
            wp.sqrt(inverse_moment[0]), wp.sqrt(inverse_moment[1]), wp.sqrt(inverse_moment[2])
        )
        along = mat33()
        about = mat33()
        both = mat33()
        for slot in range(start, start + touching):
            overlap = -candidates.gap[slot]
            if overlap > real(0.0):
                n = candidates.normal[slot]
                turn = wp.cw_mul(own * wp.cross(candidates.point[slot] - shift, n), scale)
                share = real(1.0)
                if wp.static(partnership != "sum"):
                    share = share_of(overlap, total, exponent)
                along += wp.outer(n, n) * share
                about += wp.outer(turn, turn) * share
                both += wp.outer(n, turn) * share
        coupling = wp.sqrt(wp.ddot(both, both) * inverse_mass)
        return coupled(
            largest_eigenvalue(along) * inverse_mass, largest_eigenvalue(about), coupling
        )

    return fastest_mode
