"""How far two bodies must move, together, before a feature pair of theirs can touch.

A lower bound in all places, cheap and without a square root wasted on what touches: from it the
hot list of a pair follows (see refresh.py). What lies outside its feature can touch no sooner than
its foot has come over it.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import between_segments
from warpdem.kernels.codes import (
    EE,
    EV,
    FV,
    VE,
    VF,
    VS,
    feature_of_owner,
    feature_of_partner,
    kind_of,
)
from warpdem.kernels.narrow import FAR
from warpdem.kernels.precision import mat33, real, vec3, wide3
from warpdem.kernels.surfaces import height_above
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry


@wp.func
def vertex_from_edge(p: vec3, a: vec3, b: vec3, radii: real) -> real:
    """Of a vertex p and the edge a b; ``radii`` of both together [m]."""
    e = b - a
    w = p - a
    square = wp.dot(e, e)
    r = wp.dot(w, e)
    along = wp.clamp(r / square, real(0.0), real(1.0))
    overhang = wp.max(-r, r - square) / wp.sqrt(square)
    return wp.max(wp.length(w - e * along) - radii, overhang)


@inlined()
def vertex_from_face(
    geometry: Geometry, rotation: mat33, body: int, face: int, p: vec3, radii: real
) -> real:
    """Of a vertex p, about the centre of the face's body, and one of its faces."""
    shape = geometry.shape[body]
    scale = geometry.scale[body]
    x = wp.transpose(rotation) * p / scale
    index = geometry.face_start[shape] + face
    height = wp.dot(geometry.normal[index], x) - geometry.offset[index]
    two_sided = geometry.two_sided[shape] != 0
    if two_sided:
        height = wp.abs(height)
    gap = height * scale - radii
    if geometry.face_convex[index] == 0:
        return gap
    above = -FAR
    below = -FAR
    for side in range(geometry.side_start[index], geometry.side_start[index + 1]):
        plane = geometry.side_above[side]
        above = wp.max(above, plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] - plane[3])
        plane = geometry.side_below[side]
        below = wp.max(below, plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] - plane[3])
    outside = above
    if not two_sided:
        # it comes over the face, or behind it where it is nearer than the others
        over = wp.max(above, -height)
        behind = wp.max(wp.max(below, height), -geometry.depth[index] - height)
        outside = wp.min(over, behind)
    return wp.max(gap, outside * scale)


@functools.cache
def clearance(*, surfaces: bool) -> wp.Function:
    """Function of the least path [m] after which a feature pair can touch; negative: it may now."""

    @inlined()
    def clearance(
        geometry: Geometry, bodies: Bodies, i: int, j: int, d: vec3, code: wp.int64
    ) -> real:
        kind = kind_of(code)
        a = feature_of_owner(code)
        b = feature_of_partner(code)
        radii = geometry.radius[i] + geometry.radius[j]
        arm_i = geometry.arm_start[i]
        arm_j = geometry.arm_start[j]
        if kind == EE:
            ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + a]
            others = geometry.edge[geometry.edge_start[geometry.shape[j]] + b]
            away = between_segments(
                d + bodies.arm[arm_i + ends[0]],
                d + bodies.arm[arm_i + ends[1]],
                bodies.arm[arm_j + others[0]],
                bodies.arm[arm_j + others[1]],
            )
            return wp.length(away) - radii
        if kind == VF:
            p = d + bodies.arm[arm_i + a]
            return vertex_from_face(geometry, bodies.rotation[j], j, b, p, radii)
        if kind == FV:
            p = bodies.arm[arm_j + b] - d
            return vertex_from_face(geometry, bodies.rotation[i], i, a, p, radii)
        if kind == VE:
            ends = geometry.edge[geometry.edge_start[geometry.shape[j]] + b]
            p = d + bodies.arm[arm_i + a]
            return vertex_from_edge(
                p, bodies.arm[arm_j + ends[0]], bodies.arm[arm_j + ends[1]], radii
            )
        if kind == EV:
            ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + a]
            p = bodies.arm[arm_j + b] - d
            return vertex_from_edge(
                p, bodies.arm[arm_i + ends[0]], bodies.arm[arm_i + ends[1]], radii
            )
        p = d + bodies.arm[arm_i + a]
        if wp.static(surfaces):
            if kind == VS:
                height, _normal = height_above(geometry, bodies, j, wide3(p))
                return height - geometry.radius[i]
        return wp.length(p - bodies.arm[arm_j + b]) - radii

    return clearance
