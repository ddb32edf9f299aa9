"""What becomes of an interface that has yielded: its contacts take over, the rest is released."""

import functools

import warp as wp
from warpdem.kernels.attraction import attraction
from warpdem.kernels.bonding import BROKEN, YIELDED
from warpdem.kernels.codes import kind_of
from warpdem.kernels.cohesion import at_distance_energy, curvature_radius
from warpdem.kernels.kinematics import Flow, kinematics
from warpdem.kernels.laws import AVALANCHE, CUSTOM, Laws
from warpdem.kernels.narrow import feature_pair
from warpdem.kernels.neighbours import lower_bound
from warpdem.kernels.precision import real, vec3, wide, wide3, wide4
from warpdem.kernels.sharing import SHARES, total_of
from warpdem.kernels.tangential import radial_return
from warpdem.kernels.variant import inlined, variant
from warpdem.kernels.views import Bodies, Bonds, Candidates, Geometry, Material, Pairs


@functools.cache
def listed_pair(*, periodic: bool) -> wp.Function:
    """Function of the listed pair of two bodies, not of an image, or -1."""

    @inlined()
    def listed_pair(pairs: Pairs, ends: wp.array(dtype=wp.int32), i: int, j: int) -> int:
        """``ends`` is where each owner's pairs end."""
        low = int(0)
        if i > 0:
            low = ends[i - 1]
        found = int(-1)
        for pair in range(lower_bound(pairs.partner, low, ends[i], j), ends[i]):
            if pairs.partner[pair] == j and found < 0:
                own = bool(True)
                if wp.static(periodic):
                    n = pairs.image[pair]
                    own = n[0] == 0 and n[1] == 0 and n[2] == 0
                if own:
                    found = pair
        return found

    return listed_pair


@inlined()
def remembered(bonds: Bonds, k: int, code: wp.int64, damping: bool, mu: wide) -> wide4:
    """Tangential force under mu |fn| and fn of the bond of a feature pair; -1 without one.

    The bond must have been closed in its last step.
    """
    for bond in range(bonds.start[k], bonds.start[k + 1]):
        if bonds.code[bond] == code and bonds.gap[bond] < wide(0.0):
            held = bonds.held[bond]
            ft = wide3(held[0], held[1], held[2])
            if damping:
                ft += bonds.viscous[bond]
            ft = radial_return(ft, mu * wp.abs(held[3]))
            return wide4(ft[0], ft[1], ft[2], wp.max(held[3], wide(0.0)))
    return wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))


@functools.cache
def pack(laws: Laws) -> wp.Function:
    """Function that packs what acts from now on, with the gaps of half a step ago; their number.

    What touches now does not count as apart then, nor the other way round: gaps end at 0.
    """
    gap_of = feature_pair(
        polyhedra=laws.polyhedra,
        convex=laws.convex,
        two_sided=laws.two_sided,
        cones=laws.cones,
        surfaces=False,
    )
    motion_at = kinematics(predicted=False, deforming=False)

    @inlined()
    def pack(
        geometry: Geometry,
        bodies: Bodies,
        candidates: Candidates,
        law: Material,
        i: int,
        j: int,
        start: int,
        end: int,
        dt: real,
    ) -> int:
        reach = real(0.0)
        if wp.static(laws.reaching):
            reach = law.dncut
        d = bodies.position[i] - bodies.position[j]
        slot = int(start)
        for c in range(start, end):
            hit = gap_of(geometry, bodies, i, j, d, reach, False, candidates.code[c])
            if hit.gap < reach and hit.outside == real(0.0):
                motion = motion_at(bodies, Flow(), i, j, vec3(d), hit.normal, hit.point, dt)
                gap = hit.gap + real(0.5) * dt * motion.approach
                if hit.gap < real(0.0):
                    gap = wp.min(gap, real(0.0))
                    if wp.static(laws.avalanche):
                        candidates.last[c] = hit.gap
                else:
                    gap = wp.clamp(gap, real(0.0), reach)
                candidates.which[slot] = c
                candidates.gap[slot] = gap
                slot += 1
        return slot - start

    return pack


@functools.cache
def take_over(laws: Laws, *, damping: bool) -> wp.Function:
    """Function that hands a bond's forces to its contact, and tells the contact's energy [J].

    The energy is that of contact.py, half a step after the last forces; only the tangential spring
    is counted as those left it, from where the pair's account of friction goes on. With a share of
    the stiffness goes the same share of the forces: the spring keeps its elongation.
    """
    shares = laws.moving
    share_of = SHARES.get(laws.partnership)
    pull_of = attraction(laws)

    @inlined()
    def take_over(
        geometry: Geometry,
        candidates: Candidates,
        bonds: Bonds,
        law: Material,
        i: int,
        j: int,
        k: int,
        c: int,
        gap: real,
        total: real,
    ) -> wide:
        code = candidates.code[c]
        share = real(1.0)
        if wp.static(shares):
            share = share_of(-gap, total, law.exponent)
            candidates.share[c] = share
        stiffness = share * law.kn
        if wp.static(laws.avalanche):
            if law.kind == AVALANCHE:
                stiffness *= law.en2
        if wp.static(len(laws.custom) > 0):
            if law.kind >= CUSTOM:
                stiffness = real(0.0)
        taken = wide(real(0.5) * stiffness * gap * gap)
        if wp.static(laws.cohesion):
            radius = curvature_radius(kind_of(code), geometry.radius[i], geometry.radius[j])
            _pull, energy = pull_of(law, gap, radius, real(1.0))
            taken += wide(energy)
        past = remembered(bonds, k, code, wp.static(damping), wide(law.mu))
        if past[3] >= wide(0.0) and gap < real(0.0):
            past *= wide(share)
            candidates.past[c] = past
            if law.kt > real(0.0):
                ft = wide3(past[0], past[1], past[2])
                taken += wp.dot(ft, ft) / wide(real(2.0) * share * law.kt)
        return taken

    return take_over


@functools.cache
def release(laws: Laws, *, damping: bool) -> wp.Kernel:
    """Kernel that breaks the interfaces that yielded and hands what touches to the new lists.

    Released is the elastic energy half a step after the last forces, until when they act, less that
    of the contacts at the same instant. ``damping``: of bonds.
    """
    pair_of = listed_pair(periodic=laws.periodic)
    pack_pair = pack(laws)
    take = take_over(laws, damping=damping)
    shares = laws.moving
    total_shares = total_of(laws.partnership) if shares else None

    @variant
    def release(
        # model
        geometry: Geometry,
        materials: wp.array(dtype=Material),
        # in
        dt: wide,
        step: int,
        ends: wp.array(dtype=wp.int32),
        bodies: Bodies,
        pairs: Pairs,
        # in and out
        candidates: Candidates,
        bonds: Bonds,
    ):
        k = wp.tid()
        if bonds.state[k] != YIELDED:
            return
        energy = bonds.energy[k]
        i = bonds.owner[k]
        j = bonds.partner[k]
        left = energy[0] + wide(0.5) * dt * energy[1]
        lost = energy[2] + wide(0.5) * dt * bonds.power[k]
        taken = wide(0.0)
        pair = pair_of(pairs, ends, i, j)
        if pair >= 0:
            law = materials[pairs.material[pair]]
            start = pairs.start[pair]
            end = pairs.start[pair + 1]
            count = pack_pair(geometry, bodies, candidates, law, i, j, start, end, real(dt))
            total = real(1.0)
            if wp.static(shares):
                total = total_shares(candidates, start, count, law.exponent)
            for slot in range(start, start + count):
                gap = candidates.gap[slot]
                if gap > real(0.0):
                    if wp.static(laws.reaching):
                        taken += wide(at_distance_energy(law.fc, gap, law.dncut))
                else:
                    c = candidates.which[slot]
                    taken += take(geometry, candidates, bonds, law, i, j, k, c, gap, total)
        bonds.energy[k] = wide4(wide(0.0), wide(0.0), lost, left - taken)
        bonds.step[k] = step
        bonds.force[k] = wide3()
        bonds.torque[k] = wide3()
        bonds.torque_partner[k] = wide3()
        bonds.state[k] = BROKEN

    return release
