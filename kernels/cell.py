"""The periodic cell: images of bodies, and the deformation of the cell.

The columns of H are the cell's edges; image n of a body lies at x + H n and moves at v + H' n. The
edges obey the same equation as the bodies, x'' = F/m + A x with A = L' + L^2 and L = H' H^-1 the
velocity gradient, and are stepped as they are (kick, drift, kick): a body and its images stay
equivalent to rounding. Positions x count from the centre of the cell. With c = v - L x, the motion
against the homogeneous flow, the bodies obey c' = F/m - L c; Parrinello & Rahman (1981),
doi:10.1063/1.328693, Todd & Daivis (2017), Nonequilibrium Molecular Dynamics.
"""

import functools

import warp as wp
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Bodies, Cell, Clock, Incidence, Inertia, Pairs

# chunks of the sums over pairs and bodies: the same for any number of host threads
CHUNKS = 256
CHUNK_COUNT = wp.constant(CHUNKS)


@wp.func
def real_vector(n: wp.vec3i) -> wide3:
    """Integers as a vector of reals."""
    return wide3(wide(n[0]), wide(n[1]), wide(n[2]))


@wp.func
def norm(a: wide33) -> wide:
    """Frobenius norm, a bound of what a matrix does to a length."""
    return wp.sqrt(wp.ddot(a, a))


@inlined()
def branch_of(bodies: Bodies, pairs: Pairs, cell: Cell, pair: int) -> wide3:
    """Centre of the owner about that of the partner's image [m]."""
    i = pairs.owner[pair]
    j = pairs.partner[pair]
    d = bodies.position[i] - bodies.position[j]
    return d - cell.edges[0] * real_vector(pairs.image[pair])


@inlined()
def advance_cell(cell: Cell, dt: wide):
    """Half kick and drift of the edges, and what became of them since the lists were made."""
    half = wide(0.5) * dt
    edges = cell.edges[0]
    kicked = cell.acceleration[0] * edges * half
    rate = cell.rate[0] + kicked
    cell.rate[0] = rate
    cell.rate_end[0] = rate + kicked
    cell.edges[0] = edges + rate * dt
    cell.time[0] = cell.time[0] + dt
    since = cell.edges[0] * wp.inverse(cell.listed[0])
    cell.since[0] = since
    cell.stretch[0] = norm(since - wp.identity(n=3, dtype=wide))


@plain
def drift_cell(
    # in
    dt: wide,
    clock: Clock,
    # in and out
    cell: Cell,
):
    """First half of a step of the cell."""
    if clock.halted[0] == 0:
        advance_cell(cell, dt)


@functools.cache
def sum_stress(*, predicted: bool) -> wp.Kernel:
    """Kernel of the partial sums of f (x) d over pairs and m c (x) c over bodies, by chunks."""

    @variant
    def sum_stress(
        # model
        inertia: Inertia,
        body_count: int,
        # in
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        pairs: Pairs,
        incidence: Incidence,
        clock: Clock,
        # in and out
        cell: Cell,
    ):
        chunk = wp.tid() + span[0]
        if chunk >= span[1] or clock.halted[0] != 0:
            return
        total = wide33()
        pair_count = incidence.start[body_count]
        first = int(wp.int64(pair_count) * wp.int64(chunk) / wp.int64(CHUNK_COUNT))
        last = int(wp.int64(pair_count) * wp.int64(chunk + 1) / wp.int64(CHUNK_COUNT))
        for pair in range(first, last):
            if pairs.touching[pair] > 0:
                total += wp.outer(wide3(pairs.force[pair]), branch_of(bodies, pairs, cell, pair))
        first = int(wp.int64(body_count) * wp.int64(chunk) / wp.int64(CHUNK_COUNT))
        last = int(wp.int64(body_count) * wp.int64(chunk + 1) / wp.int64(CHUNK_COUNT))
        flow = cell.rate_end[0] * wp.inverse(cell.edges[0])
        for body in range(first, last):
            if inertia.inverse_mass[body] > wide(0.0):
                velocity = bodies.velocity[body]
                if wp.static(predicted):
                    velocity = bodies.velocity_end[body]
                c = velocity - flow * (bodies.position[body] - cell.centre[0])
                total += wp.outer(c, c) / inertia.inverse_mass[body]
        cell.sums[chunk] = total

    return sum_stress


@wp.func
def controlled(
    stress: wide33, target: wide33, held: wide33, gradient: wide33, pull: wide, damping: wide
) -> wide33:
    """L' of the components held at a stress (``held`` 1): (V/M)(stress - target) - damping L."""
    rate = wide33()
    for a in range(3):
        for b in range(3):
            excess = wide(0.5) * (stress[a, b] + stress[b, a]) - target[a, b]
            rate[a, b] = held[a, b] * (pull * excess - damping * gradient[a, b])
    return rate


@functools.cache
def kick_cell(*, sums: bool, onward: bool) -> wp.Kernel:
    """Kernel of the second half of a step of the cell; ``onward`` begins the next one."""

    @variant
    def kick_cell(
        # in
        dt: wide,
        clock: Clock,
        # in and out
        cell: Cell,
    ):
        if clock.halted[0] != 0:
            return
        edges = cell.edges[0]
        inverse = wp.inverse(edges)
        half = wide(0.5) * dt
        guess = cell.rate_end[0] * inverse
        active = wide(0.0)
        if cell.time[0] >= cell.start[0] - half and cell.time[0] < cell.stop[0] - half:
            active = wide(1.0)
        total = wide33()
        wanted = wide33()
        if wp.static(sums):
            for chunk in range(CHUNK_COUNT):
                total += cell.sums[chunk]
            volume = wp.determinant(edges)
            pull = volume / cell.inertia[0] * active
            wanted = controlled(
                total / volume, cell.target[0], cell.held[0], guess, pull, cell.damping[0] * active
            )
        acceleration = wanted + guess * guess
        gradient = cell.rate[0] * inverse + acceleration * half
        # components of given rate have it exactly; the others stand still when control is off
        jump = wide33()
        for a in range(3):
            for b in range(3):
                free = cell.held[0][a, b] * active
                goal = cell.given[0][a, b] * active
                jump[a, b] = (wide(1.0) - free) * (goal - gradient[a, b])
        if wp.static(sums):
            power = -wp.ddot(total, gradient)
            cell.work[0] = cell.work[0] + half * (cell.power[0] + power)
            cell.power[0] = -wp.ddot(total, gradient + jump)
        cell.acceleration[0] = acceleration
        cell.jump[0] = jump
        cell.gradient[0] = gradient + jump
        cell.rate[0] = (gradient + jump) * edges
        if wp.static(onward):
            advance_cell(cell, dt)

    return kick_cell
