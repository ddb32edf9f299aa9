"""What becomes of an interface that has yielded: its contacts take over, the rest is released."""

import functools

import warp as wp
from warpdem.kernels.bonding import BROKEN, YIELDED
from warpdem.kernels.kinematics import Flow, kinematics
from warpdem.kernels.laws import AVALANCHE
from warpdem.kernels.narrow import feature_pair
from warpdem.kernels.neighbours import lower_bound
from warpdem.kernels.precision import real, vec3, vec4
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
def remembered(bonds: Bonds, k: int, code: wp.int64, damping: bool, mu: real) -> vec4:
    """Tangential force under mu |fn| and fn of the bond of a feature pair; -1 without one.

    The bond must have been closed in its last step.
    """
    for bond in range(bonds.start[k], bonds.start[k + 1]):
        if bonds.code[bond] == code and bonds.gap[bond] < real(0.0):
            held = bonds.held[bond]
            ft = vec3(held[0], held[1], held[2])
            if damping:
                ft += bonds.viscous[bond]
            ft = radial_return(ft, mu * wp.abs(held[3]))
            return vec4(ft[0], ft[1], ft[2], wp.max(held[3], real(0.0)))
    return vec4(real(0.0), real(0.0), real(0.0), real(-1.0))


@functools.cache
def release(
    *,
    polyhedra: bool,
    convex: bool,
    two_sided: bool,
    cones: bool,
    damping: bool,
    avalanche: bool,
    periodic: bool,
) -> wp.Kernel:
    """Kernel that breaks the interfaces that yielded and hands what touches to the new lists.

    Released is the elastic energy half a step after the last forces, until when they act, less that
    of the contacts at the same instant.
    """
    gap_of = feature_pair(
        polyhedra=polyhedra, convex=convex, two_sided=two_sided, cones=cones, surfaces=False
    )
    motion_at = kinematics(predicted=False, deforming=False)
    pair_of = listed_pair(periodic=periodic)

    @variant
    def release(
        # model
        geometry: Geometry,
        materials: wp.array(dtype=Material),
        # in
        dt: real,
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
        left = energy[0] + real(0.5) * dt * energy[1]
        lost = energy[2] + real(0.5) * dt * bonds.power[k]
        taken = real(0.0)
        pair = pair_of(pairs, ends, i, j)
        if pair >= 0:
            law = materials[pairs.material[pair]]
            d = bodies.position[i] - bodies.position[j]
            for c in range(pairs.start[pair], pairs.start[pair + 1]):
                hit = gap_of(geometry, bodies, i, j, d, real(0.0), candidates.code[c])
                if hit.gap < real(0.0) and hit.admissible:
                    past = remembered(bonds, k, candidates.code[c], wp.static(damping), law.mu)
                    motion = motion_at(bodies, Flow(), i, j, d, hit.normal, hit.point, dt)
                    overlap = wp.max(-hit.gap - real(0.5) * dt * motion.approach, real(0.0))
                    stiffness = real(law.kn)
                    if wp.static(avalanche):
                        candidates.last[c] = hit.gap
                        if law.kind == AVALANCHE:
                            stiffness *= law.en2
                    taken += real(0.5) * stiffness * overlap * overlap
                    if past[3] >= real(0.0):
                        candidates.past[c] = past
                        if law.kt > real(0.0):
                            ft = vec3(past[0], past[1], past[2])
                            taken += wp.dot(ft, ft) / (real(2.0) * law.kt)
        bonds.energy[k] = vec4(real(0.0), real(0.0), lost, left - taken)
        bonds.step[k] = step
        bonds.force[k] = vec3()
        bonds.torque[k] = vec3()
        bonds.torque_partner[k] = vec3()
        bonds.state[k] = BROKEN

    return release
