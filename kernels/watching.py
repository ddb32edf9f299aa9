"""When the lists must be renewed: bodies that left their skins; and those that flew off."""

import functools

import warp as wp
from warpdem.kernels.precision import wide, wide3
from warpdem.kernels.rotation import arc
from warpdem.kernels.surfaces import tilt
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Cell, Clock, Geometry


@inlined()
def turn(geometry: Geometry, bodies: Bodies, body: int) -> wide:
    """How far a body has turned since the lists were made [rad]."""
    return arc(bodies.orientation[body], bodies.listed_orientation[body])


@inlined()
def turned_not(geometry: Geometry, bodies: Bodies, body: int) -> wide:
    """``turn`` of bodies whose turning moves nothing."""
    return wide(0.0)


@wp.func
def flies(speed: wide, spinning: wide, bound: wide, dt: wide) -> bool:
    """Whether a body moves more than its own size in one step, or has no velocity (NaN)."""
    return not ((speed + wide(0.3) * spinning * bound) * dt <= bound)


@functools.cache
def watching(*, paths: bool, surfaces: bool, turns: bool, deforming: bool) -> wp.Function:
    """Function that notes a body that left its skin, or flew off.

    ``paths``: the way of its farthest point is summed up, and spares the look at where it was
    listed; ``surfaces``: some surface moves; ``turns``: turning moves something.
    """
    turn_of = tilt if surfaces else turn
    if not turns:
        turn_of = turned_not

    @inlined()
    def watch(
        geometry: Geometry,
        bodies: Bodies,
        cell: Cell,
        clock: Clock,
        body: int,
        velocity: wide3,
        before: wide3,
        spin: wide3,
        lever: wide,
        dt: wide,
        watched: wide,
    ):
        """``before`` and ``spin`` are those of the last half step and of this one [rad/s].

        ``watched`` is the step for which flying off counts; 0 looks for NaN alone.
        """
        bound = geometry.bound[body]
        reach = bodies.reach[body]
        own = velocity
        if wp.static(deforming):
            # in a cell that deforms: motion against the cell's
            inside = bodies.position[body] - cell.centre[0]
            gradient = cell.rate[0] * wp.inverse(cell.edges[0])
            own = velocity - gradient * inside
        speed = wp.length(own)
        spinning = wp.length(spin)
        if flies(speed, spinning, bound, watched):
            clock.fault[0] = 1
        if wp.static(paths):
            pace = speed + (bound + lever) * wp.max(spinning, wp.length(before))
            if wp.static(deforming):
                pace += wp.sqrt(wp.ddot(gradient, gradient)) * (bound + reach)
            path = bodies.path[body] + pace * dt
            bodies.path[body] = path
            if path <= reach:
                return
        away = bodies.position[body] - bodies.listed_position[body]
        stretched = wide(0.0)
        if wp.static(deforming):
            # F = H H_listed^-1 and u = x - F x_listed: d = u_i - u_j + F d_listed of all images
            listed = bodies.listed_position[body] - cell.centre[0]
            away = inside - cell.since[0] * listed
            stretched = cell.stretch[0] * (bound + reach)
        turned = turn_of(geometry, bodies, body)
        if not (wp.length(away) + (bound + lever) * turned + stretched <= reach):
            clock.moved[0] = 1

    return watch
