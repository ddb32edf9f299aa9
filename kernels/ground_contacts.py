"""Closed contacts of a rock with ground and trunks in the middle of a step."""

import functools

import warp as wp
from warpdem.kernels.fall_views import (
    DROPPED,
    TREE,
    Contact,
    Flights,
    Obstacles,
    Rocks,
    Terrain,
)
from warpdem.kernels.ground import column_of, row_of, upward_normal
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.variant import inlined

# squared sine against the vertical below which an edge is upright
UPRIGHT = wp.constant(wide(1.0e-18))
# difference of two distances from a trunk, over the rock's size, that is rounding
ALIKE = wp.constant(wide(1.0e-9))


@wp.struct
class Touched:
    """What a rock touches: number of closed contacts, depth of the deepest [m]."""

    count: int
    depth: wide


@inlined()
def admit(flights: Flights, slot: int, count: int, contact: Contact) -> int:
    """Put a contact into the list; when that is full, the shallowest one is left out, counted."""
    place = count
    capacity = flights.contact.shape[1]
    if count == capacity:
        flights.count[slot, DROPPED] += 1
        place = int(0)
        for c in range(capacity):
            if flights.contact[slot, c].gap > flights.contact[slot, place].gap:
                place = c
        if flights.contact[slot, place].gap <= contact.gap:
            return count
        flights.contact[slot, place] = contact
        return count
    flights.contact[slot, place] = contact
    return count + 1


@inlined()
def steepest(terrain: Terrain, at: wide3, bound: wide) -> wide:
    """Largest slope anywhere below a rock; infinite where that is not known."""
    slope = wide(wp.inf)
    if bound <= terrain.reach:
        slope = terrain.steep[row_of(terrain, at[1]), column_of(terrain, at[0])]
    return slope


@functools.cache
def touch_ground(ground: wp.Function, *, rounded: bool) -> wp.Function:
    """Function that lists the vertices at or below the ground.

    Their percussions begin with ``warm`` times the last ones.
    """

    @inlined()
    def touch_ground(
        terrain: Terrain,
        rocks: Rocks,
        rock: int,
        centre: wide3,
        turn: wide33,
        friction: wide,
        warm: wide,
        flights: Flights,
        slot: int,
    ) -> Touched:
        touched = Touched()
        slope = steepest(terrain, centre, rocks.bound[rock])
        above = centre[2] - ground(terrain, centre[0], centre[1])[0]
        if wp.static(rounded):
            above -= rocks.rounding[rock] * wp.sqrt(wide(1.0) + slope * slope)
        for i in range(rocks.vertex_count[rock]):
            last = warm * flights.percussion[slot, i]
            flights.percussion[slot, i] = wide3()
            arm = turn @ rocks.vertex[rock, i]
            # above every ground of that slope through the one below the centre
            if above + arm[2] > slope * (wp.abs(arm[0]) + wp.abs(arm[1])):
                continue
            place = centre + arm
            under = ground(terrain, place[0], place[1])
            gap = place[2] - under[0]
            if wp.static(rounded):
                steepness = wp.sqrt(wide(1.0) + under[1] * under[1] + under[2] * under[2])
                gap -= rocks.rounding[rock] * steepness
            if gap <= wide(0.0):
                contact = Contact()
                contact.vertex = i
                contact.gap = gap
                contact.friction = friction
                contact.normal = upward_normal(under)
                contact.arm = arm
                if wp.static(rounded):
                    contact.arm = arm - rocks.rounding[rock] * contact.normal
                contact.percussion = last
                touched.count = admit(flights, slot, touched.count, contact)
                touched.depth = wp.max(touched.depth, -gap)
        return touched

    return touch_ground


@inlined()
def sink(flights: Flights, slot: int, touched: Touched, scar: wide) -> Touched:
    """The contacts with the hard ground, ``scar`` below the surface; the others are taken out."""
    left = Touched()
    for c in range(touched.count):
        contact = flights.contact[slot, c]
        if contact.gap + scar <= wide(0.0):
            contact.gap = contact.gap + scar
            flights.contact[slot, left.count] = contact
            left.count += 1
            left.depth = wp.max(left.depth, -contact.gap)
    return left


@wp.func
def nearest_on(a: wide3, b: wide3) -> wide3:
    """Point of the segment a b that is nearest to the z axis; its middle if it is upright."""
    along = b - a
    length = along[0] * along[0] + along[1] * along[1]
    part = wide(0.5)
    if length > UPRIGHT * wp.length_sq(along):
        part = wp.clamp(-(a[0] * along[0] + a[1] * along[1]) / length, wide(0.0), wide(1.0))
    return a + part * along


@wp.func
def lowered(a: wide3, b: wide3, top: wide) -> wide3:
    """End a of the segment a b, or where it sinks below ``top``; b is below."""
    end = a
    if a[2] > top:
        end = a + ((a[2] - top) / (a[2] - b[2])) * (b - a)
    return end


@inlined()
def touch_tree(
    obstacles: Obstacles, rocks: Rocks, rock: int, centre: wide3, turn: wide33, tree: int
) -> Contact:
    """Contact of a rock with a trunk; its gap is positive when there is none.

    Seen from above a convex rock outside the axis is nearest to it with one of its edges, as far
    as they are below the trunk's top. Where several are as near, as of an upright face, it touches
    in the middle of their heights.
    """
    trunk = obstacles.tree[tree]
    top = obstacles.tree_top[tree]
    axis = wide3(trunk[0], trunk[1], wide(0.0))
    alike = ALIKE * rocks.bound[rock]
    nearest = wide3()
    closest = wide(wp.inf)
    low = wide(0.0)
    high = wide(0.0)
    for k in range(rocks.edge_count[rock]):
        edge = rocks.edge[rock, k]
        a = centre + turn @ rocks.vertex[rock, edge[0]] - axis
        b = centre + turn @ rocks.vertex[rock, edge[1]] - axis
        if wp.min(a[2], b[2]) <= top:
            place = nearest_on(lowered(a, b, top), lowered(b, a, top))
            distance = wp.sqrt(place[0] * place[0] + place[1] * place[1])
            if distance < closest - alike:
                nearest = place
                low = place[2]
                high = place[2]
            elif distance <= closest + alike:
                low = wp.min(low, place[2])
                high = wp.max(high, place[2])
            closest = wp.min(closest, distance)
    nearest[2] = wide(0.5) * (low + high)
    contact = Contact()
    contact.vertex = int(-1)
    contact.friction = obstacles.tree_friction[tree]
    contact.normal = wp.normalize(wide3(nearest[0], nearest[1], wide(0.0)))
    contact.arm = nearest + axis - centre - rocks.rounding[rock] * contact.normal
    contact.gap = closest - trunk[2] - rocks.rounding[rock]
    if closest == wide(0.0):
        contact.gap = wide(1.0)
    return contact


@inlined()
def touch_trees(
    terrain: Terrain,
    obstacles: Obstacles,
    rocks: Rocks,
    rock: int,
    centre: wide3,
    turn: wide33,
    flights: Flights,
    slot: int,
    touched: Touched,
) -> Touched:
    """Add the contacts with the trunks near the rock."""
    all_touched = touched
    i = column_of(terrain, centre[0])
    j = row_of(terrain, centre[1])
    if (terrain.near[j, i] & TREE) != 0:
        number = j * terrain.columns + i
        for k in range(obstacles.tree_start[number], obstacles.tree_start[number + 1]):
            tree = obstacles.tree_member[k]
            contact = touch_tree(obstacles, rocks, rock, centre, turn, tree)
            if contact.gap <= wide(0.0):
                all_touched.count = admit(flights, slot, all_touched.count, contact)
                all_touched.depth = wp.max(all_touched.depth, -contact.gap)
    return all_touched
