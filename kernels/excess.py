"""Energy of two edges: only what they overlap more than their ends do.

Where two edges cross, a sub-contact begins and ends as the crossing passes an end of one of them.
There the end itself is as near, and counts already; nearly parallel edges cross anywhere. So two
edges of overlap D, whose four ends overlap the other edge by D_k (0 where apart), have the energy
    U = kn/2 D^2 prod_k (1 - x_k^2),  x_k = D_k / D <= 1,
which fades with its gradient as the crossing comes to an end. Of its force
    kn w D n - kn sum_k x_k P_k D n_k,  P_k = prod_(l != k) (1 - x_l^2),
the sub-contact has what is left along n, the share w - sum_k x_k P_k of the stiffness; the rest
turns the bodies and acts by itself, without dashpot and friction.
"""

import warp as wp
from warpdem.kernels.codes import EE, VV, feature_of_owner, feature_of_partner, kind_of
from warpdem.kernels.framing import of_owner, of_partner
from warpdem.kernels.precision import NARROW, real, vec3, vec4, wide3
from warpdem.kernels.regions import restricted, vertex_count
from warpdem.kernels.variant import inlined, place
from warpdem.kernels.views import Bodies, Candidates, Geometry


@wp.struct
class Excess:
    """What acts beside the sub-contacts, per stiffness."""

    force: vec3  # on the owner [m]
    torque: vec3  # of it about the partner's centre [m^2]
    square: real  # twice its energy [m^2]


@wp.func
def nearest_on(p: vec3, a: vec3, e: vec3, square: real) -> vec3:
    """Point of the segment from a along e, of squared length ``square``, that is nearest to p."""
    return a + e * wp.clamp(wp.dot(p - a, e) / square, real(0.0), real(1.0))


@wp.func
def others(rest: vec4, k: int) -> real:
    """Product of all but the k-th of four numbers."""
    product = real(1.0)
    for m in range(4):
        if m != k:
            product *= rest[m]
    return product


@wp.func
def pull(p: vec3, q: vec3, shift: vec3, size: real) -> Excess:
    """A force towards q on a point p of the owner, both about a point at ``shift``."""
    away = p - q
    found = Excess()
    distance = wp.length(away)
    if distance == real(0.0):
        return found
    found.force = away * (-size / distance)
    found.torque = wp.cross(p + shift, found.force)
    return found


@wp.func
def edges_share(
    p: vec3, p1: vec3, q: vec3, q1: vec3, shift: vec3,
    reach: real, overlap: real, normal: vec3, point: vec3,
):  # fmt: skip
    """Share of two edges that cross, and what they do beside it.

    Their ends are about the point ``shift`` from the partner's centre.
    """
    found = Excess()
    u = p1 - p
    v = q1 - q
    uu = wp.dot(u, u)
    vv = wp.dot(v, v)
    a0 = nearest_on(p, q, v, vv)
    a1 = nearest_on(p1, q, v, vv)
    b0 = nearest_on(q, p, u, uu)
    b1 = nearest_on(q1, p, u, uu)
    least = reach * reach
    s0 = wp.length_sq(p - a0)
    s1 = wp.length_sq(p1 - a1)
    s2 = wp.length_sq(q - b0)
    s3 = wp.length_sq(q1 - b1)
    if wp.min(wp.min(s0, s1), wp.min(s2, s3)) >= least:
        return real(1.0), found
    away = vec4(wp.sqrt(s0), wp.sqrt(s1), wp.sqrt(s2), wp.sqrt(s3))
    x = vec4()
    rest = vec4()
    for k in range(4):
        x[k] = wp.clamp((reach - away[k]) / overlap, real(0.0), real(1.0))
        rest[k] = real(1.0) - x[k] * x[k]
    left = rest[0] * rest[1] * rest[2] * rest[3]
    found.square = left * overlap * overlap
    whole = left
    share = left
    for k in range(4):
        part = x[k] * others(rest, k)
        whole += x[k] * part
        share += (x[k] - real(1.0)) * part
    share = wp.max(share, real(0.0))
    found.square -= share * overlap * overlap
    found.force = normal * ((whole - share) * overlap)
    found.torque = wp.cross(point, found.force)
    for k in range(4):
        if x[k] > real(0.0):
            own = p
            other = a0
            if k == 1:
                own = p1
                other = a1
            elif k == 2:
                own = b0
                other = q
            elif k == 3:
                own = b1
                other = q1
            end = pull(own, other, shift, x[k] * others(rest, k) * overlap)
            found.force += end.force
            found.torque += end.torque
    return share, found


@inlined()
def share_out(
    geometry: Geometry,
    bodies: Bodies,
    candidates: Candidates,
    i: int,
    j: int,
    d: wide3,
    start: int,
    touching: int,
) -> Excess:
    """Set the shares of a pair's sub-contacts; what acts beside them.

    Those of a terrain are left whole: vertices that may not act there replace no edge.
    """
    total = Excess()
    if restricted(geometry, i) or restricted(geometry, j):
        for slot in range(start, start + touching):
            candidates.share[place(candidates.which[slot])] = real(1.0)
        return total
    shift = vec3()
    if wp.static(NARROW):
        shift = vec3(d)
    arm_i = geometry.arm_start[i]
    arm_j = geometry.arm_start[j]
    for slot in range(start, start + touching):
        c = place(candidates.which[slot])
        code = candidates.code[c]
        kind = kind_of(code)
        share = real(1.0)
        overlap = -candidates.gap[slot]
        if kind == EE and overlap > real(0.0):
            ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + feature_of_owner(code)]
            edge = geometry.edge_start[geometry.shape[j]] + feature_of_partner(code)
            others_ends = geometry.edge[edge]
            share, beside = edges_share(
                of_owner(bodies, arm_i + ends[0], d),
                of_owner(bodies, arm_i + ends[1], d),
                of_partner(bodies, arm_j + others_ends[0], d),
                of_partner(bodies, arm_j + others_ends[1], d),
                shift,
                geometry.radius[i] + geometry.radius[j],
                overlap,
                candidates.normal[slot],
                candidates.point[slot],
            )
            total.force += beside.force
            total.torque += beside.torque
            total.square += beside.square
        elif kind == VV:
            a = feature_of_owner(code)
            b = feature_of_partner(code)
            share = vertex_count(geometry, bodies, i, j, d, a, b)
        candidates.share[c] = share
    return total
