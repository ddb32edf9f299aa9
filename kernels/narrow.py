"""Narrow phase: gap, normal and contact point of one feature pair of two sphero-polyhedra.

Positions, those of contact points too, are about the partner's centre of mass in world axes. The
normal points from the partner j to the owner i; the contact point is the middle of the overlap,
c = x_i - n (R_i + gap/2).
"""

import functools

import warp as wp
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
from warpdem.kernels.framing import of_owner, of_partner
from warpdem.kernels.over_faces import inside_convex, inside_polygon
from warpdem.kernels.precision import FARTHEST, NARROW, mat33, real, vec3, wide, wide3
from warpdem.kernels.surfaces import height_above
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

FAR = wp.constant(real(FARTHEST))
# sine squared of the angle under which two edges count as parallel: their vertices carry the load
# as far as rounding of the edges' ends allows
PARALLEL = wp.constant(wide(1.0e-8 if NARROW else 1.0e-10))


@wp.struct
class Hit:
    """Signed distance of a feature pair (``FAR`` when apart); the rest is set in overlap.

    Numbers alone: a flag among them would be padded, and copied through memory by the compiler.
    """

    gap: real
    outside: real  # 0 when the closest points lie inside both features, else 1
    normal: vec3
    point: vec3


@wp.func
def apart() -> Hit:
    """No contact, however near."""
    hit = Hit()
    hit.gap = FAR
    hit.outside = real(1.0)
    return hit


@wp.func
def between(p: vec3, q: vec3, radius_i: real, radius_j: real, margin: real, outside: real) -> Hit:
    """Contact of two core points, p on the owner; ``FAR`` beyond ``margin``."""
    d = p - q
    reach = radius_i + radius_j + margin
    square = wp.dot(d, d)
    if square >= reach * reach:
        return apart()
    distance = wp.sqrt(square)
    hit = Hit()
    hit.outside = outside
    hit.gap = distance - radius_i - radius_j
    if distance > real(0.0):
        hit.normal = d * (real(1.0) / distance)
    hit.point = p - hit.normal * (radius_i + real(0.5) * hit.gap)
    return hit


@wp.func
def vertex_edge(
    p: vec3,
    a: vec3,
    b: vec3,
    sign: real,
    radius_v: real,
    radius_e: real,
    margin: real,
    touched: bool,
) -> Hit:
    """Vertex p of the owner (sign 1) or of the partner (-1) against the edge a b of the other."""
    e = b - a
    square = wp.dot(e, e)
    r = wp.dot(p - a, e)
    outside = wp.where(r > real(0.0) and r < square, real(0.0), real(1.0))
    if outside > real(0.0) and not touched:
        return apart()
    foot = a + e * (wp.clamp(r, real(0.0), square) / square)
    if sign > real(0.0):
        return between(p, foot, radius_v, radius_e, margin, outside)
    return between(foot, p, radius_e, radius_v, margin, outside)


@wp.func
def edge_edge(
    p: vec3,
    p1: vec3,
    q: vec3,
    q1: vec3,
    radius_i: real,
    radius_j: real,
    margin: real,
    touched: bool,
) -> Hit:
    """Two edges, both closest points strictly inside; parallel edges are left to their vertices."""
    along = p1 - p
    across = q1 - q
    # edges that are nearly parallel leave little of these products
    u = wide3(along)
    v = wide3(across)
    w = wide3(p - q)
    uu = wp.dot(u, u)
    vv = wp.dot(v, v)
    uv = wp.dot(u, v)
    uw = wp.dot(u, w)
    vw = wp.dot(v, w)
    area = uu * vv - uv * uv
    if area <= PARALLEL * uu * vv:
        return apart()
    s = uv * vw - vv * uw
    t = uu * vw - uv * uw
    inside = s > wide(0.0) and s < area and t > wide(0.0) and t < area
    if not inside and not touched:
        return apart()
    outside = wp.where(inside, real(0.0), real(1.0))
    # the foot of the other point: where edges are nearly parallel two quotients would err apart
    s = wp.clamp(s / area, wide(0.0), wide(1.0))
    t = wp.clamp((vw + s * uv) / vv, wide(0.0), wide(1.0))
    foot = q + across * real(t)
    return between(p + along * real(s), foot, radius_i, radius_j, margin, outside)


@functools.cache
def vertex_face(*, convex: bool, two_sided: bool) -> wp.Function:
    """Function of a vertex against a face; other than convex closed ones cost where they are."""

    @inlined()
    def vertex_face(
        geometry: Geometry,
        rotation: mat33,
        body: int,
        face: int,
        p: wide3,
        radius_v: real,
        margin: real,
        touched: bool,
    ) -> Hit:
        """Vertex p, about the centre of the face's body; the normal points from the face to it."""
        shape = geometry.shape[body]
        scale = geometry.scale[body]
        radius_f = geometry.radius[body]
        at = vec3(p)
        x = wp.transpose(rotation) * at / scale
        index = geometry.face_start[shape] + face
        normal = geometry.normal[index]
        height = wp.dot(normal, x) - geometry.offset[index]
        if wp.static(NARROW):
            # x may be far from the centre of a large body, its height must not be rounded so
            along = wp.dot(wide3(rotation * normal), p)
            height = real(along / wide(scale) - wide(geometry.offset[index]))
        side = real(1.0)
        if wp.static(two_sided):
            if geometry.two_sided[shape] != 0 and height < real(0.0):
                height = -height
                side = real(-1.0)
        gap = height * scale - radius_v - radius_f
        if gap >= margin:
            return apart()
        inside = bool(False)
        if height >= -geometry.depth[index]:
            if wp.static(convex):
                inside = inside_convex(geometry, shape, index, x, height)
            else:
                if geometry.face_convex[index] != 0:
                    inside = inside_convex(geometry, shape, index, x, height)
                else:
                    inside = inside_polygon(geometry, shape, index, x)
        if not inside and not touched:
            return apart()
        hit = Hit()
        hit.gap = gap
        hit.outside = wp.where(inside, real(0.0), real(1.0))
        hit.normal = rotation * normal * side
        hit.point = at - hit.normal * (radius_v + real(0.5) * hit.gap)
        return hit

    return vertex_face


@inlined()
def in_cone(geometry: Geometry, bodies: Bodies, body: int, feature: int, direction: vec3) -> bool:
    """Whether a vertex or edge may touch along ``direction``, away from it: no ghosts."""
    shape = geometry.shape[body]
    index = geometry.vertex_start[shape] + geometry.edge_start[shape] + feature
    x = wp.transpose(bodies.rotation[body]) * direction
    for k in range(geometry.cone_start[index], geometry.cone_start[index + 1]):
        if wp.dot(geometry.cone[k], x) < real(0.0):
            return False
    return True


@wp.func
def vertex_surface(height: real, normal: vec3, p: vec3, radius_v: real) -> Hit:
    """Vertex p, ``height`` above an analytic surface along its normal; at any depth."""
    hit = Hit()
    hit.gap = height - radius_v
    hit.normal = normal
    hit.point = p - normal * (radius_v + real(0.5) * hit.gap)
    return hit


@functools.cache
def feature_pair(
    *, polyhedra: bool, convex: bool, two_sided: bool, cones: bool, surfaces: bool
) -> wp.Function:
    """Function of any feature pair; without ``polyhedra`` only vertices (spheres) are compiled.

    What lies outside its feature is told from what is far only where it ``touched`` before.
    """
    face = vertex_face(convex=convex, two_sided=two_sided)

    @inlined()
    def bare(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        margin: real,
        touched: bool,
        code: wp.int64,
    ) -> Hit:
        kind = kind_of(code)
        a = feature_of_owner(code)
        b = feature_of_partner(code)
        radius_i = geometry.radius[i]
        radius_j = geometry.radius[j]
        arm_i = geometry.arm_start[i]
        arm_j = geometry.arm_start[j]
        if kind == EE:
            ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + a]
            others = geometry.edge[geometry.edge_start[geometry.shape[j]] + b]
            return edge_edge(
                of_owner(bodies, arm_i + ends[0], d),
                of_owner(bodies, arm_i + ends[1], d),
                of_partner(bodies, arm_j + others[0], d),
                of_partner(bodies, arm_j + others[1], d),
                radius_i,
                radius_j,
                margin,
                touched,
            )
        if kind == VF:
            p = d + wide3(bodies.arm[arm_i + a])
            return face(geometry, bodies.rotation[j], j, b, p, radius_i, margin, touched)
        if kind == FV:
            p = wide3(bodies.arm[arm_j + b]) - d
            hit = face(geometry, bodies.rotation[i], i, a, p, radius_j, margin, touched)
            hit.normal = -hit.normal
            hit.point = hit.point + vec3(d)
            return hit
        if kind == VE:
            ends = geometry.edge[geometry.edge_start[geometry.shape[j]] + b]
            return vertex_edge(
                of_owner(bodies, arm_i + a, d),
                of_partner(bodies, arm_j + ends[0], d),
                of_partner(bodies, arm_j + ends[1], d),
                real(1.0),
                radius_i,
                radius_j,
                margin,
                touched,
            )
        if kind == EV:
            ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + a]
            return vertex_edge(
                of_partner(bodies, arm_j + b, d),
                of_owner(bodies, arm_i + ends[0], d),
                of_owner(bodies, arm_i + ends[1], d),
                real(-1.0),
                radius_j,
                radius_i,
                margin,
                touched,
            )
        vertex = of_owner(bodies, arm_i + a, d)
        return between(
            vertex, of_partner(bodies, arm_j + b, d), radius_i, radius_j, margin, real(0.0)
        )

    @inlined()
    def about_partner(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        margin: real,
        touched: bool,
        code: wp.int64,
    ) -> Hit:
        hit = bare(geometry, bodies, i, j, d, margin, touched, code)
        kind = kind_of(code)
        if kind != VF and kind != FV:
            hit.point = hit.point + vec3(d)
        return hit

    anywhere = about_partner if NARROW else bare

    @inlined()
    def in_cones(geometry: Geometry, bodies: Bodies, i: int, j: int, n: vec3, code: wp.int64):
        kind = kind_of(code)
        if kind == VF or kind == FV:
            return True
        a = feature_of_owner(code)
        b = feature_of_partner(code)
        if kind == EV or kind == EE:
            shape = geometry.shape[i]
            a += geometry.vertex_start[shape + 1] - geometry.vertex_start[shape]
        if kind == VE or kind == EE:
            shape = geometry.shape[j]
            b += geometry.vertex_start[shape + 1] - geometry.vertex_start[shape]
        if not in_cone(geometry, bodies, i, a, -n):
            return False
        return in_cone(geometry, bodies, j, b, n)

    @inlined()
    def coned(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        margin: real,
        touched: bool,
        code: wp.int64,
    ) -> Hit:
        hit = anywhere(geometry, bodies, i, j, d, margin, touched, code)
        if hit.outside == real(0.0) and hit.gap < real(0.0):
            if not in_cones(geometry, bodies, i, j, hit.normal, code):
                hit.outside = real(1.0)
        return hit

    @inlined()
    def spherical(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        margin: real,
        touched: bool,
        code: wp.int64,
    ) -> Hit:
        return between(vec3(d), vec3(), geometry.radius[i], geometry.radius[j], margin, real(0.0))

    polyhedral = coned if cones else anywhere
    pair_of = polyhedral if polyhedra else spherical

    @inlined()
    def with_surfaces(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: wide3,
        margin: real,
        touched: bool,
        code: wp.int64,
    ) -> Hit:
        if kind_of(code) != VS:
            return pair_of(geometry, bodies, i, j, d, margin, touched, code)
        p = d
        if wp.static(polyhedra):
            p = d + wide3(bodies.arm[geometry.arm_start[i] + feature_of_owner(code)])
        height, normal = height_above(geometry, bodies, j, p)
        return vertex_surface(height, normal, vec3(p), geometry.radius[i])

    return with_surfaces if surfaces else pair_of
