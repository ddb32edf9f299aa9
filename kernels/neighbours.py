"""Lists of body pairs, from a hash grid (small bodies) and a tree (large ones).

Count, scan, fill: nothing is dropped, no atomics, every list sorted, so a run is repeatable.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import bodies_near, widened
from warpdem.kernels.guarding import Room
from warpdem.kernels.precision import vec3, wide, wide3
from warpdem.kernels.surfaces import surface_near
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Bodies, Bonds, Geometry, Incidence, Inertia, Pairs

# so many partners of a body are kept while they are counted; blocks own 11 on average in a heap
FEW = wp.constant(16)
# the next step may be so many times as long as the last: accelerated, or of another dt
MARGIN = wp.constant(wide(2.0))


@inlined()
def owns(geometry: Geometry, inertia: Inertia, i: int, j: int) -> bool:
    """Whether i owns the pair i j: the lower rank does; two bodies that cannot yield have none."""
    if geometry.rank[i] >= geometry.rank[j]:
        return False
    return inertia.inverse_mass[i] != wide(0.0) or inertia.inverse_mass[j] != wide(0.0)


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
def search_partners(*, fill: bool, large: bool, surfaces: bool, bonds: bool) -> wp.Function:
    """Function that searches the partners of body i: grid, tree, surfaces; returns their number.

    It writes them in ascending order from ``first`` on; those that are only counted, the first FEW.
    """
    apart = not_glued(bonds=bonds)

    @wp.func
    def put(partner: wp.array(dtype=wp.int32), first: int, n: int, j: int) -> int:
        if wp.static(fill) or n < FEW:
            insert(partner, first, first + n, j)
        return n + 1

    @inlined()
    def search_partners(
        geometry: Geometry,
        inertia: Inertia,
        grid: wp.uint64,
        grid_bound: wide,
        tree: wp.uint64,
        tree_body: wp.array(dtype=wp.int32),
        surface_body: wp.array(dtype=wp.int32),
        gap: wide,
        widest: wide,
        bodies: Bodies,
        glue: Bonds,
        i: int,
        first: int,
        partner: wp.array(dtype=wp.int32),
    ) -> int:
        n = int(0)
        x = bodies.position[i]
        own = bodies.reach[i] + gap
        grown = geometry.bound[i] + own + widest
        if geometry.large[i] == 0:
            for j in wp.hash_grid_query(grid, x, grown + grid_bound):
                if geometry.large[j] == 0 and owns(geometry, inertia, i, j):
                    d = vec3(x - bodies.position[j])
                    skin = widened(geometry, i, j, d, own + bodies.reach[j])
                    if bodies_near(geometry, bodies, i, j, d, skin) and apart(glue, i, j):
                        n = put(partner, first, n, j)
        if wp.static(large):
            # the tree holds single precision: one part in 1e6 outward
            slack = wide(1.0e-6) * (wp.length(x) + grown)
            low = x - wide3(grown + slack)
            high = x + wide3(grown + slack)
            query = wp.bvh_query_aabb(tree, wp.vec3(low), wp.vec3(high))
            item = int(0)
            while wp.bvh_query_next(query, item):
                j = tree_body[item]
                if j != i and owns(geometry, inertia, i, j):
                    d = vec3(x - bodies.position[j])
                    skin = widened(geometry, i, j, d, own + bodies.reach[j])
                    if bodies_near(geometry, bodies, i, j, d, skin) and apart(glue, i, j):
                        n = put(partner, first, n, j)
        if wp.static(surfaces):
            for k in range(surface_body.shape[0]):
                j = surface_body[k]
                if owns(geometry, inertia, i, j):
                    if surface_near(geometry, bodies, i, j, own + bodies.reach[j]):
                        n = put(partner, first, n, j)
        return n

    return search_partners


@functools.cache
def find_partners(*, fill: bool, large: bool, surfaces: bool, bonds: bool) -> wp.Kernel:
    """Kernel that counts, or writes in ascending order, the partners each body owns.

    The counting kernel writes the first FEW of a body, at FEW body: bodies with no more are not
    searched again.
    """
    search = search_partners(fill=fill, large=large, surfaces=surfaces, bonds=bonds)

    @variant
    def find_partners(
        # model
        geometry: Geometry,
        inertia: Inertia,
        grid: wp.uint64,
        grid_bound: wide,
        tree: wp.uint64,
        tree_body: wp.array(dtype=wp.int32),
        surface_body: wp.array(dtype=wp.int32),
        # in
        gap: wide,
        widest: wide,
        bodies: Bodies,
        glue: Bonds,
        # in and out
        few: wp.array(dtype=wp.int32),
        # out
        ends: wp.array(dtype=wp.int32),
        owner: wp.array(dtype=wp.int32),
        partner: wp.array(dtype=wp.int32),
    ):
        i = wp.tid()
        if wp.static(fill):
            first = int(0)
            if i > 0:
                first = ends[i - 1]
            if ends[i] - first > FEW:
                search(
                    geometry,
                    inertia,
                    grid,
                    grid_bound,
                    tree,
                    tree_body,
                    surface_body,
                    gap,
                    widest,
                    bodies,
                    glue,
                    i,
                    first,
                    partner,
                )
            else:
                for k in range(ends[i] - first):
                    partner[first + k] = few[FEW * i + k]
            for k in range(first, ends[i]):
                owner[k] = i
        else:
            ends[i] = search(
                geometry,
                inertia,
                grid,
                grid_bound,
                tree,
                tree_body,
                surface_body,
                gap,
                widest,
                bodies,
                glue,
                i,
                FEW * i,
                few,
            )

    return find_partners


@plain
def set_reach(
    # model
    geometry: Geometry,
    inertia: Inertia,
    room: Room,
    # in
    dt: wide,
    ahead: wide,
    least: wide,
    most: wide,
    turns: int,
    # in and out
    bodies: Bodies,
):
    """How far each body may go before the lists are renewed: its way in the time ``ahead`` [s].

    No less than ``least`` and no more than ``most`` [m], as lists that would last for ever cost
    more in every step than they save. One that may go through another is looked at on its way; what
    it may meet in its next step is listed. ``turns`` 0: turning moves nothing of free bodies.
    """
    body = wp.tid()
    free = inertia.inverse_mass[body] > wide(0.0)
    if not free and inertia.driven[body] == 0:
        bodies.reach[body] = wide(0.0)
        return
    pace = wp.length(bodies.velocity[body])
    if turns != 0 or not free:
        pace += geometry.bound[body] * wp.length(bodies.spin[body])
    reach = wp.clamp(ahead * pace, least, most)
    if pace > room.critical[body]:
        reach = wp.min(reach, room.narrow[body])
    bodies.reach[body] = wp.max(reach, MARGIN * pace * dt)


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
    """The partner of each pair, by which they are to be sorted; and the material of the pair."""
    pair = wp.tid()
    i = pairs.owner[pair]
    j = pairs.partner[pair]
    keys[pair] = j
    values[pair] = pair
    pairs.material[pair] = geometry.group[i] * group_count + geometry.group[j]


@plain
def incidence_starts(
    # model
    body_count: int,
    # in
    keys: wp.array(dtype=wp.int32),
    count: int,
    # out
    incidence: Incidence,
):
    """Where each body's pairs begin in the sorted ones; a thread a pair, and one more."""
    k = wp.tid()
    low = int(0)
    high = body_count
    if k > 0:
        low = keys[k - 1] + 1
    if k < count:
        high = keys[k]
    for body in range(low, high + 1):
        incidence.start[body] = k
