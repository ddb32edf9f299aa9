"""Whether a vertex lies over a face, in the frame of the face's shape."""

import warp as wp
from warpdem.kernels.precision import NARROW, real, vec3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Geometry

# where another face is nearer by such a part, a vertex behind a face does not belong to it
NEARER = wp.constant(real(1.0 - (1.0e-5 if NARROW else 1.0e-9)))


@inlined()
def inside_convex(geometry: Geometry, shape: int, face: int, x: vec3, height: real) -> bool:
    """Whether x (shape frame) lies over a convex face, or behind it nearer than its neighbours.

    Of a convex solid: nearer than all other faces, which a vertex beyond one of them is not.
    """
    for side in range(geometry.side_start[face], geometry.side_start[face + 1]):
        plane = geometry.side_above[side]
        if height < real(0.0):
            plane = geometry.side_below[side]
        out = plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] - plane[3]
        if out > real(0.0):
            return False
        if out == real(0.0):
            if geometry.side_open[side] != 0:
                return False
    if height < real(0.0) and geometry.face_convex[face] == 2:
        for other in range(geometry.face_start[shape], geometry.face_start[shape + 1]):
            if wp.dot(geometry.normal[other], x) - geometry.offset[other] > height * NEARER:
                return False
    return True


@inlined()
def inside_polygon(geometry: Geometry, shape: int, face: int, x: vec3) -> bool:
    """Even-odd test of the projection of x on a face of any form, with holes; borders half open."""
    n = geometry.normal[face]
    # the two axes on which the face has the largest shadow
    i = int(0)
    j = int(1)
    if wp.abs(n[0]) >= wp.abs(n[1]) and wp.abs(n[0]) >= wp.abs(n[2]):
        i = 1
        j = 2
    elif wp.abs(n[1]) >= wp.abs(n[2]):
        i = 0
        j = 2
    foot = x - n * (wp.dot(n, x) - geometry.offset[face])
    first = geometry.vertex_start[shape]
    odd = bool(False)
    for side in range(geometry.side_start[face], geometry.side_start[face + 1]):
        ends = geometry.side_vertex[side]
        a = geometry.vertex[first + ends[0]]
        b = geometry.vertex[first + ends[1]]
        if (a[j] > foot[j]) != (b[j] > foot[j]):
            if foot[i] < a[i] + (foot[j] - a[j]) / (b[j] - a[j]) * (b[i] - a[i]):
                odd = not odd
    return odd
