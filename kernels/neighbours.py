"""Lists of body pairs, from a hash grid (small bodies) and a tree (large ones).

Count, scan, fill: nothing is dropped, no atomics, every list sorted, so a run is repeatable.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import bodies_near
from warpdem.kernels.precision import real, vec3
from warpdem.kernels.surfaces import surface_near
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Bodies, Bonds, Geometry, Incidence, Inertia, Pairs


@inlined()
def owns(geometry: Geometry, inertia: Inertia, i: int, j: int) -> bool:
    """Whether i owns the pair i j: the lower rank does; two bodies that cannot yield have none."""
    if inertia.inverse_mass[i] == real(0.0) and inertia.inverse_mass[j] == real(0.0):
        return False
    return geometry.rank[i] < geometry.rank[j]


@wp.func
def lower_bound(values: wp.array(dtype=wp.int32), first: int, last: int, value: int) -> int:
    """First place in a sorted slice that is not below ``value``."""
    low = first
    high = last
    while low < high:
        middle = (low + high) >> 1
        if values[middle] < value:
            low = middle + 1
        else:
            high = middle
    return low


@inlined()
def glued(bonds: Bonds, i: int, j: int) -> bool:
    """Whether an intact interface joins owner i and partner j: then they have no contact."""
    last = bonds.owned[i + 1]
    k = lower_bound(bonds.partner, bonds.owned[i], last, j)
    if k >= last:
        return False
    return bonds.partner[k] == j and bonds.state[k] == 1


@functools.cache
def not_glued(*, bonds: bool) -> wp.Function:
    """Function of whether no intact interface joins two bodies; without ``bonds`` none does."""

    @inlined()
    def not_glued(glue: Bonds, i: int, j: int) -> bool:
        free = bool(True)
        if wp.static(bonds):
            free = not glued(glue, i, j)
        return free

    return not_glued


@wp.func
def insert(partners: wp.array(dtype=wp.int32), first: int, last: int, partner: int):
    """Put ``partner`` into the sorted slice first .. last."""
    k = last
    while k > first and partners[wp.max(k - 1, first)] > partner:
        partners[k] = partners[k - 1]
        k -= 1
    partners[k] = partner


@functools.cache
def find_partners(*, fill: bool, large: bool, surfaces: bool, bonds: bool) -> wp.Kernel:
    """Kernel that counts, or writes in ascending order, the partners each body owns."""
    apart = not_glued(bonds=bonds)

    @variant
    def find_partners(
        # model
        geometry: Geometry,
        inertia: Inertia,
        grid: wp.uint64,
        grid_bound: real,
        tree: wp.uint64,
        tree_body: wp.array(dtype=wp.int32),
        surface_body: wp.array(dtype=wp.int32),
        # in
        gap: real,
        widest: real,
        bodies: Bodies,
        glue: Bonds,
        # out
        ends: wp.array(dtype=wp.int32),
        owner: wp.array(dtype=wp.int32),
        partner: wp.array(dtype=wp.int32),
    ):
        i = wp.tid()
        first = int(0)
        if wp.static(fill):
            if i > 0:
                first = ends[i - 1]
        n = int(0)
        x = bodies.position[i]
        own = bodies.reach[i] + gap
        grown = geometry.bound[i] + own + widest
        if geometry.large[i] == 0:
            for j in wp.hash_grid_query(grid, x, grown + grid_bound):
                if geometry.large[j] == 0 and owns(geometry, inertia, i, j):
                    d = x - bodies.position[j]
                    skin = own + bodies.reach[j]
                    if bodies_near(geometry, bodies, i, j, d, skin) and apart(glue, i, j):
                        if wp.static(fill):
                            insert(partner, first, first + n, j)
                        n += 1
        if wp.static(large):
            # the tree holds single precision: one part in 1e6 outward
            slack = real(1.0e-6) * (wp.length(x) + grown)
            low = x - vec3(grown + slack)
            high = x + vec3(grown + slack)
            query = wp.bvh_query_aabb(tree, wp.vec3(low), wp.vec3(high))
            item = int(0)
            while wp.bvh_query_next(query, item):
                j = tree_body[item]
                if j != i and owns(geometry, inertia, i, j):
                    d = x - bodies.position[j]
                    skin = own + bodies.reach[j]
                    if bodies_near(geometry, bodies, i, j, d, skin) and apart(glue, i, j):
                        if wp.static(fill):
                            insert(partner, first, first + n, j)
                        n += 1
        if wp.static(surfaces):
            for k in range(surface_body.shape[0]):
                j = surface_body[k]
                if owns(geometry, inertia, i, j):
                    if surface_near(geometry, bodies, i, j, own + bodies.reach[j]):
                        if wp.static(fill):
                            insert(partner, first, first + n, j)
                        n += 1
        if wp.static(fill):
            for k in range(first, first + n):
                owner[k] = i
        else:
            ends[i] = n

    return find_partners


@plain
def set_reach(
    # model
    geometry: Geometry,
    # in
    ahead: real,
    least: real,
    most: real,
    # in and out
    bodies: Bodies,
):
    """How far each body may go before the lists are renewed: its way in the time ``ahead`` [s].

    No less than ``least`` and no more than ``most`` [m], as lists that would last for ever cost
    more in every step than they save.
    """
    body = wp.tid()
    speed = wp.length(bodies.velocity[body])
    pace = speed + geometry.bound[body] * wp.length(bodies.spin[body])
    bodies.reach[body] = wp.clamp(ahead * pace, least, most)


@plain
def incidence_keys(
    # model
    geometry: Geometry,
    group_count: int,
    # in and out
    pairs: Pairs,
    # out
    keys: wp.array(dtype=wp.int32),
    values: wp.array(dtype=wp.int32),
):
    """Both ends of each pair, to be sorted by body; and the material of the pair."""
    pair = wp.tid()
    i = pairs.owner[pair]
    j = pairs.partner[pair]
    keys[2 * pair] = i
    values[2 * pair] = 2 * pair
    keys[2 * pair + 1] = j
    values[2 * pair + 1] = 2 * pair + 1
    pairs.material[pair] = geometry.group[i] * group_count + geometry.group[j]


@plain
def incidence_starts(
    # in
    keys: wp.array(dtype=wp.int32),
    count: int,
    # out
    incidence: Incidence,
):
    """Where each body's pairs begin in the sorted ends."""
    body = wp.tid()
    incidence.start[body] = lower_bound(keys, 0, count, body)
