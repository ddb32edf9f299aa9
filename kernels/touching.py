"""Pass 1 of the pair kernel: what touches, and how stiff the pair is as a whole."""

import functools

import warp as wp
from warpdem.kernels.excess import Excess
from warpdem.kernels.integrate import world_inverse
from warpdem.kernels.laws import Laws
from warpdem.kernels.matching import hand_over
from warpdem.kernels.narrow import feature_pair
from warpdem.kernels.normal import pair_frequency
from warpdem.kernels.precision import real, vec3, wide, wide3, wide4
from warpdem.kernels.regions import is_nearest, restricted
from warpdem.kernels.sharing import SHARES
from warpdem.kernels.variant import inlined, place
from warpdem.kernels.views import Bodies, Candidates, Geometry, Inertia, Material


@functools.cache
def find_touching(laws: Laws) -> wp.Function:
    """Function of pass 1: packs the touching candidates of a pair, settles those that ended."""
    gap_of = gaps(laws)
    settle = settled(laws)
    hand = hand_over(gap_of, laws)

    @inlined()
    def find_touching(
        geometry: Geometry,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        law: Material,
        d: wide3,
        start: int,
        end: int,
        margin: real,
    ):
        touching = int(0)
        ended = int(0)
        reach = real(0.0)
        if wp.static(laws.reaching):
            reach = law.dncut
        freed = wide(0.0)
        unrolled = wide(0.0)
        whole = bool(False)
        if wp.static(laws.once and laws.cones):
            whole = restricted(geometry, i) or restricted(geometry, j)
        for k in range(start, end):
            c = k
            if wp.static(laws.polyhedra):
                c = place(candidates.hot[k])
            past = candidates.past[c]
            touched = past[3] != wide(-1.0)
            hit = gap_of(geometry, bodies, i, j, d, margin, touched, candidates.code[c])
            near = hit.gap < reach
            if wp.static(laws.sticky):
                # what pulled until within this step still has to be paid for it
                if law.fc > real(0.0) or law.gamma > real(0.0):
                    near = near or (past[3] >= wide(0.0) and hit.gap < margin)
            inside = hit.outside == real(0.0)
            if wp.static(laws.once):
                if near and inside and not whole:
                    inside = is_nearest(geometry, bodies, i, j, d, candidates.code[c])
            if near and inside:
                slot = start + touching
                candidates.which[slot] = c
                candidates.normal[slot] = hit.normal
                candidates.point[slot] = hit.point
                candidates.gap[slot] = hit.gap
                touching += 1
            elif past[3] >= wide(0.0):
                if wp.static(laws.keep):
                    # what is no longer over its feature is as far as what is beyond the margin
                    gap = wp.where(inside, hit.gap, margin)
                    settle(candidates, c, gap, margin)
                elif hit.gap < real(0.0):
                    candidates.past[c] = wide4(past[0], past[1], past[2], wide(-2.0) - past[3])
                    ended += 1
                else:
                    lost, still = settle(candidates, c, hit.gap, margin)
                    freed += lost
                    unrolled += still
        if ended > 0:
            hand(geometry, bodies, candidates, i, j, d, start, end, touching)
        return touching, freed, unrolled

    return find_touching


@functools.cache
def gaps(laws: Laws) -> wp.Function:
    """Function of the gap of any feature pair that the scene has."""
    return feature_pair(
        polyhedra=laws.polyhedra,
        convex=laws.convex,
        two_sided=laws.two_sided,
        cones=laws.cones,
        surfaces=laws.surfaces,
    )


@functools.cache
def find_single(laws: Laws) -> wp.Function:
    """Function of pass 1 for one candidate: where it is, whether it acts, what it gave up."""
    gap_of = gaps(laws)
    settle = settled(laws)

    @inlined()
    def find_single(
        geometry: Geometry,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        law: Material,
        d: wide3,
        c: int,
        margin: real,
    ):
        reach = real(0.0)
        if wp.static(laws.reaching):
            reach = law.dncut
        freed = wide(0.0)
        unrolled = wide(0.0)
        hit = gap_of(geometry, bodies, i, j, d, margin, True, candidates.code[c])
        near = hit.gap < reach
        if not near:
            past = candidates.past[c]
            if past[3] >= wide(0.0):
                if wp.static(laws.sticky):
                    if law.fc > real(0.0) or law.gamma > real(0.0):
                        near = hit.gap < margin
                if not near:
                    freed, unrolled = settle(candidates, c, hit.gap, margin)
        return hit, near, freed, unrolled

    return find_single


@functools.cache
def settled(laws: Laws) -> wp.Function:
    """Function that ends a contact that opened: squares of the force and moment it gave up."""

    @inlined()
    def settled(candidates: Candidates, c: int, gap: real, margin: real):
        freed = wide(0.0)
        unrolled = wide(0.0)
        if wp.static(laws.keep):
            if wp.static(laws.avalanche):
                candidates.last[c] = real(0.0)
            if gap >= margin:
                candidates.past[c] = wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))
                if wp.static(laws.rolling):
                    candidates.rolled[c] = wide4()
        else:
            if wp.static(laws.account):
                past = candidates.past[c]
                freed = past[0] * past[0] + past[1] * past[1] + past[2] * past[2]
                if wp.static(laws.moving):
                    freed = freed / wide(candidates.share[c])
            candidates.past[c] = wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))
            if wp.static(laws.rolling):
                rolled = candidates.rolled[c]
                unrolled = wp.dot(rolled, rolled)
                if wp.static(laws.moving):
                    unrolled = unrolled / wide(candidates.share[c])
                candidates.rolled[c] = wide4()
        return freed, unrolled

    return settled


@functools.cache
def frequency(laws: Laws) -> wp.Function:
    """Function of the square of a pair's own frequency over its stiffness."""
    share_of = SHARES.get(laws.partnership)

    @inlined()
    def frequency(
        inertia: Inertia,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        d: vec3,
        start: int,
        touching: int,
        total: real,
        exponent: real,
        excess: Excess,
    ) -> real:
        force = vec3()
        torque_i = vec3()
        torque_j = vec3()
        squares = real(0.0)
        if wp.static(laws.once):
            force = excess.force
            torque_i = excess.torque - wp.cross(d, force)
            torque_j = excess.torque
            squares = excess.square
        single = real(0.0)
        for slot in range(start, start + touching):
            overlap = -candidates.gap[slot]
            if wp.static(laws.reaching or laws.sticky):
                overlap = wp.max(overlap, real(0.0))
            pushed = overlap
            if wp.static(laws.moving):
                if overlap > real(0.0):
                    pushed = share_of(overlap, total, exponent) * overlap
            if wp.static(laws.once):
                pushed = candidates.share[candidates.which[slot]] * overlap
            f = candidates.normal[slot] * pushed
            point = candidates.point[slot]
            force += f
            torque_i += wp.cross(point - d, f)
            torque_j += wp.cross(point, f)
            squares += pushed * overlap
            single += pushed * pushed
        inverse_mass = real(inertia.inverse_mass[i] + inertia.inverse_mass[j])
        square = inverse_mass
        if squares > real(0.0):
            spin_i = world_inverse(bodies.rotation[i], vec3(inertia.inverse_moment[i]), torque_i)
            spin_j = world_inverse(bodies.rotation[j], vec3(inertia.inverse_moment[j]), torque_j)
            square = pair_frequency(
                force, torque_i, torque_j, spin_i, spin_j, squares, single, inverse_mass
            )
        return square

    return frequency
