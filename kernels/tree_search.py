"""Feature pairs of a body and a shape that is searched through a tree over its features."""

import functools

import warp as wp
from warpdem.kernels.bounds import edges_near, vertex_near_edge, vertex_near_face
from warpdem.kernels.codes import EE, EV, FV, VE, VF, VV, emit
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry


@functools.cache
def against_tree(*, fill: bool) -> wp.Function:
    """Function: one box of the owner's features against the partner's tree of features."""
    put = emit(fill=fill)

    @inlined()
    def against_tree(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: vec3,
        kind: int,
        a: int,
        p: vec3,
        p1: vec3,
        low: vec3,
        high: vec3,
        reach: real,
        skin: real,
        code: wp.array(dtype=wp.int64),
        start: int,
    ) -> int:
        """``kind`` 0: vertex at p, 1: edge p p1, 2: face; low and high in the partner's frame."""
        n = start
        shape_i = geometry.shape[i]
        shape = geometry.shape[j]
        scale = geometry.scale[j]
        vertex_j = geometry.vertex_start[shape]
        edge_j = geometry.edge_start[shape]
        vertices = geometry.vertex_start[shape + 1] - vertex_j
        edges = geometry.edge_start[shape + 1] - edge_j
        arm = geometry.arm_start[j]
        half_edge = real(0.0)
        if kind == 1:
            half_edge = geometry.edge_half[geometry.edge_start[shape_i] + a] * geometry.scale[i]
        grown = vec3(reach)
        query = wp.bvh_query_aabb(
            geometry.tree[shape], wp.vec3((low - grown) / scale), wp.vec3((high + grown) / scale)
        )
        item = int(0)
        while wp.bvh_query_next(query, item):
            if item < vertices:
                q = bodies.arm[arm + item]
                if geometry.vertex_active[vertex_j + item] == 0:
                    n = n + 0
                elif kind == 0:
                    if wp.length_sq(p - q) <= reach * reach:
                        n = put(code, n, VV, a, item)
                elif kind == 1:
                    if vertex_near_edge(q, p, p1, half_edge, reach, skin):
                        n = put(code, n, EV, a, item)
                else:
                    face = geometry.face_start[shape_i] + a
                    x = wp.transpose(bodies.rotation[i]) * (q - d) / geometry.scale[i]
                    if vertex_near_face(geometry, shape_i, face, x, geometry.scale[i], reach, skin):
                        n = put(code, n, FV, a, item)
            elif item < vertices + edges:
                b = item - vertices
                ends = geometry.edge[edge_j + b]
                q = bodies.arm[arm + ends[0]]
                q1 = bodies.arm[arm + ends[1]]
                half_other = geometry.edge_half[edge_j + b] * scale
                if geometry.edge_active[edge_j + b] == 0:
                    n = n + 0
                elif kind == 0:
                    if vertex_near_edge(p, q, q1, half_other, reach, skin):
                        n = put(code, n, VE, a, b)
                elif kind == 1:
                    if edges_near(p, p1, q, q1, half_edge + half_other, reach):
                        n = put(code, n, EE, a, b)
            elif kind == 0:
                b = item - vertices - edges
                x = wp.transpose(bodies.rotation[j]) * p / scale
                face = geometry.face_start[shape] + b
                if vertex_near_face(geometry, shape, face, x, scale, reach, skin):
                    n = put(code, n, VF, a, b)
        return n

    return against_tree


@functools.cache
def features_against_tree(*, fill: bool) -> wp.Function:
    """Function: every active feature of the owner against the partner's tree."""
    against = against_tree(fill=fill)

    @inlined()
    def features_against_tree(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: vec3,
        reach: real,
        skin: real,
        code: wp.array(dtype=wp.int64),
        start: int,
    ) -> int:
        n = start
        shape = geometry.shape[i]
        inverse = wp.transpose(bodies.rotation[j])
        vertex = geometry.vertex_start[shape]
        edge = geometry.edge_start[shape]
        face = geometry.face_start[shape]
        arm = geometry.arm_start[i]
        for a in range(geometry.vertex_start[shape + 1] - vertex):
            if geometry.vertex_active[vertex + a] != 0:
                p = d + bodies.arm[arm + a]
                x = inverse * p
                n = against(geometry, bodies, i, j, d, 0, a, p, p, x, x, reach, skin, code, n)
        for a in range(geometry.edge_start[shape + 1] - edge):
            if geometry.edge_active[edge + a] != 0:
                ends = geometry.edge[edge + a]
                p = d + bodies.arm[arm + ends[0]]
                p1 = d + bodies.arm[arm + ends[1]]
                x = inverse * p
                y = inverse * p1
                n = against(
                    geometry,
                    bodies,
                    i,
                    j,
                    d,
                    1,
                    a,
                    p,
                    p1,
                    wp.min(x, y),
                    wp.max(x, y),
                    reach,
                    skin,
                    code,
                    n,
                )
        for a in range(geometry.face_start[shape + 1] - face):
            first = geometry.side_start[face + a]
            p = d + bodies.arm[arm + geometry.side_vertex[first][0]]
            x = inverse * p
            y = inverse * p
            for side in range(first, geometry.side_start[face + a + 1]):
                q = inverse * (d + bodies.arm[arm + geometry.side_vertex[side][0]])
                x = wp.min(x, q)
                y = wp.max(y, q)
            n = against(geometry, bodies, i, j, d, 2, a, p, p, x, y, reach, skin, code, n)
        return n

    return features_against_tree


@wp.func
def sort(code: wp.array(dtype=wp.int64), first: int, last: int):
    """Shell sort of a slice, gaps shrinking by 2.25 (Tokuda's ratio)."""
    gap = int(1)
    while gap * 9 / 4 < last - first:
        gap = gap * 9 / 4 + 1
    while gap > 0:
        for k in range(first + gap, last):
            value = code[k]
            m = int(k)
            while m >= first + gap and code[wp.max(m - gap, first)] > value:
                code[m] = code[m - gap]
                m -= gap
            code[m] = value
        if gap == 1:
            gap = 0
        else:
            gap = wp.max(gap * 4 / 9, 1)
