"""How fast the dashpots of a pair can bring its bodies to rest, against the time step.

The dashpot of a pair is made for the mode that is being hit; others, rocking say, may be faster and
are braked more. Where that exceeds what a step can follow the dashpots get a larger implicit share.
"""

import functools

import warp as wp
from warpdem.kernels.measures import largest_eigenvalue
from warpdem.kernels.precision import mat33, real, vec3, wide
from warpdem.kernels.sharing import SHARES
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Candidates, Clock, Drives, Inertia, Pairs

# steps between two looks at the modes of a pair
LOOK = 8


@wp.func
def implicit_share(decay: real) -> real:
    """Least beta for which dashpots are stable, ``decay`` = dt c/m of the fastest mode of a body.

    decay < 1 + 2 beta, with room for the springs. Of no effect where zeta omega dt is larger: one
    contact, or steps fine enough. With half of the decay alone velocities would change sign each
    step, the less damped the larger it is: hence more of it beyond 4.
    """
    much = wp.max(decay - real(4.0), real(0.0))
    return real(0.5) * decay - real(0.125) + real(0.25) * much


@wp.func
def coupled(shift: real, turn: real, coupling: real) -> real:
    """Norm of [[shift, coupling], [coupling, turn]]: bounds that of a matrix of such blocks."""
    half = real(0.5) * (shift - turn)
    return real(0.5) * (shift + turn) + wp.sqrt(half * half + coupling * coupling)


@functools.cache
def mobility(*, controlled: bool) -> wp.Function:
    """Function of how easily a body is moved: axes, square roots of its inverse inertia."""

    @inlined()
    def mobility(inertia: Inertia, drives: Drives, bodies: Bodies, body: int):
        """Frame whose rows are the axes of the turning; scales [kg^-1/2] and [kg^-1/2 m^-1]."""
        own = wp.transpose(bodies.rotation[body])
        inverse_mass = vec3(real(inertia.inverse_mass[body]))
        inverse_moment = vec3(inertia.inverse_moment[body])
        if wp.static(controlled):
            place = inertia.driven[body] - 1
            if place >= 0:
                # a wall that follows a force, along the world's axes
                own = wp.identity(n=3, dtype=real)
                inverse_mass = vec3(drives.inverse_mass[place])
                inverse_moment = vec3(drives.inverse_inertia[place])
        along = vec3(wp.sqrt(inverse_mass[0]), wp.sqrt(inverse_mass[1]), wp.sqrt(inverse_mass[2]))
        about = vec3(
            wp.sqrt(inverse_moment[0]), wp.sqrt(inverse_moment[1]), wp.sqrt(inverse_moment[2])
        )
        return own, along, about

    return mobility


@inlined()
def sides(inertia: Inertia, bodies: Bodies, body: int) -> real:
    """How many pairs may brake a body along one line: a free one two, a wall all that touch it."""
    acting = wp.max(bodies.braked[body], 1)
    if inertia.inverse_mass[body] > wide(0.0):
        acting = wp.min(acting, 2)
    return real(acting)


@wp.struct
class Modes:
    """How a pair's contacts hold one of its bodies, per stiffness: blocks of M^-1 sum w J J^T."""

    along: mat33  # [1/kg]
    about: mat33
    both: mat33
    sides: real


@functools.cache
def modes(partnership: str, *, controlled: bool) -> wp.Function:
    """Function of how a pair's contacts hold one of its bodies."""
    share_of = SHARES.get(partnership)
    mobility_of = mobility(controlled=controlled)

    @inlined()
    def modes(
        inertia: Inertia,
        drives: Drives,
        bodies: Bodies,
        candidates: Candidates,
        body: int,
        shift: vec3,
        start: int,
        touching: int,
        total: real,
        exponent: real,
    ) -> Modes:
        """``shift`` leads from the partner's centre to the body's."""
        own, scale, turning = mobility_of(inertia, drives, bodies, body)
        found = Modes()
        if scale == vec3() and turning == vec3():
            return found
        along = mat33()
        about = mat33()
        both = mat33()
        for slot in range(start, start + touching):
            overlap = -candidates.gap[slot]
            if overlap > real(0.0):
                normal = candidates.normal[slot]
                n = wp.cw_mul(normal, scale)
                arm = wp.cross(candidates.point[slot] - shift, normal)
                turn = wp.cw_mul(own * arm, turning)
                share = real(1.0)
                if wp.static(partnership == "once"):
                    share = candidates.share[candidates.which[slot]]
                elif wp.static(partnership != "sum"):
                    share = share_of(overlap, total, exponent)
                along += wp.outer(n, n) * share
                about += wp.outer(turn, turn) * share
                both += wp.outer(n, turn) * share
        found.along = along
        found.about = about
        found.both = both
        found.sides = sides(inertia, bodies, body)
        return found

    return modes


@wp.func
def norm(block: mat33) -> real:
    """Square root of the sum of the squares of all entries."""
    return wp.sqrt(wp.ddot(block, block))


@wp.func
def highest(found: Modes) -> real:
    """A body's part of the square of a pair's highest frequency, per stiffness, from above [1/kg].

    Times the number of pairs that may brake the body along one line.
    """
    along = largest_eigenvalue(found.along)
    about = largest_eigenvalue(found.about)
    return coupled(along, about, norm(found.both)) * found.sides


@functools.cache
def fastest_mode(partnership: str, *, controlled: bool) -> wp.Function:
    """Function of the square of a pair's highest frequency, per stiffness, from above [1/kg].

    It changes with the arms of the contacts, slowly, and with their number: every LOOK steps, and
    where another number touches, it is found anew. What walls that follow a force carry may change
    at once: they are looked at in every step.
    """
    modes_of = modes(partnership, controlled=controlled)

    @inlined()
    def fastest_mode(
        inertia: Inertia,
        drives: Drives,
        bodies: Bodies,
        clock: Clock,
        pairs: Pairs,
        candidates: Candidates,
        pair: int,
        i: int,
        j: int,
        d: vec3,
        start: int,
        touching: int,
        total: real,
        exponent: real,
    ) -> real:
        if wp.static(not controlled):
            if pairs.looked[pair] == touching and clock.steps[0] % LOOK != 0:
                return pairs.fastest[pair]
        # fmt: off
        own = modes_of(
            inertia, drives, bodies, candidates, i, d, start, touching, total, exponent
        )
        other = modes_of(
            inertia, drives, bodies, candidates, j, vec3(), start, touching, total, exponent
        )
        # fmt: on
        fastest = highest(own) + highest(other)
        pairs.looked[pair] = touching
        pairs.fastest[pair] = fastest
        return fastest

    return fastest_mode
