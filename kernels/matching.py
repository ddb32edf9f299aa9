"""What a contact remembers when lists are renewed, or when its feature pair changes.

A vertex that slides over the border of a face goes on along the border edge or over the next face;
its friction must not start anew there.
"""

import functools

import warp as wp
from warpdem.kernels.laws import Laws
from warpdem.kernels.neighbours import lower_bound
from warpdem.kernels.precision import real, vec3, wide, wide3, wide4
from warpdem.kernels.variant import inlined, place, variant
from warpdem.kernels.views import Bodies, Candidates, Cell, Geometry, Pairs


@inlined()
def successor(candidates: Candidates, start: int, touching: int, point: vec3, reach: real) -> int:
    """Touching candidate whose contact point lies nearest, one that is new before others; or -1."""
    best = int(-1)
    nearest = reach * reach
    fresh = bool(False)
    for slot in range(start, start + touching):
        c = candidates.which[slot]
        away = candidates.point[slot] - point
        square = wp.dot(away, away)
        new = candidates.past[c][3] == wide(-1.0)
        touches = candidates.gap[slot] < real(0.0)
        if square <= reach * reach and touches:
            if (new and not fresh) or (new == fresh and square < nearest):
                best = c
                nearest = square
                fresh = new
    return best


@functools.cache
def hand_over(gap_of: wp.Function, laws: Laws) -> wp.Function:
    """Function that moves the history of contacts whose foot left its feature to their successors.

    Such contacts are marked by past[3] = -2 - fn. A new contact takes over the whole history, one
    that touched already adds the tangential force (and moment) to its own; the cap of the next
    force pass cuts what its normal force cannot carry.
    """

    @inlined()
    def hand_over(
        geometry: Geometry,
        bodies: Bodies,
        candidates: Candidates,
        i: int,
        j: int,
        d: wide3,
        start: int,
        end: int,
        touching: int,
    ):
        reach = geometry.radius[i] + geometry.radius[j]
        for k in range(start, end):
            c = k
            if wp.static(laws.polyhedra):
                c = place(candidates.hot[k])
            past = candidates.past[c]
            if past[3] <= wide(-2.0):
                hit = gap_of(geometry, bodies, i, j, d, real(0.0), True, candidates.code[c])
                heir = successor(candidates, start, touching, hit.point, reach)
                if heir >= 0:
                    own = candidates.past[heir]
                    if own[3] == wide(-1.0):
                        candidates.past[heir] = wide4(
                            past[0], past[1], past[2], wide(-2.0) - past[3]
                        )
                        if wp.static(laws.moving):
                            candidates.share[heir] = candidates.share[c]
                        if wp.static(laws.avalanche):
                            candidates.last[heir] = candidates.last[c]
                    else:
                        candidates.past[heir] = wide4(
                            own[0] + past[0], own[1] + past[1], own[2] + past[2], own[3]
                        )
                    if wp.static(laws.rolling):
                        candidates.rolled[heir] = candidates.rolled[heir] + candidates.rolled[c]
                candidates.past[c] = wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))
                if wp.static(laws.rolling):
                    candidates.rolled[c] = wide4()

    return hand_over


@inlined()
def same_image(
    old_partner: wp.array(dtype=wp.int32),
    old_image: wp.array(dtype=wp.vec3i),
    first: int,
    last: int,
    pairs: Pairs,
    pair: int,
    cell: Cell,
) -> int:
    """Old pair with the same image of the partner, or ``last``.

    A fixed body that spans the cell is the same in all its images.
    """
    i = pairs.owner[pair]
    j = pairs.partner[pair]
    n = pairs.image[pair]
    found = int(last)
    for old in range(first, last):
        if old_partner[old] == j and found == last:
            same = bool(True)
            for a in range(3):
                if cell.spanning[i][a] == 0 and cell.spanning[j][a] == 0:
                    if old_image[old][a] != n[a]:
                        same = False
            if same:
                found = old
    return found


@functools.cache
def carry_history(
    *, rolling: bool, shares: bool, last: bool, periodic: bool, hot: bool, braking: bool
) -> wp.Kernel:
    """Kernel that moves what contacts remember from the old lists into the new ones, by merging.

    ``hot``: there are hot lists, which begin anew; ``braking``: pairs remember their fastest mode.
    """

    @variant
    def carry_history(
        # in
        old_ends: wp.array(dtype=wp.int32),
        old_partner: wp.array(dtype=wp.int32),
        old_image: wp.array(dtype=wp.vec3i),
        old_start: wp.array(dtype=wp.int32),
        old_code: wp.array(dtype=wp.int64),
        old_past: wp.array(dtype=wide4),
        old_rolled: wp.array(dtype=wide4),
        old_share: wp.array(dtype=real),
        old_last: wp.array(dtype=real),
        old_looked: wp.array(dtype=wp.int32),
        old_fastest: wp.array(dtype=real),
        pairs: Pairs,
        cell: Cell,
        # out
        candidates: Candidates,
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        low = int(0)
        if i > 0:
            low = old_ends[i - 1]
        old = lower_bound(old_partner, low, old_ends[i], pairs.partner[pair])
        if wp.static(periodic):
            old = same_image(old_partner, old_image, old, old_ends[i], pairs, pair, cell)
        k = int(0)
        end = int(0)
        found = int(-1)
        if old < old_ends[i]:
            if old_partner[old] == pairs.partner[pair]:
                k = old_start[old]
                end = old_start[old + 1]
                found = old
        for c in range(pairs.start[pair], pairs.start[pair + 1]):
            code = candidates.code[c]
            while k < end and old_code[wp.min(k, end - 1)] < code:
                k += 1
            past = wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))
            rolled = wide4()
            share = real(1.0)
            gap = real(0.0)
            if k < end:
                if old_code[k] == code:
                    past = old_past[k]
                    if wp.static(rolling):
                        rolled = old_rolled[k]
                    if wp.static(shares):
                        share = old_share[k]
                    if wp.static(last):
                        gap = old_last[k]
            candidates.past[c] = past
            if wp.static(hot):
                candidates.clear[c] = wide(0.0)
            if wp.static(rolling):
                candidates.rolled[c] = rolled
            if wp.static(shares):
                candidates.share[c] = share
            if wp.static(last):
                candidates.last[c] = gap
        if wp.static(hot):
            pairs.hot_end[pair] = pairs.start[pair]
            pairs.cold[pair] = wide(-1.0)
        pairs.touching[pair] = 0
        if wp.static(braking):
            pairs.looked[pair] = 0
            if found >= 0:
                pairs.looked[pair] = old_looked[found]
                pairs.fastest[pair] = old_fastest[found]

    return carry_history
