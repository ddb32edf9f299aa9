"""What the host looks at when lists are made anew: numbers, depths of contacts, speeds.

Everything here runs once a rebuild, never in a step.
"""

import functools

import warp as wp
from warpdem.kernels.cell import real_vector
from warpdem.kernels.codes import FV, VF, VS, feature_of_owner, feature_of_partner, kind_of
from warpdem.kernels.narrow import FAR
from warpdem.kernels.precision import wide, wide3
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Bodies, Candidates, Cell, Geometry, Pairs

# how far the square of an orientation's length may be from one
UNIT = wp.constant(wide(1.0e-6))


@wp.struct
class Room:
    """How far bodies may go into each other, and how fast; arrays are those of bodies."""

    # to the middle of the solid behind its nearest face [m]; 0 for sheets, -1 without faces
    half: wp.array(dtype=wide)
    lever: wp.array(dtype=wide)  # how far its core reaches from the centre of mass [m]
    # speed at which it may get halfway through the thinnest that there is [m/s], and so far it may
    # then go before somebody looks [m]
    critical: wp.array(dtype=wide)
    narrow: wp.array(dtype=wide)


@wp.func
def size(v: wide3) -> wide:
    """Sum of magnitudes: not finite where a part is not."""
    return wp.abs(v[0]) + wp.abs(v[1]) + wp.abs(v[2])


@plain
def find_unsound(
    # in
    bodies: Bodies,
    # out
    found: wp.array(dtype=wp.int32),
):
    """Note that some body has a state that is no number, or an orientation that is no rotation."""
    body = wp.tid()
    total = size(bodies.position[body]) + size(bodies.velocity[body]) + size(bodies.spin[body])
    total += size(bodies.momentum[body]) + size(bodies.angular_momentum[body])
    total += size(bodies.force[body]) + size(bodies.torque[body])
    if not wp.isfinite(total):
        found[0] = 1
    q = bodies.orientation[body]
    if not (wp.abs(wp.dot(q, q) - wide(1.0)) <= UNIT):
        found[0] = 1


@inlined()
def behind(geometry: Geometry, body: int, face: int) -> wide:
    """How far behind a face of a body the middle of its solid is [m]."""
    shape = geometry.shape[body]
    return wide(geometry.depth[geometry.face_start[shape] + face] * geometry.scale[body])


@plain
def measure_depths(
    # model
    geometry: Geometry,
    room: Room,
    # in
    pairs: Pairs,
    candidates: Candidates,
    # out
    depth: wp.array(dtype=wp.vec2d),
):
    """Depth of the deepest contact of each pair: over its room, and less the roundings [m].

    The room of a contact is where it pushes back the way it came: to the middle of the solid behind
    a face; both roundings where neither body has a core; the bounding radius before a surface.
    """
    pair = wp.tid()
    i = pairs.owner[pair]
    j = pairs.partner[pair]
    rounding = wide(geometry.radius[i]) + wide(geometry.radius[j])
    thin = not (room.half[i] > wide(0.0)) and not (room.half[j] > wide(0.0))
    deepest = wide(0.0)
    beyond = -wide(FAR)
    start = pairs.start[pair]
    for slot in range(start, start + pairs.touching[pair]):
        overlap = -wide(candidates.gap[slot])
        code = candidates.code[candidates.which[slot]]
        kind = kind_of(code)
        space = wide(0.0)
        if kind == VF:
            space = rounding + behind(geometry, j, feature_of_partner(code))
        elif kind == FV:
            space = rounding + behind(geometry, i, feature_of_owner(code))
        elif kind == VS:
            space = geometry.bound[i]
        elif thin:
            space = rounding
        if space > wide(0.0):
            deepest = wp.max(deepest, overlap / space)
        # sharp bodies have no rounding to exceed
        if rounding > wide(0.0):
            beyond = wp.max(beyond, overlap - rounding)
    depth[pair] = wp.vec2d(deepest, beyond)


@functools.cache
def measure_rush(*, periodic: bool) -> wp.Kernel:
    """Kernel of how fast the bodies of each pair go through the room between them [1/s]."""

    @variant
    def measure_rush(
        # model
        geometry: Geometry,
        room: Room,
        # in
        bodies: Bodies,
        pairs: Pairs,
        cell: Cell,
        # out
        rush: wp.array(dtype=wide),
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        rush[pair] = wide(0.0)
        if geometry.surface[geometry.shape[j]] != 0:
            return  # what is beyond a surface is pushed back from any depth
        velocity = bodies.velocity[i] - bodies.velocity[j]
        if wp.static(periodic):
            velocity -= cell.rate[0] * real_vector(pairs.image[pair])
        pace = wp.length(velocity) + room.lever[i] * wp.length(bodies.spin[i])
        pace += room.lever[j] * wp.length(bodies.spin[j])
        space = wide(geometry.radius[i]) + wide(geometry.radius[j])
        mine = room.half[i]
        theirs = room.half[j]
        if mine >= wide(0.0) and theirs >= wide(0.0):
            space += wp.min(mine, theirs)
        else:
            space += wp.max(wp.max(mine, theirs), wide(0.0))
        # a sharp body and a sheet without thickness never touch
        if space > wide(0.0):
            rush[pair] = pace / space

    return measure_rush
