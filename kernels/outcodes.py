"""Which features of two bodies come near the other body's box at all: the only ones to be paired.

An outcode has a bit for each side of the other body's core box, grown by the reach, beyond which a
vertex lies. An edge whose ends share a bit is beyond that side too.
"""

import warp as wp
from warpdem.kernels.bounds import in_box
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.surfaces import is_surface
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

# a set of features of a shape without a tree: a bit each
FEATURE_ROOM = 128
Few = wp.types.vector(length=2, dtype=wp.uint64)

ONE = wp.constant(wp.uint64(1))
# edges a hair farther out are kept: their distances are rounded in another way than outcodes
WIDER = wp.constant(1.0 + 1.0e-9)


@wp.func_native("""
    #if defined(__CUDA_ARCH__)
        #define LOWEST(bits) (__ffsll((long long)(bits)) - 1)
    #else
        #define LOWEST(bits) __builtin_ctzll(bits)
    #endif
    unsigned long long low = start < 64 ? few[0] >> start << start : 0;
    unsigned long long high = start < 64 ? few[1] : start < 128 ? few[1] >> (start - 64) << (start - 64) : 0;
    return low ? LOWEST(low) : high ? 64 + LOWEST(high) : 128;
    #undef LOWEST
    """)
def following(few: Few, start: int) -> int:
    """First feature of a set that is not below ``start``, or FEATURE_ROOM."""
    ...


@wp.func_native("""
    #if defined(__CUDA_ARCH__)
        return __popcll(few[0]) + __popcll(few[1]);
    #else
        return __builtin_popcountll(few[0]) + __builtin_popcountll(few[1]);
    #endif
    """)
def size(few: Few) -> int:
    """Number of features in a set."""
    ...


@wp.func
def joined(few: Few, feature: int) -> Few:
    """The set with one feature more."""
    low = few[0]
    high = few[1]
    bit = ONE << wp.uint64(feature & 63)
    if feature < 64:
        low = low | bit
    else:
        high = high | bit
    return Few(low, high)


@wp.func
def all_of(count: int) -> Few:
    """The set of the first ``count`` features."""
    few = Few()
    for a in range(count):
        few = joined(few, a)
    return few


@wp.func
def outcode(x: vec3, grown: vec3) -> int:
    """Sides of a box of half size ``grown`` beyond which x, about its middle, lies; a bit each."""
    code = int(0)
    for k in range(3):
        if x[k] > grown[k]:
            code = code | (1 << k)
        if x[k] < -grown[k]:
            code = code | (8 << k)
    return code


@inlined()
def near_box(geometry: Geometry, bodies: Bodies, i: int, j: int, d: vec3, reach: real):
    """Active vertices of i, and active edges, within ``reach`` of the core box of j; d = x_i - x_j.

    An edge may be missed by the box and kept: only what lies beyond one side is left out.
    """
    vertices = Few()
    edges = Few()
    shape = geometry.shape[i]
    scale = geometry.scale[j]
    middle = geometry.core_middle[geometry.shape[j]] * scale
    half = geometry.core_half[geometry.shape[j]] * scale
    grown = half + vec3(reach * real(WIDER))
    inverse = wp.transpose(bodies.rotation[j])
    codes = wp.zeros(shape=(FEATURE_ROOM,), dtype=wp.uint8)
    arm = geometry.arm_start[i]
    vertex = geometry.vertex_start[shape]
    for a in range(geometry.vertex_start[shape + 1] - vertex):
        x = inverse * (d + bodies.arm[arm + a])
        code = outcode(x - middle, grown)
        codes[a] = wp.uint8(code)
        if code == 0 and geometry.vertex_active[vertex + a] != 0:
            if in_box(x, middle, half, reach):
                vertices = joined(vertices, a)
    edge = geometry.edge_start[shape]
    for a in range(geometry.edge_start[shape + 1] - edge):
        ends = geometry.edge[edge + a]
        if geometry.edge_active[edge + a] != 0 and (codes[ends[0]] & codes[ends[1]]) == wp.uint8(0):
            edges = joined(edges, a)
    return vertices, edges


@inlined()
def face_count(geometry: Geometry, body: int) -> int:
    """Number of faces of a body."""
    shape = geometry.shape[body]
    return geometry.face_start[shape + 1] - geometry.face_start[shape]


@inlined()
def searched_whole(geometry: Geometry, j: int) -> bool:
    """Whether the partner is neither a surface nor searched through a tree."""
    return not is_surface(geometry, j) and geometry.tree[geometry.shape[j]] == wp.uint64(0)


@wp.struct
class Near:
    """Features of the two bodies of a pair that are near the other one's box."""

    owner_vertices: Few
    owner_edges: Few
    partner_vertices: Few
    partner_edges: Few


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
