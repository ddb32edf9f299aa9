"""Tests of the feature pairs of two bodies, each done once: a bit for each pair, in order of codes.

The bits of a body pair are rows of the owner's features and columns of the partner's, of each kind
in turn: vertices with vertices, edges, faces, and edges with edges.
"""

import warp as wp
from warpdem.kernels.bounds import edges_near, vertex_near_edge, vertex_near_face
from warpdem.kernels.codes import EE, EV, FV, VE, VF, VV, encode
from warpdem.kernels.outcodes import (
    FEATURE_ROOM,
    ONE,
    WIDER,
    Few,
    Near,
    all_of,
    face_count,
    following,
    size,
)
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry


@wp.func
def mark(hits: wp.array(dtype=wp.uint64), first: int, at: int):
    """Set the bit of a feature pair; ``first`` is the first word of the body pair."""
    word = first + (at >> 6)
    hits[word] = hits[word] | (ONE << wp.uint64(at & 63))


@wp.func
def marked(hits: wp.array(dtype=wp.uint64), first: int, at: int) -> bool:
    """Whether the bit of a feature pair is set."""
    return ((hits[first + (at >> 6)] >> wp.uint64(at & 63)) & ONE) != wp.uint64(0)


@wp.func
def first_test(kind: int, near: Near, faces_i: int, faces_j: int) -> int:
    """Place of the first bit of a kind; of EE + 1: how many bits there are."""
    vertices_i = size(near.owner_vertices)
    vertices_j = size(near.partner_vertices)
    edges_i = size(near.owner_edges)
    edges_j = size(near.partner_edges)
    at = int(0)
    if kind > VV:
        at += vertices_i * vertices_j
    if kind > VE:
        at += vertices_i * edges_j
    if kind > EV:
        at += edges_i * vertices_j
    if kind > VF:
        at += vertices_i * faces_j
    if kind > FV:
        at += faces_i * vertices_j
    if kind > EE:
        at += edges_i * edges_j
    return at


@inlined()
def test_vertices(
    geometry: Geometry,
    bodies: Bodies,
    i: int,
    j: int,
    d: vec3,
    vertices_i: Few,
    vertices_j: Few,
    edges_j: Few,
    swapped: bool,
    at_vertex: int,
    at_edge: int,
    at_face: int,
    reach: real,
    skin: real,
    first: int,
    hits: wp.array(dtype=wp.uint64),
) -> int:
    """Vertices of i with the edges and faces of j, with its vertices too unless ``swapped``.

    ``d`` is x_i - x_j; ``swapped`` when i is the partner: its vertices are the columns then.
    ``at_vertex``, ``at_edge``, ``at_face``: places of the first bits. Returns the number of hits.
    """
    n = int(0)
    shape = geometry.shape[j]
    scale = geometry.scale[j]
    inverse = wp.transpose(bodies.rotation[j])
    arm = geometry.arm_start[j]
    edge = geometry.edge_start[shape]
    face = geometry.face_start[shape]
    faces = geometry.face_start[shape + 1] - face
    # steps from one vertex of i to the next, and from one feature of j to the next
    over_edges = size(edges_j)
    over_faces = faces
    step = int(1)
    if swapped:
        over_edges = 1
        over_faces = 1
        step = size(vertices_i)
    row = int(0)
    a = following(vertices_i, 0)
    while a < FEATURE_ROOM:
        p = d + bodies.arm[geometry.arm_start[i] + a]
        if not swapped:
            at = at_vertex + row * size(vertices_j)
            b = following(vertices_j, 0)
            while b < FEATURE_ROOM:
                if wp.length_sq(p - bodies.arm[arm + b]) <= reach * reach:
                    mark(hits, first, at)
                    n += 1
                at += 1
                b = following(vertices_j, b + 1)
        at = at_edge + row * over_edges
        b = following(edges_j, 0)
        while b < FEATURE_ROOM:
            ends = geometry.edge[edge + b]
            q = bodies.arm[arm + ends[0]]
            q1 = bodies.arm[arm + ends[1]]
            if vertex_near_edge(p, q, q1, geometry.edge_half[edge + b] * scale, reach, skin):
                mark(hits, first, at)
                n += 1
            at += step
            b = following(edges_j, b + 1)
        at = at_face + row * over_faces
        x = inverse * p / scale
        for b in range(faces):
            if vertex_near_face(geometry, shape, face + b, x, scale, reach, skin):
                mark(hits, first, at)
                n += 1
            at += step
        row += 1
        a = following(vertices_i, a + 1)
    return n


@wp.func
def boxes_apart(p: vec3, p1: vec3, q: vec3, q1: vec3, reach: real) -> bool:
    """Whether the boxes around two segments are farther apart than ``reach`` along some axis."""
    for k in range(3):
        if wp.min(q[k], q1[k]) > wp.max(p[k], p1[k]) + reach:
            return True
        if wp.max(q[k], q1[k]) < wp.min(p[k], p1[k]) - reach:
            return True
    return False


@inlined()
def test_edges(
    geometry: Geometry,
    bodies: Bodies,
    i: int,
    j: int,
    d: vec3,
    edges_i: Few,
    edges_j: Few,
    at_edge: int,
    reach: real,
    first: int,
    hits: wp.array(dtype=wp.uint64),
) -> int:
    """Edges of the owner i with those of the partner j; returns the number of hits."""
    n = int(0)
    at = at_edge
    edge_i = geometry.edge_start[geometry.shape[i]]
    edge_j = geometry.edge_start[geometry.shape[j]]
    arm_i = geometry.arm_start[i]
    arm_j = geometry.arm_start[j]
    a = following(edges_i, 0)
    while a < FEATURE_ROOM:
        ends = geometry.edge[edge_i + a]
        p = d + bodies.arm[arm_i + ends[0]]
        p1 = d + bodies.arm[arm_i + ends[1]]
        half = geometry.edge_half[edge_i + a] * geometry.scale[i]
        b = following(edges_j, 0)
        while b < FEATURE_ROOM:
            others = geometry.edge[edge_j + b]
            q = bodies.arm[arm_j + others[0]]
            q1 = bodies.arm[arm_j + others[1]]
            if not boxes_apart(p, p1, q, q1, reach * real(WIDER)):
                halves = half + geometry.edge_half[edge_j + b] * geometry.scale[j]
                if edges_near(p, p1, q, q1, halves, reach):
                    mark(hits, first, at)
                    n += 1
            at += 1
            b = following(edges_j, b + 1)
        a = following(edges_i, a + 1)
    return n


@inlined()
def test_features(
    geometry: Geometry,
    bodies: Bodies,
    i: int,
    j: int,
    d: vec3,
    near: Near,
    reach: real,
    skin: real,
    first: int,
    hits: wp.array(dtype=wp.uint64),
) -> int:
    """All feature pairs of two bodies; returns the number of hits."""
    f = face_count(geometry, i)
    g = face_count(geometry, j)
    n = test_vertices(
        geometry,
        bodies,
        i,
        j,
        d,
        near.owner_vertices,
        near.partner_vertices,
        near.partner_edges,
        False,
        0,
        first_test(VE, near, f, g),
        first_test(VF, near, f, g),
        reach,
        skin,
        first,
        hits,
    )
    n += test_vertices(
        geometry,
        bodies,
        j,
        i,
        -d,
        near.partner_vertices,
        near.owner_vertices,
        near.owner_edges,
        True,
        0,
        first_test(EV, near, f, g),
        first_test(FV, near, f, g),
        reach,
        skin,
        first,
        hits,
    )
    at = first_test(EE, near, f, g)
    n += test_edges(
        geometry, bodies, i, j, d, near.owner_edges, near.partner_edges, at, reach, first, hits
    )
    return n


@inlined()
def write_features(
    near: Near,
    faces_i: int,
    faces_j: int,
    first: int,
    hits: wp.array(dtype=wp.uint64),
    code: wp.array(dtype=wp.int64),
    start: int,
):
    """Write the codes of a body pair's hits, ascending, from ``start`` on."""
    slot = int(start)
    at = int(0)
    kinds = int(EE + 1)
    for kind in range(kinds):
        rows = near.owner_vertices
        columns = near.partner_vertices
        if kind == EV or kind == EE:
            rows = near.owner_edges
        if kind == VE or kind == EE:
            columns = near.partner_edges
        if kind == FV:
            rows = all_of(faces_i)
        if kind == VF:
            columns = all_of(faces_j)
        a = following(rows, 0)
        while a < FEATURE_ROOM:
            b = following(columns, 0)
            while b < FEATURE_ROOM:
                if marked(hits, first, at):
                    code[slot] = encode(kind, a, b)
                    slot += 1
                at += 1
                b = following(columns, b + 1)
            a = following(rows, a + 1)
