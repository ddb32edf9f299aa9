"""Rocks in the air: the gyroscopic step, the parabola, and how long the air is surely free.

Leine et al. (2014), doi:10.1007/s11044-013-9393-4; the spin's matrix is taken at the middle of the
step, which makes it second order at the same cost.
"""

import functools

import warp as wp
from warpdem.kernels.fall_views import FOREST, TREE, Motion, Obstacles, Rocks, Rules, Terrain
from warpdem.kernels.ground import column_of, row_of
from warpdem.kernels.precision import quat, wide, wide3, wide33
from warpdem.kernels.variant import inlined

# of one stretch of free flight
MOST_STEPS = wp.constant(wide(1.0e6))
# step of a rock however fast, over the largest one: time must go on
SHORTEST = wp.constant(wide(1.0e-3))


@wp.func
def turned_by(q: quat, spin: wide3, at: quat, h: wide) -> quat:
    """``q`` + h dq/dt for a body spin at the orientation ``at``, at length one."""
    rate = at * quat(spin[0], spin[1], spin[2], wide(0.0))
    return wp.normalize(q + rate * (wide(0.5) * h))


@wp.func
def gyroscopic_axis(theta: wide3, spin: wide3) -> wide3:
    """k of T(W) = W~ Theta + Theta W~, the skew matrix of k: T(W) W = W x Theta W."""
    return wide3(
        spin[0] * (theta[1] + theta[2]),
        spin[1] * (theta[0] + theta[2]),
        spin[2] * (theta[0] + theta[1]),
    )


@wp.func
def spin_at_start(theta: wide3, spin: wide3, h: wide) -> wide3:
    """W* of the published scheme: first order."""
    return spin


@wp.func
def spin_at_middle(theta: wide3, spin: wide3, h: wide) -> wide3:
    """W* predicted for the middle of the step: second order."""
    return spin - wide(0.5) * h * wp.cw_div(wp.cross(spin, wp.cw_mul(theta, spin)), theta)


@wp.func
def sharp_inverse(theta: wide3, k: wide3, h: wide) -> wide33:
    """(Theta + h/2 k~)^-1, with which the energy of free spin is kept to round-off."""
    a = (wide(0.5) * h) * k
    d = wp.cw_mul(theta, a)
    determinant = theta[0] * theta[1] * theta[2] + wp.dot(a, d)
    cofactor = wp.diag(wide3(theta[1] * theta[2], theta[0] * theta[2], theta[0] * theta[1]))
    return (cofactor + wp.outer(a, a) - wp.skew(d)) * (wide(1.0) / determinant)


@functools.cache
def fly(middle_spin: wp.Function, *, forest: bool) -> wp.Function:
    """Function of a rock that touches nothing for a time ``h``: an exact parabola.

    Under trees of drag c: v' = g - (c/m) v, exactly.
    """

    @wp.func
    def fly(rules: Rules, motion: Motion, theta: wide3, drag: wide, h: wide) -> Motion:
        k = gyroscopic_axis(theta, middle_spin(theta, motion.spin, h))
        spin = motion.spin - h * (sharp_inverse(theta, k, h) @ wp.cross(k, motion.spin))
        middle = turned_by(motion.orientation, motion.spin, motion.orientation, wide(0.5) * h)
        ended = motion
        ended.orientation = turned_by(
            motion.orientation, wide(0.5) * (motion.spin + spin), middle, h
        )
        ended.spin = spin
        ended.velocity = motion.velocity + h * rules.gravity
        ended.position = motion.position + h * (motion.velocity + wide(0.5) * h * rules.gravity)
        if wp.static(forest):
            if drag > wide(0.0):
                kept = wp.exp(-drag * h)
                mean = (wide(1.0) - kept) / (drag * h)  # of exp(-drag t) over the step
                final = rules.gravity / drag
                ended.velocity = final + kept * (motion.velocity - final)
                ended.position = motion.position + h * (final + mean * (motion.velocity - final))
        ended.time = motion.time + h
        ended.scar = wide(0.0)
        ended.touching = int(0)
        ended.near_ground = int(0)
        return ended

    return fly


@inlined()
def step_length(rules: Rules, motion: Motion, bound: wide) -> wide:
    """Time step of a rock [s]: no point of it moves more than a part of its size, or too far."""
    dt = rules.dt
    fastest = wp.length(motion.velocity) + bound * wp.length(motion.spin) + wide(1.0e-12)
    if rules.stride > wide(0.0):
        dt = wp.clamp(rules.stride * bound / fastest, SHORTEST * rules.dt, rules.dt)
    # an impact may turn spin into speed
    return wp.min(dt, wp.min(wide(0.5) * rules.travel / fastest, rules.falling))


@functools.cache
def canopy_drag(ground: wp.Function) -> wp.Function:
    """Function of the drag of the forest over the mass [1/s]; 0 outside and above it."""

    @inlined()
    def canopy_drag(
        terrain: Terrain, obstacles: Obstacles, position: wide3, inverse_mass: wide
    ) -> wide:
        drag = wide(0.0)
        stand = terrain.stand_of[row_of(terrain, position[1]), column_of(terrain, position[0])]
        if stand >= 0:
            height = position[2] - ground(terrain, position[0], position[1])[0]
            if height < obstacles.stand_height[stand]:
                drag = obstacles.stand_drag[stand] * inverse_mass
        return drag

    return canopy_drag


@functools.cache
def free_steps(ground: wp.Function, *, jumps: bool, obstacles: bool) -> wp.Function:
    """Function of how many steps a rock surely touches nothing; 0: its vertices must be tried.

    Its bounding sphere is above every surface of the neighbourhood's largest slope L through the
    ground below it while z - h > R sqrt(1 + L^2); from the same bound the parabola is free while
    clear + (v_z - L v_h) t - g t^2 / 2 > 0, within the neighbourhood.
    """

    @inlined()
    def free_steps(
        terrain: Terrain, rocks: Rocks, rules: Rules, motion: Motion, rock: int, dt: wide
    ) -> int:
        at = motion.position
        i = column_of(terrain, at[0])
        j = row_of(terrain, at[1])
        slope = terrain.steep[j, i]
        bound = rocks.bound[rock]
        clear = at[2] - ground(terrain, at[0], at[1])[0]
        clear -= bound * wp.sqrt(wide(1.0) + slope * slope)
        steps = int(0)
        if clear > wide(0.0):
            v = motion.velocity
            level = wp.sqrt(v[0] * v[0] + v[1] * v[1]) + wide(1.0e-12)
            g = -rules.gravity[2]
            rise = v[2] - slope * level
            safe = (rise + wp.sqrt(rise * rise + wide(2.0) * g * clear)) / g
            safe = wp.min(safe, (terrain.reach - bound) / level)
            safe = wp.min(safe, wp.max(rules.duration - motion.time, dt))
            if wp.static(jumps):
                safe = wp.min(safe, rules.travel / level)
            steps = wp.max(0, int(wp.min(safe / dt, MOST_STEPS)))
            if wp.static(jumps):
                turn = wp.length(motion.spin) * dt + rules.jump_angle / MOST_STEPS
                steps = wp.min(steps, wp.max(1, int(rules.jump_angle / turn)))
            else:
                steps = wp.min(steps, 1)
            if wp.static(obstacles):
                near = terrain.near[j, i]
                if (near & FOREST) != 0:
                    steps = wp.min(steps, 1)
                if (near & TREE) != 0:
                    steps = int(0)
        return steps

    return free_steps
