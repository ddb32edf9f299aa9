"""Puts rocks into their slots, and packs what they passed."""

import functools

import warp as wp
from warpdem.kernels.fall_views import (
    LARGEST,
    LARGEST_COUNT,
    MOVING,
    Flights,
    Motion,
    ResultGrid,
    Rocks,
    Rules,
    Terrain,
    Visit,
    Window,
)
from warpdem.kernels.passages import larger, result_cell, values_on, way_of
from warpdem.kernels.precision import quat, wide, wide3
from warpdem.kernels.variant import variant


@functools.cache
def begin(ground: wp.Function) -> wp.Kernel:
    """Kernel that puts a rock into each slot of a list, at the start of its trajectory."""
    values = values_on(ground)

    @variant
    def begin(
        # model
        terrain: Terrain,
        rocks: Rocks,
        rules: Rules,
        grid: ResultGrid,
        # in
        slots: wp.array(dtype=wp.int32),
        rock: wp.array(dtype=wp.int32),
        position: wp.array(dtype=wide3),
        orientation: wp.array(dtype=quat),
        velocity: wp.array(dtype=wide3),
        spin: wp.array(dtype=wide3),
        # out
        flights: Flights,
    ):
        k = wp.tid()
        slot = slots[k]
        motion = Motion()
        motion.position = position[k]
        motion.orientation = orientation[k]
        motion.velocity = velocity[k]
        motion.spin = wp.quat_rotate_inv(orientation[k], spin[k])
        window = Window()
        window.position = motion.position
        window.orientation = motion.orientation
        flights.rock[slot] = rock[k]
        flights.fate[slot] = MOVING
        flights.motion[slot] = motion
        flights.window[slot] = window
        for i in range(flights.percussion.shape[1]):
            flights.percussion[slot, i] = wide3()
        for i in range(flights.count.shape[1]):
            flights.count[slot, i] = 0
        for i in range(flights.measure.shape[1]):
            flights.measure[slot, i] = wide(0.0)
        way = way_of(rocks, rules, rock[k], motion, motion)
        first = values(terrain, way, wide(0.0))
        for i in range(LARGEST_COUNT):
            flights.measure[slot, LARGEST + i] = first[i]
        visit = Visit()
        visit.cell = result_cell(grid, motion.position)
        flights.here[slot] = larger(visit, first)

    return begin


@functools.cache
def pack(record: type) -> wp.Kernel:
    """Kernel that lays what a launch recorded end to end, and empties its buffers."""

    @variant
    def pack(
        # in
        active: wp.array(dtype=wp.int32),
        start: wp.array(dtype=wp.int32),
        buffer: wp.array(dtype=record, ndim=2),
        # in and out
        count: wp.array(dtype=wp.int32),
        # out
        owner: wp.array(dtype=wp.int32),
        packed: wp.array(dtype=record),
    ):
        k = wp.tid()
        slot = active[k]
        for i in range(count[slot]):
            owner[start[k] + i] = slot
            packed[start[k] + i] = buffer[slot, i]
        count[slot] = 0

    return pack
