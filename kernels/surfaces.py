"""Analytic surfaces of fixed or driven bodies: a plane, the inside of a cylinder or of a ball.

They are infinite, or containers: every vertex of another body is tested against them, nothing
else, which is exact for convex bodies.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import widened
from warpdem.kernels.codes import CYLINDER, PLANE, VS, emit
from warpdem.kernels.precision import mat33, real, vec3, wide, wide3
from warpdem.kernels.rotation import arc
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

AXIS = wp.constant(vec3(real(0.0), real(0.0), real(1.0)))
WIDE_AXIS = wp.constant(wide3(wide(0.0), wide(0.0), wide(1.0)))


@wp.func
def height_over(surface: int, radius: real, rotation: mat33, p: wide3):
    """Distance of p, about the surface's origin, from it on its free side [m], and the normal."""
    axis = wide3(rotation * AXIS)
    height = wp.dot(axis, p)
    normal = axis
    if surface != PLANE:
        outward = p
        if surface == CYLINDER:
            outward = p - axis * height
        away = wp.length(outward)
        height = wide(radius) - away
        normal = -outward
        if away > wide(0.0):
            normal = normal / away
    return real(height), vec3(normal)


@inlined()
def height_above(geometry: Geometry, bodies: Bodies, body: int, p: wide3):
    """``height_over`` the surface of a body, p about its origin in world axes."""
    shape = geometry.shape[body]
    radius = geometry.surface_radius[shape] * geometry.scale[body]
    height, normal = height_over(geometry.surface[shape], radius, bodies.rotation[body], p)
    return height, normal


@inlined()
def surface_near(geometry: Geometry, bodies: Bodies, i: int, j: int, skin: wide) -> bool:
    """Whether the bounding sphere of i comes within the skin of the surface j."""
    d = bodies.position[i] - bodies.position[j]
    height, _normal = height_above(geometry, bodies, j, d)
    return height <= real(geometry.bound[i]) + widened(geometry, i, j, vec3(d), skin)


@inlined()
def is_surface(geometry: Geometry, body: int) -> bool:
    """Whether a body is an analytic surface."""
    return geometry.surface[geometry.shape[body]] != 0


@inlined()
def tilt(geometry: Geometry, bodies: Bodies, body: int) -> wide:
    """How far a surface has turned since the lists were made, but about its own axis [rad]."""
    surface = geometry.surface[geometry.shape[body]]
    if surface == 0:
        return arc(bodies.orientation[body], bodies.listed_orientation[body])
    if surface == PLANE or surface == CYLINDER:
        now = wp.quat_rotate(bodies.orientation[body], WIDE_AXIS)
        return wp.length(now - wp.quat_rotate(bodies.listed_orientation[body], WIDE_AXIS))
    return wide(0.0)


@functools.cache
def vertices_above(*, fill: bool) -> wp.Function:
    """Function: vertices of the owner against the partner's surface."""
    put = emit(fill=fill)

    @inlined()
    def vertices_above(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: vec3,
        reach: real,
        code: wp.array(dtype=wp.int64),
        start: int,
    ) -> int:
        """``d`` is x_i - x_j."""
        n = start
        arm = geometry.arm_start[i]
        vertex = geometry.vertex_start[geometry.shape[i]]
        for a in range(geometry.vertex_start[geometry.shape[i] + 1] - vertex):
            if geometry.vertex_active[vertex + a] != 0:
                height, _normal = height_above(geometry, bodies, j, wide3(d + bodies.arm[arm + a]))
                if height <= reach:
                    n = put(code, n, VS, a, 0)
        return n

    return vertices_above
