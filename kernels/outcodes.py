"""Which features of two bodies come near the other body's box at all: the only ones to be paired.

An outcode has a bit for each side of the other body's core box, grown by the reach, beyond which a
vertex lies. An edge whose ends share a bit is beyond that side too.

A set of vertices, edges or faces has a bit for each: shapes with more than 64 are searched through
a tree.
"""

import warp as wp
from warpdem.kernels.bounds import in_box
from warpdem.kernels.precision import NARROW, real, vec3
from warpdem.kernels.surfaces import is_surface
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

NONE = wp.constant(wp.uint64(0))
ONE = wp.constant(wp.uint64(1))
SET_LIMIT = 64
# edges a hair farther out are kept: their distances are rounded in another way than outcodes
WIDER = wp.constant(1.0 + (1.0e-5 if NARROW else 1.0e-9))


@wp.func_native("""
    #if defined(__CUDA_ARCH__)
        return __ffsll((long long)features) - 1;
    #else
        return __builtin_ctzll(features);
    #endif
    """)
def lowest(features: wp.uint64) -> int:
    """First feature of a set that is not empty."""
    ...


@wp.func_native("""
    #if defined(__CUDA_ARCH__)
        return __popcll(features);
    #else
        return __builtin_popcountll(features);
    #endif
    """)
def size(features: wp.uint64) -> int:
    """Number of features in a set."""
    ...


@wp.func
def bit(feature: int) -> wp.uint64:
    """The set of one feature."""
    return ONE << wp.uint64(feature)


@wp.func
def outcode(x: vec3, grown: vec3) -> int:
    """Sides of a box of half size ``grown`` beyond which x, about its middle, lies; a bit each."""
    code = int(0)
    for k in range(3):
        code = code | wp.where(x[k] > grown[k], 1 << k, 0)
        code = code | wp.where(x[k] < -grown[k], 8 << k, 0)
    return code


@inlined()
def near_box(geometry: Geometry, bodies: Bodies, i: int, j: int, d: vec3, reach: real):
    """Active vertices of i, and active edges, within ``reach`` of the core box of j; d = x_i - x_j.

    An edge may miss the box and be kept: only what lies beyond one side is left out.
    """
    vertices = NONE
    edges = NONE
    shape = geometry.shape[i]
    scale = geometry.scale[j]
    middle = geometry.core_middle[geometry.shape[j]] * scale
    half = geometry.core_half[geometry.shape[j]] * scale
    grown = half + vec3(reach * real(WIDER))
    inverse = wp.transpose(bodies.rotation[j])
    codes = wp.zeros(shape=(SET_LIMIT,), dtype=wp.uint8)
    arm = geometry.arm_start[i]
    vertex = geometry.vertex_start[shape]
    for a in range(geometry.vertex_start[shape + 1] - vertex):
        x = inverse * (d + bodies.arm[arm + a])
        code = outcode(x - middle, grown)
        codes[a] = wp.uint8(code)
        if code == 0 and geometry.vertex_active[vertex + a] != 0:
            if in_box(x, middle, half, reach):
                vertices = vertices | bit(a)
    edge = geometry.edge_start[shape]
    for a in range(geometry.edge_start[shape + 1] - edge):
        ends = geometry.edge[edge + a]
        if geometry.edge_active[edge + a] != 0 and (codes[ends[0]] & codes[ends[1]]) == wp.uint8(0):
            edges = edges | bit(a)
    return vertices, edges


@inlined()
def searched_whole(geometry: Geometry, j: int) -> bool:
    """Whether the partner is neither a surface nor searched through a tree."""
    return not is_surface(geometry, j) and geometry.tree[geometry.shape[j]] == wp.uint64(0)


@wp.struct
class Near:
    """Sets of the features of two bodies that are near the other one's box."""

    owner_vertices: wp.uint64
    owner_edges: wp.uint64
    partner_vertices: wp.uint64
    partner_edges: wp.uint64


@inlined()
def features_near(geometry: Geometry, bodies: Bodies, i: int, j: int, d: vec3, reach: real) -> Near:
    """Features of i near the box of j and the other way round; d = x_i - x_j."""
    near = Near()
    vertices_i, edges_i = near_box(geometry, bodies, i, j, d, reach)
    vertices_j, edges_j = near_box(geometry, bodies, j, i, -d, reach)
    near.owner_vertices = vertices_i
    near.owner_edges = edges_i
    near.partner_vertices = vertices_j
    near.partner_edges = edges_j
    return near
