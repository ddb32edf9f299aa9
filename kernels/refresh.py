"""The hot list of each body pair: of its candidates those that may touch within the next steps.

Every body sums the path of its farthest point. A candidate that cannot touch before the two bodies
have moved by a certain path is left alone until they have; the others are hot, and the pair kernel
sees nothing else. What is hot never changes a result, only its cost.
"""

import functools

import warp as wp
from warpdem.kernels.cell import real_vector
from warpdem.kernels.clearance import clearance
from warpdem.kernels.narrow import FAR
from warpdem.kernels.precision import ROUNDING, vec3, wide
from warpdem.kernels.variant import inlined, place, variant
from warpdem.kernels.views import Bodies, Candidates, Cell, Clock, Geometry, Pairs

SLACK = wp.constant(wide(ROUNDING))


@inlined()
def pace(geometry: Geometry, bodies: Bodies, body: int) -> wide:
    """Speed of a body's farthest point [m/s]."""
    spinning = wp.length(bodies.spin[body])
    return wp.length(bodies.velocity[body]) + geometry.bound[body] * spinning


@functools.cache
def refresh(*, surfaces: bool, periodic: bool) -> wp.Kernel:
    """Kernel that renews the hot lists of the pairs that have moved far enough."""
    clear_of = clearance(surfaces=surfaces)

    @variant
    def refresh(
        # model
        geometry: Geometry,
        # in
        reach: wide,
        margin: wide,
        ahead: wide,
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        clock: Clock,
        cell: Cell,
        # in and out
        pairs: Pairs,
        candidates: Candidates,
    ):
        pair = place(wp.tid() + span[0])
        if pair >= span[1] or clock.halted[0] != 0:
            return
        i = place(pairs.owner[pair])
        j = place(pairs.partner[pair])
        path = bodies.path[i] + bodies.path[j]
        if path < pairs.cold[pair]:
            return
        d = bodies.position[i] - bodies.position[j]
        if wp.static(periodic):
            d -= cell.edges[0] * real_vector(pairs.image[pair])
        branch = vec3(d)
        soon = ahead * (pace(geometry, bodies, i) + pace(geometry, bodies, j))
        limit = path + wp.max(margin, soon)
        # what attracts, and rounding
        slack = reach + SLACK * (geometry.bound[i] + geometry.bound[j])
        cold = wide(FAR)
        start = pairs.start[pair]
        end = start
        for c in range(start, pairs.start[pair + 1]):
            clear = candidates.clear[c]
            if clear <= limit:
                code = candidates.code[c]
                clear = path + wide(clear_of(geometry, bodies, i, j, branch, code)) - slack
                candidates.clear[c] = clear
            if clear <= limit or candidates.past[c][3] != wide(-1.0):
                candidates.hot[end] = c
                end += 1
            else:
                cold = wp.min(cold, clear)
        pairs.hot_end[pair] = end
        pairs.cold[pair] = cold

    return refresh
