"""Body pairs of a periodic cell, each with the image n of its partner: d = x_i - x_j - H n.

Bodies keep their own positions, which may lie anywhere; only the search looks at them wrapped into
the cell, where body i has x_i - H h_i. Relative to those the image is m, and n = m + h_i - h_j. An
image is looked at when it may come within reach of the cell, so a cell may be narrower than its
bodies: a pair may meet in several images, and a body its own (half of them, m before -m).
Since positions are never wrapped, n belongs to a pair for good: whoever keeps pairs longer than a
list, bonds for instance, keeps n with them.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import bodies_near, widened
from warpdem.kernels.cell import real_vector
from warpdem.kernels.neighbours import glued, owns
from warpdem.kernels.precision import vec3, wide, wide3, wide33
from warpdem.kernels.surfaces import surface_near
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Bodies, Bonds, Cell, Geometry, Inertia


@plain
def wrap_bodies(
    # in
    periodic: wp.vec3i,
    bodies: Bodies,
    cell: Cell,
    # out
    home: wp.array(dtype=wp.vec3i),
    wrapped: wp.array(dtype=wide3),
):
    """The cell each body is in, and its position wrapped into the first one."""
    body = wp.tid()
    x = bodies.position[body]
    s = wp.inverse(cell.edges[0]) * (x - cell.centre[0])
    h = wp.vec3i()
    for a in range(3):
        if periodic[a] != 0:
            h[a] = int(wp.floor(s[a] + wide(0.5)))
    home[body] = h
    wrapped[body] = x - cell.edges[0] * real_vector(h)


@wp.func
def insert_image(
    partners: wp.array(dtype=wp.int32),
    images: wp.array(dtype=wp.vec3i),
    first: int,
    last: int,
    partner: int,
    image: wp.vec3i,
):
    """Put a partner into the sorted slice first .. last, after itself if it is there."""
    k = last
    while k > first and partners[wp.max(k - 1, first)] > partner:
        partners[k] = partners[k - 1]
        images[k] = images[k - 1]
        k -= 1
    partners[k] = partner
    images[k] = image


@wp.func
def comes_first(m: wp.vec3i) -> bool:
    """Whether m comes before -m: one of the two stands for both images of a body by itself."""
    if m[0] != 0:
        return m[0] > 0
    if m[1] != 0:
        return m[1] > 0
    return m[2] > 0


@wp.func
def range_of_images(
    inverse: wide33, s: wide3, reach: wide3, periodic: wp.vec3i, spanning: wp.vec3i
):
    """Least and greatest image that may come within ``reach`` of a point at ``s`` in the cell."""
    low = wp.vec3i()
    high = wp.vec3i()
    for a in range(3):
        if periodic[a] != 0 and spanning[a] == 0:
            # part of the cell's height over its face a that the reach is
            share = reach[a] * wp.length(inverse[a])
            low[a] = int(wp.ceil(s[a] - wide(0.5) - share))
            high[a] = int(wp.floor(s[a] + wide(0.5) + share))
    return low, high


@wp.func
def passes(m: wp.vec3i, spanning: wp.vec3i) -> bool:
    """Whether an image is one of its own: a body that spans the cell along an axis has none."""
    for a in range(3):
        if spanning[a] != 0 and m[a] != 0:
            return False
    return True


@functools.cache
def meeting(*, bonds: bool) -> wp.Function:
    """Function of whether a body and an image of another make a pair."""

    @inlined()
    def meets(
        geometry: Geometry,
        inertia: Inertia,
        bodies: Bodies,
        glue: Bonds,
        cell: Cell,
        i: int,
        j: int,
        m: wp.vec3i,
        n: wp.vec3i,
        gap: wide,
    ) -> bool:
        """Whether i owns its pair with image n of j, and they could touch within their skins."""
        if i == j:
            if inertia.inverse_mass[i] == wide(0.0) or not comes_first(m):
                return False
        elif not owns(geometry, inertia, i, j):
            return False
        if wp.static(bonds):
            # bonds are between bodies, not their images
            if n[0] == 0 and n[1] == 0 and n[2] == 0:
                if glued(glue, i, j):
                    return False
        away = bodies.position[i] - bodies.position[j] - cell.edges[0] * real_vector(n)
        d = vec3(away)
        skin = widened(geometry, i, j, d, bodies.reach[i] + bodies.reach[j] + gap)
        return bodies_near(geometry, bodies, i, j, d, skin)

    return meets


@functools.cache
def find_images(*, fill: bool, large: bool, surfaces: bool, bonds: bool) -> wp.Kernel:
    """Kernel that counts, or writes by ascending partner, the images each body owns a pair with."""
    meets = meeting(bonds=bonds)

    @variant
    def find_images(
        # model
        geometry: Geometry,
        inertia: Inertia,
        periodic: wp.vec3i,
        grid: wp.uint64,
        grid_bound: wide,
        tree: wp.uint64,
        tree_body: wp.array(dtype=wp.int32),
        tree_reach: wide3,
        surface_body: wp.array(dtype=wp.int32),
        # in
        gap: wide,
        widest: wide,
        bodies: Bodies,
        glue: Bonds,
        cell: Cell,
        home: wp.array(dtype=wp.vec3i),
        wrapped: wp.array(dtype=wide3),
        # out
        ends: wp.array(dtype=wp.int32),
        owner: wp.array(dtype=wp.int32),
        partner: wp.array(dtype=wp.int32),
        image: wp.array(dtype=wp.vec3i),
    ):
        i = wp.tid()
        first = int(0)
        if wp.static(fill):
            if i > 0:
                first = ends[i - 1]
        count = int(0)
        edges = cell.edges[0]
        inverse = wp.inverse(edges)
        s = inverse * (wrapped[i] - cell.centre[0])
        own = bodies.reach[i] + gap
        grown = geometry.bound[i] + own + widest
        reach = wide3(grown + grid_bound)
        if wp.static(large):
            reach = wp.max(reach, wide3(grown) + tree_reach)
        low, high = range_of_images(inverse, s, reach, periodic, cell.spanning[i])
        for mx in range(low[0], high[0] + 1):
            for my in range(low[1], high[1] + 1):
                for mz in range(low[2], high[2] + 1):
                    m = wp.vec3i(mx, my, mz)
                    x = wrapped[i] - edges * real_vector(m)
                    if geometry.large[i] == 0:
                        for j in wp.hash_grid_query(grid, x, grown + grid_bound):
                            n = m + home[i] - home[j]
                            if geometry.large[j] == 0 and passes(m, cell.spanning[j]):
                                if meets(geometry, inertia, bodies, glue, cell, i, j, m, n, gap):
                                    if wp.static(fill):
                                        insert_image(partner, image, first, first + count, j, n)
                                    count += 1
                    if wp.static(large):
                        # the tree holds single precision: one part in 1e6 outward
                        slack = wide(1.0e-6) * (wp.length(x) + grown)
                        corner = wide3(grown + slack)
                        query = wp.bvh_query_aabb(tree, wp.vec3(x - corner), wp.vec3(x + corner))
                        item = int(0)
                        while wp.bvh_query_next(query, item):
                            j = tree_body[item]
                            n = m + home[i] - home[j]
                            if passes(m, cell.spanning[j]):
                                if meets(geometry, inertia, bodies, glue, cell, i, j, m, n, gap):
                                    if wp.static(fill):
                                        insert_image(partner, image, first, first + count, j, n)
                                    count += 1
        if wp.static(surfaces):
            # the same in all the cell's images
            for k in range(surface_body.shape[0]):
                j = surface_body[k]
                if owns(geometry, inertia, i, j):
                    if surface_near(geometry, bodies, i, j, own + bodies.reach[j]):
                        if wp.static(fill):
                            insert_image(partner, image, first, first + count, j, wp.vec3i())
                        count += 1
        if wp.static(fill):
            for k in range(first, first + count):
                owner[k] = i
        else:
            ends[i] = count

    return find_images
