"""Regions of the space around a solid: of which of its features a vertex is nearest to which.

Over a face, beyond both faces beside an edge, or beyond the ends of all edges at a vertex. Between
convex solids the regions fill space without overlap, so each vertex counts once, and its distance
to the other solid is a continuous function with a continuous gradient. Two regions part by one and
the same comparison. Where three meet several do, and rounding might leave a vertex to none or to
two: there faces reach over their borders and vertices over the ends of edges by ``TIE``, so that
this does not happen right over a corner or a border, where aligned blocks are.
"""

import functools

import warp as wp
from warpdem.kernels.codes import EV, VE, VV, feature_of_owner, feature_of_partner, kind_of
from warpdem.kernels.framing import of_owner, of_partner
from warpdem.kernels.precision import NARROW, mat33, real, vec3, wide3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Geometry

# part of a size by which regions reach over, more than rounding
TIE = 2.0e-5 if NARROW else 1.0e-9
OVER = wp.constant(real(TIE))


@inlined()
def between_ends(r: real, square: real) -> bool:
    """Whether a foot lies inside an edge, ``r`` from 0 to its squared length."""
    slack = OVER * square
    return r > slack and r < square - slack


@inlined()
def beyond(geometry: Geometry, side: int, x: vec3) -> bool:
    """Whether a point of the shape's frame lies beyond a side of a face."""
    plane = geometry.side_above[side]
    out = plane[0] * x[0] + plane[1] * x[1] + plane[2] * x[2] - plane[3]
    return out > real(0.0)


@inlined()
def over_edge(
    geometry: Geometry, rotation: mat33, body: int, edge: int, a: vec3, b: vec3, q: vec3, p: wide3
) -> bool:
    """Whether a point lies beside an edge from a to b, beyond the faces along it.

    ``q`` is the point in the frame of framing.py, ``p`` the same about the body's centre.
    """
    e = b - a
    if not between_ends(wp.dot(q - a, e), wp.dot(e, e)):
        return False
    shape = geometry.shape[body]
    x = wp.transpose(rotation) * vec3(p) / geometry.scale[body]
    sides = geometry.edge_sides[geometry.edge_start[shape] + edge]
    for k in range(2):
        if sides[k] >= 0:
            if not beyond(geometry, sides[k], x):
                return False
    return True


@functools.cache
def over_vertex(*, owners: bool) -> wp.Function:
    """Function of whether a point lies beyond the ends of all edges at a vertex of a body.

    And over none of the faces there: right over a corner it lies on the borders of all.
    ``owners``: the vertex is of the owner.
    """
    place_of = of_owner if owners else of_partner

    @inlined()
    def over_vertex(
        geometry: Geometry, bodies: Bodies, body: int, vertex: int, d: wide3, q: vec3, p: wide3
    ) -> bool:
        """``q`` is the point in the frame of framing.py, ``p`` the same about the body's centre."""
        shape = geometry.shape[body]
        arms = geometry.arm_start[body]
        index = geometry.vertex_start[shape] + vertex
        for k in range(geometry.spoke_start[index], geometry.spoke_start[index + 1]):
            ends = geometry.edge[geometry.edge_start[shape] + geometry.spoke[k]]
            a = place_of(bodies, arms + ends[0], d)
            e = place_of(bodies, arms + ends[1], d) - a
            r = wp.dot(q - a, e)
            square = wp.dot(e, e)
            slack = OVER * square
            if ends[0] == vertex:
                if r > slack:
                    return False
            elif r < square - slack:
                return False
        x = wp.transpose(bodies.rotation[body]) * vec3(p) / geometry.scale[body]
        for k in range(geometry.corner_start[index], geometry.corner_start[index + 1]):
            sides = geometry.corner[k]
            if not beyond(geometry, sides[0], x) and not beyond(geometry, sides[1], x):
                return False
        return True

    return over_vertex


over_owners = over_vertex(owners=True)
over_partners = over_vertex(owners=False)


@inlined()
def is_corner(geometry: Geometry, body: int, vertex: int) -> bool:
    """Whether edges meet at a vertex; that of a sphere stands alone."""
    index = geometry.vertex_start[geometry.shape[body]] + vertex
    return geometry.spoke_start[index + 1] > geometry.spoke_start[index]


@inlined()
def vertex_count(
    geometry: Geometry, bodies: Bodies, i: int, j: int, d: wide3, a: int, b: int
) -> real:
    """How often two vertices count: for each of them that is nearest to the other one.

    A vertex without edges has no region of its own: it counts for itself.
    """
    own = geometry.arm_start[i] + a
    other = geometry.arm_start[j] + b
    p = of_owner(bodies, own, d)
    q = of_partner(bodies, other, d)
    corner_i = is_corner(geometry, i, a)
    corner_j = is_corner(geometry, j, b)
    count = real(0.0)
    if corner_j:
        if over_partners(geometry, bodies, j, b, d, p, d + wide3(bodies.arm[own])):
            count += real(1.0)
    if corner_i:
        if over_owners(geometry, bodies, i, a, d, q, wide3(bodies.arm[other]) - d):
            count += real(1.0)
    if not corner_i and not corner_j:
        count = real(1.0)
    return count


@inlined()
def restricted(geometry: Geometry, body: int) -> bool:
    """Whether directions of a body's edges and vertices are, as of a terrain: ends need not act."""
    shape = geometry.shape[body]
    first = geometry.vertex_start[shape] + geometry.edge_start[shape]
    last = geometry.vertex_start[shape + 1] + geometry.edge_start[shape + 1]
    return geometry.cone_start[last] > geometry.cone_start[first]


@inlined()
def is_nearest(
    geometry: Geometry, bodies: Bodies, i: int, j: int, d: wide3, code: wp.int64
) -> bool:
    """Whether a vertex has no nearer feature of a convex solid than that of a feature pair."""
    kind = kind_of(code)
    a = feature_of_owner(code)
    b = feature_of_partner(code)
    if kind == VE:
        ends = geometry.edge[geometry.edge_start[geometry.shape[j]] + b]
        return over_edge(
            geometry,
            bodies.rotation[j],
            j,
            b,
            of_partner(bodies, geometry.arm_start[j] + ends[0], d),
            of_partner(bodies, geometry.arm_start[j] + ends[1], d),
            of_owner(bodies, geometry.arm_start[i] + a, d),
            d + wide3(bodies.arm[geometry.arm_start[i] + a]),
        )
    if kind == EV:
        ends = geometry.edge[geometry.edge_start[geometry.shape[i]] + a]
        return over_edge(
            geometry,
            bodies.rotation[i],
            i,
            a,
            of_owner(bodies, geometry.arm_start[i] + ends[0], d),
            of_owner(bodies, geometry.arm_start[i] + ends[1], d),
            of_partner(bodies, geometry.arm_start[j] + b, d),
            wide3(bodies.arm[geometry.arm_start[j] + b]) - d,
        )
    if kind == VV:
        return vertex_count(geometry, bodies, i, j, d, a, b) > real(0.0)
    return True
