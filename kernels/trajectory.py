"""A whole trajectory: one thread a rock, many passes a launch.

A pass is a stretch of free flight or one step with its contacts. Passes are counted, not time, and
none is cut at the end of a launch, so results do not depend on how many passes a launch has.
"""

import functools

import warp as wp
from warpdem.kernels.contact_step import Parts, contact_step
from warpdem.kernels.fall_views import (
    BROKEN,
    CAUGHT,
    FLIGHT_STEPS,
    JUMPS,
    LEFT,
    MOVING,
    REST,
    SCREEN,
    TIMEOUT,
    Flights,
    GroundClasses,
    Motion,
    Obstacles,
    ResultGrid,
    Rocks,
    Rules,
    Terrain,
    Window,
)
from warpdem.kernels.free_flight import canopy_drag, fly, free_steps, step_length
from warpdem.kernels.ground import column_of, is_known, row_of
from warpdem.kernels.passages import (
    NEVER,
    cross_barriers,
    cut,
    leave,
    observe,
    way_of,
)
from warpdem.kernels.precision import wide
from warpdem.kernels.rotation import arc
from warpdem.kernels.variant import fused, inlined, variant

# squared speed beyond which nothing is computed [m^2/s^2]
FASTEST = wp.constant(wide(1.0e100))


@inlined()
def fate_of(
    terrain: Terrain, rules: Rules, rocks: Rocks, flights: Flights, slot: int, motion: Motion
) -> int:
    """Whether a rock has come to rest, left the ground, run out of time, or ceased to be finite.

    At rest is what stays where it is over a whole window and is in contact at its end: a rock that
    turns over is slow too, and so is one that starts from rest.
    """
    fate = MOVING
    window = flights.window[slot]
    if motion.time - window.time >= rules.rest_time:
        bound = rocks.bound[flights.rock[slot]]
        moved = wp.length(motion.position - window.position)
        moved += bound * arc(motion.orientation, window.orientation)
        if motion.touching == 1 and moved <= rules.rest_move * bound:
            fate = REST
        fresh = Window()
        fresh.position = motion.position
        fresh.orientation = motion.orientation
        fresh.time = motion.time
        flights.window[slot] = fresh
    if not (wp.length_sq(motion.velocity) + wp.length_sq(motion.spin) < FASTEST):
        fate = BROKEN
    elif not is_known(terrain, motion.position[0], motion.position[1]):
        fate = LEFT
    elif fate == MOVING and motion.time >= rules.duration:
        fate = TIMEOUT
    return fate


@functools.cache
def one_pass(parts: Parts) -> wp.Function:
    """Function of one pass of a rock."""
    ground = parts.ground
    step = contact_step(parts)
    flown = fly(parts.middle_spin, forest=parts.forest)
    canopy = canopy_drag(ground)
    steps_free = free_steps(ground, jumps=parts.jumps, obstacles=parts.forest or parts.trees)

    @inlined()
    def one_pass(
        terrain: Terrain, rocks: Rocks, classes: GroundClasses, obstacles: Obstacles,
        rules: Rules, flights: Flights, slot: int, motion: Motion,
    ) -> Motion:  # fmt: skip
        rock = flights.rock[slot]
        dt = step_length(rules, motion, rocks.bound[rock])
        steps = int(0)
        if wp.static(parts.sphere):
            if motion.near_ground == 0:
                steps = steps_free(terrain, rocks, rules, motion, rock, dt)
        after = Motion()
        if steps > 0:
            drag = wide(0.0)
            if wp.static(parts.forest):
                drag = canopy(terrain, obstacles, motion.position, wide(1.0) / rocks.mass[rock])
            h = dt * wide(steps)
            after = flown(rules, motion, rocks.inertia[rock], drag, h)
            at = motion.position
            kind = terrain.class_of[row_of(terrain, at[1]), column_of(terrain, at[0])]
            after.slip = motion.slip * wp.exp(-classes.beta[kind] * h)
            flights.count[slot, FLIGHT_STEPS] += steps
            flights.count[slot, JUMPS] += 1
        else:
            after = step(terrain, rocks, classes, obstacles, rules, flights, slot, rock, motion, dt)
        return after

    return one_pass


@functools.cache
def advance(parts: Parts) -> wp.Kernel:
    """Kernel that moves every rock of a list by up to so many passes."""
    ground = parts.ground
    onward = one_pass(parts)
    watch = observe(ground, visits=parts.visits)
    barriers = cross_barriers(ground)
    build = fused if parts.fused else variant

    @build
    def advance(
        # model
        terrain: Terrain,
        rocks: Rocks,
        classes: GroundClasses,
        obstacles: Obstacles,
        rules: Rules,
        grid: ResultGrid,
        # in
        passes: int,
        visit_room: int,
        crossing_room: int,
        active: wp.array(dtype=wp.int32),
        # in and out
        flights: Flights,
    ):
        slot = active[wp.tid()]
        rock = flights.rock[slot]
        motion = flights.motion[slot]
        fate = MOVING
        done = int(0)
        while done < passes and fate == MOVING:
            done += 1
            after = onward(terrain, rocks, classes, obstacles, rules, flights, slot, motion)
            way = way_of(rocks, rules, rock, motion, after)
            if wp.static(parts.screens):
                kept = wide(1.0)
                at = motion.position
                near = terrain.near[row_of(terrain, at[1]), column_of(terrain, at[0])]
                if (near & SCREEN) != 0:
                    stop = barriers(terrain, obstacles, flights, slot, way)
                    kept = wp.sqrt(stop.kept)
                    if stop.part < NEVER:
                        after = cut(motion, after, way, stop.part)
                        way = way_of(rocks, rules, rock, motion, after)
                    if stop.caught == 1:
                        fate = CAUGHT
            watch(terrain, grid, flights, slot, way)
            motion = after
            if wp.static(parts.screens):
                motion.velocity = kept * motion.velocity
                motion.spin = kept * motion.spin
            if fate == MOVING:
                fate = fate_of(terrain, rules, rocks, flights, slot, motion)
            if flights.visit_count[slot] > visit_room:
                done = passes
            if wp.static(parts.screens):
                if flights.crossing_count[slot] > crossing_room:
                    done = passes
        if wp.static(parts.visits):
            if fate != MOVING:
                leave(flights, slot, flights.here[slot])
        flights.motion[slot] = motion
        flights.fate[slot] = fate

    return advance
