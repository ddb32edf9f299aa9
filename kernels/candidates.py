"""Lists of the feature pairs of each body pair, and their history carried over a rebuild."""

import functools

import warp as wp
from warpdem.kernels.bounds import (
    boxes_meet,
    edges_near,
    in_box,
    vertex_near_edge,
    vertex_near_face,
)
from warpdem.kernels.cell import real_vector
from warpdem.kernels.codes import EE, EV, FV, VE, VF, VS, VV, emit
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.surfaces import is_surface, vertices_above
from warpdem.kernels.variant import inlined, variant
from warpdem.kernels.views import Bodies, Cell, Geometry, Pairs


@functools.cache
def vertices_against(*, fill: bool) -> wp.Function:
    """Function: vertices of one body against vertices, edges and faces of another, all of them."""
    put = emit(fill=fill)

    @inlined()
    def vertices_against(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: vec3,
        swapped: bool,
        reach: real,
        skin: real,
        code: wp.array(dtype=wp.int64),
        start: int,
    ) -> int:
        """``d`` is x_i - x_j; ``swapped`` when i is the partner: vertex pairs are left out then."""
        n = start
        shape_i = geometry.shape[i]
        shape_j = geometry.shape[j]
        scale = geometry.scale[j]
        inverse = wp.transpose(bodies.rotation[j])
        middle = geometry.core_middle[shape_j] * scale
        half = geometry.core_half[shape_j] * scale
        vertex_i = geometry.vertex_start[shape_i]
        vertex_j = geometry.vertex_start[shape_j]
        edge_j = geometry.edge_start[shape_j]
        face_j = geometry.face_start[shape_j]
        vertices_j = geometry.vertex_start[shape_j + 1] - vertex_j
        edges_j = geometry.edge_start[shape_j + 1] - edge_j
        faces_j = geometry.face_start[shape_j + 1] - face_j
        arm_j = geometry.arm_start[j]
        for a in range(geometry.vertex_start[shape_i + 1] - vertex_i):
            if geometry.vertex_active[vertex_i + a] != 0:
                p = d + bodies.arm[geometry.arm_start[i] + a]
                x = inverse * p
                if in_box(x, middle, half, reach):
                    if not swapped:
                        for b in range(vertices_j):
                            if geometry.vertex_active[vertex_j + b] != 0:
                                if wp.length_sq(p - bodies.arm[arm_j + b]) <= reach * reach:
                                    n = put(code, n, VV, a, b)
                    for b in range(edges_j):
                        if geometry.edge_active[edge_j + b] != 0:
                            ends = geometry.edge[edge_j + b]
                            q = bodies.arm[arm_j + ends[0]]
                            q1 = bodies.arm[arm_j + ends[1]]
                            half_edge = geometry.edge_half[edge_j + b] * scale
                            if vertex_near_edge(p, q, q1, half_edge, reach, skin):
                                if swapped:
                                    n = put(code, n, EV, b, a)
                                else:
                                    n = put(code, n, VE, a, b)
                    for b in range(faces_j):
                        if vertex_near_face(
                            geometry, shape_j, face_j + b, x / scale, scale, reach, skin
                        ):
                            if swapped:
                                n = put(code, n, FV, b, a)
                            else:
                                n = put(code, n, VF, a, b)
        return n

    return vertices_against


@functools.cache
def edges_against(*, fill: bool) -> wp.Function:
    """Function: edges of the owner against all edges of the partner."""
    put = emit(fill=fill)

    @inlined()
    def edges_against(
        geometry: Geometry,
        bodies: Bodies,
        i: int,
        j: int,
        d: vec3,
        reach: real,
        code: wp.array(dtype=wp.int64),
        start: int,
    ) -> int:
        n = start
        shape_i = geometry.shape[i]
        shape_j = geometry.shape[j]
        scale = geometry.scale[j]
        inverse = wp.transpose(bodies.rotation[j])
        middle = geometry.core_middle[shape_j] * scale
        half = geometry.core_half[shape_j] * scale
        edge_i = geometry.edge_start[shape_i]
        edge_j = geometry.edge_start[shape_j]
        edges_j = geometry.edge_start[shape_j + 1] - edge_j
        arm_i = geometry.arm_start[i]
        arm_j = geometry.arm_start[j]
        for a in range(geometry.edge_start[shape_i + 1] - edge_i):
            if geometry.edge_active[edge_i + a] != 0:
                ends = geometry.edge[edge_i + a]
                p = d + bodies.arm[arm_i + ends[0]]
                p1 = d + bodies.arm[arm_i + ends[1]]
                half_edge = geometry.edge_half[edge_i + a] * geometry.scale[i]
                if boxes_meet(inverse * p, inverse * p1, middle, half, reach):
                    for b in range(edges_j):
                        if geometry.edge_active[edge_j + b] != 0:
                            others = geometry.edge[edge_j + b]
                            q = bodies.arm[arm_j + others[0]]
                            q1 = bodies.arm[arm_j + others[1]]
                            halves = half_edge + geometry.edge_half[edge_j + b] * scale
                            if edges_near(p, p1, q, q1, halves, reach):
                                n = put(code, n, EE, a, b)
        return n

    return edges_against


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


@functools.cache
def find_candidates(
    *, fill: bool, polyhedra: bool, trees: bool, surfaces: bool, periodic: bool
) -> wp.Kernel:
    """Kernel that counts the candidates of each body pair, or writes them in ascending order."""
    vertices = vertices_against(fill=fill)
    edges = edges_against(fill=fill)
    tree = features_against_tree(fill=fill)
    above = vertices_above(fill=fill)
    put = emit(fill=fill)

    @variant
    def find_candidates(
        # model
        geometry: Geometry,
        # in
        gap: real,
        bodies: Bodies,
        pairs: Pairs,
        cell: Cell,
        # out
        code: wp.array(dtype=wp.int64),
        ends: wp.array(dtype=wp.int32),
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        first = int(0)
        if wp.static(fill):
            first = pairs.start[pair]
        n = int(first)
        if wp.static(polyhedra):
            d = bodies.position[i] - bodies.position[j]
            if wp.static(periodic):
                d -= cell.edges[0] * real_vector(pairs.image[pair])
            skin = bodies.reach[i] + bodies.reach[j] + gap
            reach = geometry.radius[i] + geometry.radius[j] + skin
            whole = bool(True)
            if wp.static(surfaces):
                if is_surface(geometry, j):
                    whole = False
                    n = above(geometry, bodies, i, j, d, reach, code, n)
            if wp.static(trees):
                if geometry.tree[geometry.shape[j]] != wp.uint64(0):
                    whole = False
                    n = tree(geometry, bodies, i, j, d, reach, skin, code, n)
            if whole:
                n = vertices(geometry, bodies, i, j, d, False, reach, skin, code, n)
                n = vertices(geometry, bodies, j, i, -d, True, reach, skin, code, n)
                n = edges(geometry, bodies, i, j, d, reach, code, n)
            if wp.static(fill):
                sort(code, first, n)
        else:
            kind = int(VV)
            if wp.static(surfaces):
                if is_surface(geometry, j):
                    kind = int(VS)
            n = put(code, n, kind, 0, 0)
        if wp.static(not fill):
            ends[pair] = n - first

    return find_candidates
