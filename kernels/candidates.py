"""Lists of the feature pairs of each body pair.

Two bodies that are searched whole have their near features found first; then each pair of those is
tested once and leaves a bit, from which the codes are written. Trees and surfaces are searched
twice, to count and to write.
"""

import functools

import warp as wp
from warpdem.kernels.bounds import widened
from warpdem.kernels.cell import real_vector
from warpdem.kernels.codes import EE, VS, VV, encode
from warpdem.kernels.feature_tests import (
    face_count,
    first_row,
    test_features,
    write_features,
)
from warpdem.kernels.outcodes import Near, features_near, searched_whole
from warpdem.kernels.precision import vec3, wide
from warpdem.kernels.surfaces import is_surface, vertices_above
from warpdem.kernels.tree_search import features_against_tree, sort
from warpdem.kernels.variant import inlined, variant
from warpdem.kernels.views import Bodies, Cell, Geometry, Pairs


@functools.cache
def centres_apart(*, periodic: bool) -> wp.Function:
    """Function: centre of a pair's owner about that of its partner, or of the partner's image."""

    @inlined()
    def centres_apart(bodies: Bodies, pairs: Pairs, cell: Cell, pair: int) -> vec3:
        d = bodies.position[pairs.owner[pair]] - bodies.position[pairs.partner[pair]]
        if wp.static(periodic):
            d -= cell.edges[0] * real_vector(pairs.image[pair])
        return vec3(d)

    return centres_apart


@functools.cache
def find_near(*, periodic: bool) -> wp.Kernel:
    """Kernel that finds the features of two bodies that are to be tested, and counts the tests."""
    centres = centres_apart(periodic=periodic)

    @variant
    def find_near(
        # model
        geometry: Geometry,
        # in
        gap: wide,
        bodies: Bodies,
        pairs: Pairs,
        cell: Cell,
        # out
        near: wp.array(dtype=Near),
        rows: wp.array(dtype=wp.int32),
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        rows[pair] = 0
        if searched_whole(geometry, j):
            d = centres(bodies, pairs, cell, pair)
            skin = widened(geometry, i, j, d, bodies.reach[i] + bodies.reach[j] + gap)
            reach = geometry.radius[i] + geometry.radius[j] + skin
            found = features_near(geometry, bodies, i, j, d, reach)
            near[pair] = found
            rows[pair] = first_row(EE + 1, found, face_count(geometry, i))

    return find_near


@functools.cache
def find_candidates(*, fill: bool, trees: bool, surfaces: bool, periodic: bool) -> wp.Kernel:
    """Kernel that counts the candidates of each body pair, or writes them in ascending order.

    Rows of ``hits`` end at ``rows`` for each pair; the counting kernel writes them.
    """
    tree = features_against_tree(fill=fill)
    above = vertices_above(fill=fill)
    centres = centres_apart(periodic=periodic)

    @variant
    def find_candidates(
        # model
        geometry: Geometry,
        # in
        gap: wide,
        bodies: Bodies,
        pairs: Pairs,
        cell: Cell,
        near: wp.array(dtype=Near),
        rows: wp.array(dtype=wp.int32),
        # in and out
        hits: wp.array(dtype=wp.uint64),
        # out
        code: wp.array(dtype=wp.int64),
        ends: wp.array(dtype=wp.int32),
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        d = centres(bodies, pairs, cell, pair)
        skin = widened(geometry, i, j, d, bodies.reach[i] + bodies.reach[j] + gap)
        reach = geometry.radius[i] + geometry.radius[j] + skin
        start = int(0)
        if wp.static(fill):
            start = pairs.start[pair]
        n = int(start)
        if wp.static(surfaces):
            if is_surface(geometry, j):
                n = above(geometry, bodies, i, j, d, reach, code, n)
        if wp.static(trees):
            if geometry.tree[geometry.shape[j]] != wp.uint64(0):
                n = tree(geometry, bodies, i, j, d, reach, skin, code, n)
                if wp.static(fill):
                    sort(code, start, n)
        if searched_whole(geometry, j):
            first = int(0)
            if pair > 0:
                first = rows[pair - 1]
            if wp.static(fill):
                if pairs.start[pair + 1] > start:
                    faces = face_count(geometry, i)
                    write_features(near[pair], faces, first, hits, code, start)
            else:
                found = near[pair]
                n += test_features(geometry, bodies, i, j, d, found, reach, skin, first, hits)
        if wp.static(not fill):
            ends[pair] = n

    return find_candidates


@functools.cache
def single_candidates(*, surfaces: bool) -> wp.Kernel:
    """Kernel for spheres only: a body pair has one candidate."""

    @variant
    def single_candidates(
        # model
        geometry: Geometry,
        # in and out
        pairs: Pairs,
        # out
        code: wp.array(dtype=wp.int64),
    ):
        pair = wp.tid()
        kind = int(VV)
        if wp.static(surfaces):
            if is_surface(geometry, pairs.partner[pair]):
                kind = int(VS)
        code[pair] = encode(kind, 0, 0)
        pairs.start[pair + 1] = pair + 1

    return single_candidates
