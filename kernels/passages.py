"""What a rock passes on its way: cells of results and barriers."""

import functools

import warp as wp
from warpdem.kernels.fall_views import (
    DROPPED,
    LARGEST,
    LARGEST_COUNT,
    Crossing,
    Flights,
    Motion,
    Obstacles,
    ResultGrid,
    Rocks,
    Rules,
    Terrain,
    Visit,
)
from warpdem.kernels.precision import wide, wide3, wide4
from warpdem.kernels.variant import inlined

# a part of a way beyond its end: nothing is met
NEVER = wp.constant(wide(2.0))
# by which a rock is set behind a barrier it has broken [m]
BEYOND = wp.constant(wide(1.0e-6))
# lines of the grid that one stretch can cross: Rules.travel is 16 cells along each axis
MOST_BORDERS = wp.constant(34)


@wp.struct
class Way:
    """A stretch of a trajectory, straight in plan."""

    start: wide3
    along: wide3  # from start to end
    bulge: wide  # z above the straight line at part f is 4 f (1 - f) times this [m]
    velocity: wide3
    change: wide3  # of the velocity
    spinning: wide  # energy of rotation at the start [J]
    spun: wide  # its change
    mass: wide
    spin: wide  # the larger of both ends [rad/s]
    time: wide
    duration: wide


@wp.func
def spin_energy(motion: Motion, theta: wide3) -> wide:
    """Kinetic energy of rotation [J]."""
    return wide(0.5) * wp.dot(motion.spin, wp.cw_mul(theta, motion.spin))


@inlined()
def way_of(rocks: Rocks, rules: Rules, rock: int, before: Motion, after: Motion) -> Way:
    """The stretch between two states."""
    way = Way()
    h = after.time - before.time
    way.start = before.position
    way.along = after.position - before.position
    if after.near_ground == 0:
        way.bulge = wide(-0.125) * h * h * rules.gravity[2]
    way.velocity = before.velocity
    way.change = after.velocity - before.velocity
    way.mass = rocks.mass[rock]
    way.spinning = spin_energy(before, rocks.inertia[rock])
    way.spun = spin_energy(after, rocks.inertia[rock]) - way.spinning
    way.spin = wp.sqrt(wp.max(wp.length_sq(before.spin), wp.length_sq(after.spin)))
    way.time = before.time
    way.duration = h
    return way


@wp.func
def place_on(way: Way, part: wide) -> wide3:
    """Where the rock is after a part of the way."""
    place = way.start + part * way.along
    place[2] = place[2] + wide(4.0) * part * (wide(1.0) - part) * way.bulge
    return place


@wp.func
def energy_on(way: Way, part: wide) -> wide:
    """Kinetic energy after a part of the way [J]."""
    moving = wp.length_sq(way.velocity + part * way.change)
    return wide(0.5) * way.mass * moving + way.spinning + part * way.spun


@functools.cache
def values_on(ground: wp.Function) -> wp.Function:
    """Function of energy, speed, height above ground and spin after a part of the way."""

    @inlined()
    def values_on(terrain: Terrain, way: Way, part: wide) -> wide4:
        place = place_on(way, part)
        height = place[2] - ground(terrain, place[0], place[1])[0]
        speed = wp.length(way.velocity + part * way.change)
        return wide4(energy_on(way, part), speed, height, way.spin)

    return values_on


@inlined()
def result_cell(grid: ResultGrid, place: wide3) -> int:
    """Number of the cell of results under a place; -1 outside."""
    i = int(wp.floor((place[0] - grid.x) * grid.per_metre))
    j = int(wp.floor((place[1] - grid.y) * grid.per_metre))
    number = int(-1)
    if i >= 0 and j >= 0 and i < grid.columns and j < grid.rows:
        number = j * grid.columns + i
    return number


@wp.func
def larger(visit: Visit, values: wide4) -> Visit:
    """The visit with larger values taken in."""
    grown = visit
    grown.energy = wp.max(visit.energy, wp.float32(values[0]))
    grown.speed = wp.max(visit.speed, wp.float32(values[1]))
    grown.jump = wp.max(visit.jump, wp.float32(values[2]))
    grown.spin = wp.max(visit.spin, wp.float32(values[3]))
    return grown


@inlined()
def leave(flights: Flights, slot: int, visit: Visit):
    """Write down a visit that is over; one that does not fit is counted."""
    number = flights.visit_count[slot]
    if visit.cell >= 0:
        if number < flights.visit.shape[1]:
            flights.visit[slot, number] = visit
            flights.visit_count[slot] = number + 1
        else:
            flights.count[slot, DROPPED] += 1


@inlined()
def next_border(grid: ResultGrid, way: Way, part: wide) -> wide:
    """Part of the way at which the plan next crosses a line of the grid; 1 at its end."""
    # a billionth of the way on, so that a border just crossed is behind
    x = way.start[0] + (part + wide(1.0e-9)) * way.along[0]
    y = way.start[1] + (part + wide(1.0e-9)) * way.along[1]
    i = wp.floor((x - grid.x) / grid.cell)
    j = wp.floor((y - grid.y) / grid.cell)
    border = wide(1.0)
    if way.along[0] > wide(0.0):
        border = wp.min(
            border, (grid.x + (i + wide(1.0)) * grid.cell - way.start[0]) / way.along[0]
        )
    elif way.along[0] < wide(0.0):
        border = wp.min(border, (grid.x + i * grid.cell - way.start[0]) / way.along[0])
    if way.along[1] > wide(0.0):
        border = wp.min(
            border, (grid.y + (j + wide(1.0)) * grid.cell - way.start[1]) / way.along[1]
        )
    elif way.along[1] < wide(0.0):
        border = wp.min(border, (grid.y + j * grid.cell - way.start[1]) / way.along[1])
    return wp.max(border, part + wide(1.0e-9))


@functools.cache
def walk_cells(ground: wp.Function) -> wp.Function:
    """Function that takes a stretch into the cells it lies over, none of them left out."""
    values = values_on(ground)

    @inlined()
    def walk_cells(
        terrain: Terrain, grid: ResultGrid, flights: Flights, slot: int, way: Way, visited: Visit
    ) -> Visit:
        visit = visited
        last = result_cell(grid, way.start + way.along)
        part = wide(0.0)
        borders = int(0)
        while visit.cell != last and part < wide(1.0) and borders < MOST_BORDERS:
            borders += 1
            border = wp.min(next_border(grid, way, part), wide(1.0))
            cell = result_cell(grid, place_on(way, wide(0.5) * (part + border)))
            if cell != visit.cell:
                leave(flights, slot, visit)
                visit = Visit()
                visit.cell = cell
                visit = larger(visit, values(terrain, way, part))
            visit = larger(visit, values(terrain, way, wide(0.5) * (part + border)))
            visit = larger(visit, values(terrain, way, border))
            part = border
        if visit.cell != last:  # a way so short that rounding hides where it crosses the border
            leave(flights, slot, visit)
            visit = Visit()
            visit.cell = last
        visit = larger(visit, values(terrain, way, wide(0.5) * (part + wide(1.0))))
        return larger(visit, values(terrain, way, wide(1.0)))

    return walk_cells


@functools.cache
def observe(ground: wp.Function, *, visits: bool) -> wp.Function:
    """Function that keeps the largest values of a trajectory, and of the cells it passes."""
    values = values_on(ground)
    walk = walk_cells(ground)

    @inlined()
    def observe(terrain: Terrain, grid: ResultGrid, flights: Flights, slot: int, way: Way):
        end = values(terrain, way, wide(1.0))
        middle = end
        if way.bulge > wide(0.0):
            middle = values(terrain, way, wide(0.5))
        for k in range(LARGEST_COUNT):
            most = wp.max(middle[k], end[k])
            if most > flights.measure[slot, LARGEST + k]:
                flights.measure[slot, LARGEST + k] = most
        if wp.static(visits):
            visit = flights.here[slot]
            if result_cell(grid, way.start + way.along) == visit.cell:
                visit = larger(larger(visit, middle), end)
            else:
                visit = walk(terrain, grid, flights, slot, way, visit)
            flights.here[slot] = visit

    return observe


@inlined()
def meeting(obstacles: Obstacles, piece: int, way: Way) -> wide:
    """Part of the way at which it crosses a barrier's piece; NEVER if it does not."""
    a = obstacles.piece_from[piece]
    b = obstacles.piece_to[piece]
    along = b - a
    start = along[0] * (way.start[1] - a[1]) - along[1] * (way.start[0] - a[0])
    end = start + along[0] * way.along[1] - along[1] * way.along[0]
    met = NEVER
    # on the line counts as the left, so that no passage is counted twice or missed
    if (start >= wide(0.0)) != (end >= wide(0.0)):
        part = start / (start - end)
        x = way.start[0] + part * way.along[0] - a[0]
        y = way.start[1] + part * way.along[1] - a[1]
        place = (x * along[0] + y * along[1]) / wp.length_sq(along)
        if place >= wide(0.0) and place < wide(1.0):
            met = part
    return met


@inlined()
def write_crossing(flights: Flights, slot: int, crossing: Crossing):
    """Write down a crossing; one that does not fit is counted."""
    number = flights.crossing_count[slot]
    if number < flights.crossing.shape[1]:
        flights.crossing[slot, number] = crossing
        flights.crossing_count[slot] = number + 1
    else:
        flights.count[slot, DROPPED] += 1


@wp.struct
class Met:
    """The barrier a rock met first on a stretch, beyond the part it had come to."""

    part: wide
    piece: int


@inlined()
def first_met(obstacles: Obstacles, way: Way, after_part: wide, after_piece: int) -> Met:
    """The next piece on the way in the order of part, then number; NEVER if there is none."""
    met = Met()
    met.part = NEVER
    for piece in range(obstacles.piece_from.shape[0]):
        part = meeting(obstacles, piece, way)
        later = part > after_part or (part == after_part and piece > after_piece)
        if later and part < met.part:
            met.part = part
            met.piece = piece
    return met


@wp.struct
class Stop:
    """Where a barrier acts on a stretch, NEVER if none does, and what it leaves of the energy."""

    part: wide
    kept: wide
    caught: int


@functools.cache
def cross_barriers(ground: wp.Function) -> wp.Function:
    """Function that records the barriers on a stretch up to the first that acts on the rock."""

    @inlined()
    def cross_barriers(
        terrain: Terrain, obstacles: Obstacles, flights: Flights, slot: int, way: Way
    ) -> Stop:
        stop = Stop()
        stop.part = NEVER
        stop.kept = wide(1.0)
        met = first_met(obstacles, way, wide(-1.0), -1)
        while met.part < NEVER and stop.part == NEVER:
            barrier = obstacles.piece_barrier[met.piece]
            crossing = Crossing()
            crossing.barrier = barrier
            crossing.position = place_on(way, met.part)
            crossing.time = way.time + met.part * way.duration
            under = ground(terrain, crossing.position[0], crossing.position[1])
            crossing.height = crossing.position[2] - under[0]
            crossing.energy = energy_on(way, met.part)
            crossing.speed = wp.length(way.velocity + met.part * way.change)
            crossing.spin = way.spin
            capacity = obstacles.barrier_capacity[barrier]
            if capacity > wide(0.0) and crossing.height <= obstacles.barrier_height[barrier]:
                stop.part = met.part
                if crossing.energy <= capacity:
                    crossing.caught = 1
                    stop.caught = 1
                else:
                    stop.kept = wide(1.0) - capacity / crossing.energy
                    # a micrometre beyond, so that it is met once
                    stop.part = wp.min(met.part + BEYOND / wp.length(way.along), wide(1.0))
            write_crossing(flights, slot, crossing)
            met = first_met(obstacles, way, met.part, met.piece)
        return stop

    return cross_barriers


@wp.func
def cut(before: Motion, after: Motion, way: Way, part: wide) -> Motion:
    """The state after a part of a stretch."""
    short = after
    short.position = place_on(way, part)
    short.velocity = before.velocity + part * way.change
    short.spin = before.spin + part * (after.spin - before.spin)
    final = after.orientation
    if wp.dot(before.orientation, final) < wide(0.0):
        final = -final
    short.orientation = wp.normalize(before.orientation + (final - before.orientation) * part)
    short.slip = before.slip + part * (after.slip - before.slip)
    short.time = before.time + part * way.duration
    return short
