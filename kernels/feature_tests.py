"""Tests of the feature pairs of two bodies, each done once; what they find is kept as bits.

A row of a body pair's ``hits`` belongs to a feature of the owner: the set of features of the
partner that passed the test with it. Rows come in the order of the codes: the owner's near vertices
for VV, the same for VE, its near edges for EV, ...
"""

import warp as wp
from warpdem.kernels.bounds import edges_near, vertex_near_edge, vertex_near_face
from warpdem.kernels.codes import EE, EV, FV, VE, VF, VV, encode
from warpdem.kernels.outcodes import NONE, ONE, WIDER, Near, bit, lowest, size
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry


@wp.func
def first_row(kind: int, near: Near, faces: int) -> int:
    """First row of a kind; ``faces`` of the owner. Of EE + 1: how many rows there are."""
    vertices = size(near.owner_vertices)
    edges = size(near.owner_edges)
    row = int(0)
    if kind > VV:
        row += vertices
    if kind > VE:
        row += vertices
    if kind > EV:
        row += edges
    if kind > VF:
        row += vertices
    if kind > FV:
        row += faces
    if kind > EE:
        row += edges
    return row


@inlined()
def face_count(geometry: Geometry, body: int) -> int:
    """Number of faces of a body."""
    shape = geometry.shape[body]
    return geometry.face_start[shape + 1] - geometry.face_start[shape]


@wp.func
def first_of(count: int) -> wp.uint64:
    """The set of the first ``count`` features."""
    if count == 0:
        return NONE
    return (bit(count - 1) - ONE) | bit(count - 1)


@inlined()
def test_owner(
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
    """Vertices of the owner i with vertices, edges and faces of j; returns the number of hits."""
    n = int(0)
    shape = geometry.shape[j]
    scale = geometry.scale[j]
    inverse = wp.transpose(bodies.rotation[j])
    arm = geometry.arm_start[j]
    edge = geometry.edge_start[shape]
    face = geometry.face_start[shape]
    faces = geometry.face_start[shape + 1] - face
    row = first
    rows = size(near.owner_vertices)
    over_faces = 2 * rows + size(near.owner_edges)
    rest = near.owner_vertices
    while rest != NONE:
        p = d + bodies.arm[geometry.arm_start[i] + lowest(rest)]
        rest = rest & (rest - ONE)
        found = NONE
        others = near.partner_vertices
        while others != NONE:
            b = lowest(others)
            others = others & (others - ONE)
            if wp.length_sq(p - bodies.arm[arm + b]) <= reach * reach:
                found = found | bit(b)
        hits[row] = found
        n += size(found)
        found = NONE
        others = near.partner_edges
        while others != NONE:
            b = lowest(others)
            others = others & (others - ONE)
            ends = geometry.edge[edge + b]
            q = bodies.arm[arm + ends[0]]
            q1 = bodies.arm[arm + ends[1]]
            if vertex_near_edge(p, q, q1, geometry.edge_half[edge + b] * scale, reach, skin):
                found = found | bit(b)
        hits[row + rows] = found
        n += size(found)
        found = NONE
        x = inverse * p / scale
        for b in range(faces):
            if vertex_near_face(geometry, shape, face + b, x, scale, reach, skin):
                found = found | bit(b)
        hits[row + over_faces] = found
        n += size(found)
        row += 1
    return n


@inlined()
def test_partner(
    geometry: Geometry,
    bodies: Bodies,
    i: int,
    j: int,
    d: vec3,
    near: Near,
    reach: real,
    skin: real,
    first_edge: int,
    first_face: int,
    hits: wp.array(dtype=wp.uint64),
) -> int:
    """Edges and faces of the owner i with vertices of j; returns the number of hits."""
    n = int(0)
    shape = geometry.shape[i]
    scale = geometry.scale[i]
    inverse = wp.transpose(bodies.rotation[i])
    arm = geometry.arm_start[i]
    edge = geometry.edge_start[shape]
    face = geometry.face_start[shape]
    faces = geometry.face_start[shape + 1] - face
    for row in range(first_edge, first_edge + size(near.owner_edges)):
        hits[row] = NONE
    for row in range(first_face, first_face + faces):
        hits[row] = NONE
    rest = near.partner_vertices
    while rest != NONE:
        b = lowest(rest)
        rest = rest & (rest - ONE)
        p = bodies.arm[geometry.arm_start[j] + b] - d
        row = first_edge
        others = near.owner_edges
        while others != NONE:
            a = lowest(others)
            others = others & (others - ONE)
            ends = geometry.edge[edge + a]
            q = bodies.arm[arm + ends[0]]
            q1 = bodies.arm[arm + ends[1]]
            if vertex_near_edge(p, q, q1, geometry.edge_half[edge + a] * scale, reach, skin):
                hits[row] = hits[row] | bit(b)
                n += 1
            row += 1
        x = inverse * p / scale
        for a in range(faces):
            if vertex_near_face(geometry, shape, face + a, x, scale, reach, skin):
                hits[first_face + a] = hits[first_face + a] | bit(b)
                n += 1
    return n


@wp.func
def beyond(q: vec3, q1: vec3, low: vec3, high: vec3) -> bool:
    """Whether both ends of a segment lie beyond one side of a box."""
    out = bool(False)
    for k in range(3):
        above = q[k] > high[k] and q1[k] > high[k]
        below = q[k] < low[k] and q1[k] < low[k]
        out = out or above or below
    return out


@inlined()
def test_edges(
    geometry: Geometry,
    bodies: Bodies,
    i: int,
    j: int,
    d: vec3,
    near: Near,
    reach: real,
    first: int,
    hits: wp.array(dtype=wp.uint64),
) -> int:
    """Edges of the owner i with those of the partner j; returns the number of hits."""
    n = int(0)
    edge_i = geometry.edge_start[geometry.shape[i]]
    edge_j = geometry.edge_start[geometry.shape[j]]
    arm_i = geometry.arm_start[i]
    arm_j = geometry.arm_start[j]
    around = vec3(reach * real(WIDER))
    row = first
    rest = near.owner_edges
    while rest != NONE:
        a = lowest(rest)
        rest = rest & (rest - ONE)
        ends = geometry.edge[edge_i + a]
        p = d + bodies.arm[arm_i + ends[0]]
        p1 = d + bodies.arm[arm_i + ends[1]]
        low = wp.min(p, p1) - around
        high = wp.max(p, p1) + around
        half = geometry.edge_half[edge_i + a] * geometry.scale[i]
        found = NONE
        others = near.partner_edges
        while others != NONE:
            b = lowest(others)
            others = others & (others - ONE)
            ends = geometry.edge[edge_j + b]
            q = bodies.arm[arm_j + ends[0]]
            q1 = bodies.arm[arm_j + ends[1]]
            if not beyond(q, q1, low, high):
                halves = half + geometry.edge_half[edge_j + b] * geometry.scale[j]
                if edges_near(p, p1, q, q1, halves, reach):
                    found = found | bit(b)
        hits[row] = found
        n += size(found)
        row += 1
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
    """All near features of two bodies, rows from ``first`` on; returns the number of hits."""
    faces = face_count(geometry, i)
    ev = first + first_row(EV, near, faces)
    fv = first + first_row(FV, near, faces)
    ee = first + first_row(EE, near, faces)
    n = test_owner(geometry, bodies, i, j, d, near, reach, skin, first, hits)
    n += test_partner(geometry, bodies, i, j, d, near, reach, skin, ev, fv, hits)
    n += test_edges(geometry, bodies, i, j, d, near, reach, ee, hits)
    return n


@wp.func
def write_features(
    near: Near,
    faces: int,
    first: int,
    hits: wp.array(dtype=wp.uint64),
    code: wp.array(dtype=wp.int64),
    start: int,
):
    """Write the codes of a pair's hits, ascending, from ``start`` on; ``faces`` of the owner."""
    slot = int(start)
    row = int(first)
    kinds = int(EE + 1)
    for kind in range(kinds):
        rest = near.owner_vertices
        if kind == EV or kind == EE:
            rest = near.owner_edges
        if kind == FV:
            rest = first_of(faces)
        while rest != NONE:
            a = lowest(rest)
            rest = rest & (rest - ONE)
            found = hits[row]
            row += 1
            while found != NONE:
                code[slot] = encode(kind, a, lowest(found))
                found = found & (found - ONE)
                slot += 1
