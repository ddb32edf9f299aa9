"""Conservative filters: whether two bodies, or two features, could touch before the next rebuild.

``reach`` is R_i + R_j + skin: nothing whose cores stay farther apart than that can touch while the
two bodies together move by less than the skin.
"""

import warp as wp
from warpdem.kernels.precision import NARROW, ROUNDING, real, vec3, wide
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

# sine squared of the angle under which two segments count as parallel
PARALLEL = wp.constant(real(1.0e-6 if NARROW else 1.0e-12))


@inlined()
def widened(geometry: Geometry, i: int, j: int, d: vec3, skin: wide) -> real:
    """A skin, and in mixed precision what rounding may hide of it; d = x_i - x_j."""
    grown = real(skin)
    if wp.static(NARROW):
        extent = real(geometry.bound[i]) + wp.length(d)
        if geometry.surface[geometry.shape[j]] == 0:
            extent += real(geometry.bound[j])
        grown += real(wp.static(ROUNDING)) * extent
    return grown


@inlined()
def boxes_near(
    geometry: Geometry, bodies: Bodies, i: int, j: int, centres: vec3, reach: real
) -> bool:
    """Separating-axis test of the two core boxes over their six face normals."""
    shape_i = geometry.shape[i]
    shape_j = geometry.shape[j]
    rotation_i = bodies.rotation[i]
    rotation_j = bodies.rotation[j]
    half_i = geometry.core_half[shape_i] * geometry.scale[i]
    half_j = geometry.core_half[shape_j] * geometry.scale[j]
    middle_i = rotation_i * (geometry.core_middle[shape_i] * geometry.scale[i])
    middle_j = rotation_j * (geometry.core_middle[shape_j] * geometry.scale[j])
    d = centres + middle_i - middle_j
    turn = wp.transpose(rotation_i) * rotation_j
    d_i = wp.transpose(rotation_i) * d
    d_j = wp.transpose(rotation_j) * d
    for k in range(3):
        shadow = real(0.0)
        other = real(0.0)
        for m in range(3):
            shadow += half_j[m] * wp.abs(turn[k, m])
            other += half_i[m] * wp.abs(turn[m, k])
        if wp.abs(d_i[k]) > half_i[k] + shadow + reach:
            return False
        if wp.abs(d_j[k]) > half_j[k] + other + reach:
            return False
    return True


@inlined()
def bodies_near(geometry: Geometry, bodies: Bodies, i: int, j: int, d: vec3, skin: real) -> bool:
    """Whether two bodies could touch within the skin: bounding spheres, then core boxes.

    ``d`` is the centre of i about that of j, or of its image.
    """
    if geometry.large[i] == 0 and geometry.large[j] == 0:
        near = real(geometry.bound[i]) + real(geometry.bound[j]) + skin
        if wp.length_sq(d) > near * near:
            return False
        half_i = geometry.core_half[geometry.shape[i]]
        half_j = geometry.core_half[geometry.shape[j]]
        if wp.length_sq(half_i) + wp.length_sq(half_j) == real(0.0):
            return True  # two spheres
    reach = geometry.radius[i] + geometry.radius[j] + skin
    return boxes_near(geometry, bodies, i, j, d, reach)


@wp.func
def in_box(x: vec3, middle: vec3, half: vec3, reach: real) -> bool:
    """Whether a point lies in a box grown by ``reach``."""
    for k in range(3):
        if wp.abs(x[k] - middle[k]) > half[k] + reach:
            return False
    return True


@wp.func
def boxes_meet(a: vec3, b: vec3, middle: vec3, half: vec3, reach: real) -> bool:
    """Whether the box around the segment a b meets a box grown by ``reach``."""
    for k in range(3):
        if wp.min(a[k], b[k]) > middle[k] + half[k] + reach:
            return False
        if wp.max(a[k], b[k]) < middle[k] - half[k] - reach:
            return False
    return True


@wp.func
def vertex_near_edge(p: vec3, a: vec3, b: vec3, half: real, reach: real, skin: real) -> bool:
    """Distance within ``reach``, foot within ``skin`` of the ends; ``half`` the edge's length."""
    near = half + reach
    if wp.length_sq(p - (a + b) * real(0.5)) > near * near:
        return False
    e = b - a
    w = p - a
    square = wp.dot(e, e)
    r = wp.dot(w, e)
    slack = skin * (half + half)
    if r < -slack or r - square > slack:
        return False
    return wp.length_sq(w - e * wp.clamp(r / square, real(0.0), real(1.0))) <= reach * reach


@wp.func
def between_segments(p: vec3, p1: vec3, q: vec3, q1: vec3) -> vec3:
    """Shortest vector from segment q q1 to segment p p1.

    Ericson (2005), Real-Time Collision Detection, 5.1.9.
    """
    u = p1 - p
    v = q1 - q
    w = p - q
    uu = wp.dot(u, u)
    vv = wp.dot(v, v)
    uv = wp.dot(u, v)
    uw = wp.dot(u, w)
    vw = wp.dot(v, w)
    area = uu * vv - uv * uv
    s = real(0.0)
    if area > PARALLEL * uu * vv:
        s = wp.clamp((uv * vw - uw * vv) / area, real(0.0), real(1.0))
    t = (uv * s + vw) / vv
    if t < real(0.0):
        t = real(0.0)
        s = wp.clamp(-uw / uu, real(0.0), real(1.0))
    elif t > real(1.0):
        t = real(1.0)
        s = wp.clamp((uv - uw) / uu, real(0.0), real(1.0))
    return w + u * s - v * t


@wp.func
def edges_near(p: vec3, p1: vec3, q: vec3, q1: vec3, halves: real, reach: real) -> bool:
    """Whether two segments, half as long together as ``halves``, are within ``reach``.

    First their bounding spheres, then their distance.
    """
    near = halves + reach
    if wp.length_sq(p + p1 - q - q1) > real(4.0) * near * near:
        return False
    return wp.length_sq(between_segments(p, p1, q, q1)) <= reach * reach


@inlined()
def vertex_near_face(
    geometry: Geometry, shape: int, face: int, x: vec3, scale: real, reach: real, skin: real
) -> bool:
    """Height within ``reach`` (or behind the face within its depth), foot within ``skin`` of it.

    ``x`` is in the unscaled frame of the face's shape.
    """
    height = (wp.dot(geometry.normal[face], x) - geometry.offset[face]) * scale
    if height > reach:
        return False
    if geometry.face_convex[face] == 0 or geometry.two_sided[shape] != 0:
        if geometry.two_sided[shape] != 0 and height < -reach:
            return False
        if geometry.face_convex[face] == 0:
            return True
    elif height < -(geometry.depth[face] * scale + skin):
        return False
    # over the face its own sides bound it; behind it the planes halfway to its neighbours, which
    # may lie farther out the deeper the vertex is
    slack = skin + wp.max(real(0.0), -height)
    deep = height < -skin and geometry.two_sided[shape] == 0
    if deep:
        slack = skin
    for side in range(geometry.side_start[face], geometry.side_start[face + 1]):
        plane = geometry.side_above[side]
        if deep:
            plane = geometry.side_below[side]
        out = plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] - plane[3]
        if out * scale > slack:
            return False
    return True
