"""One step of a rock in contact: Moreau's midpoint scheme.

The contacts are those closed in the middle of the step; their percussions act once, on the free
velocities of its end. Leine et al. (2014), doi:10.1007/s11044-013-9393-4.
"""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.fall_views import (
    CONTACT_STEPS,
    DEPTH,
    FLIGHT_STEPS,
    FROZEN,
    GAIN,
    LIFTED,
    LIMITED,
    MOST_SWEEPS,
    RESIDUAL,
    SWEEPS,
    UNCONVERGED,
    Flights,
    GroundClasses,
    Motion,
    Obstacles,
    Rocks,
    Rules,
    Terrain,
)
from warpdem.kernels.free_flight import (
    canopy_drag,
    fly,
    gyroscopic_axis,
    sharp_inverse,
    spin_at_middle,
    spin_at_start,
    turned_by,
)
from warpdem.kernels.ground import column_of, facet_ground, raster_ground, row_of
from warpdem.kernels.ground_contacts import sink, touch_ground, touch_trees
from warpdem.kernels.precision import quat, wide, wide3, wide33
from warpdem.kernels.scarring import frontal_area, scar_depth, soil_drag
from warpdem.kernels.signorini import (
    Body,
    Twist,
    passive_share,
    prepared,
    solve,
    struck,
    velocity_at,
)
from warpdem.kernels.variant import inlined

# 2 / pi
FRICTION_SCALE = wp.constant(wide(0.6366197723675814))


class Parts(NamedTuple):
    """What the trajectories of a scene need; every field that is False is compiled out."""

    facets: bool  # the ground is made of triangles; else a raster
    rounded: bool  # some rock has rounded corners
    leine: bool  # the published gyroscopic term, of first order
    scarring: bool
    forest: bool
    trees: bool
    screens: bool  # barriers and lines
    visits: bool  # passages through cells are recorded
    lift: bool
    jumps: bool  # free flight in long stretches
    sphere: bool  # no vertices while the bounding sphere is clear
    fused: bool  # multiplications and additions fused on the CPU too

    @property
    def ground(self) -> wp.Function:
        """Height and slopes under a point."""
        return facet_ground if self.facets else raster_ground

    @property
    def middle_spin(self) -> wp.Function:
        """The spin that the gyroscopic matrix is taken at."""
        return spin_at_start if self.leine else spin_at_middle


@wp.struct
class Middle:
    """A rock in the middle of a step."""

    centre: wide3
    orientation: quat
    turn: wide33
    start: Twist  # velocity and world spin at the step's start
    free: Twist  # at its end without percussions
    body: Body


@inlined()
def slip_friction(classes: GroundClasses, ground_class: int, slip: wide) -> wide:
    """mu_min + (2/pi) (mu_max - mu_min) atan(kappa s)."""
    low = classes.mu_min[ground_class]
    rise = classes.mu_max[ground_class] - low
    return low + rise * FRICTION_SCALE * wp.atan(classes.kappa[ground_class] * slip)


@functools.cache
def middle_of(parts: Parts) -> wp.Function:
    """Function of the midpoint pose and the free motion over a step."""
    middle_spin = parts.middle_spin

    @inlined()
    def middle_of(
        rules: Rules, motion: Motion, theta: wide3, inverse_mass: wide, dt: wide
    ) -> Middle:
        half = wide(0.5) * dt
        middle = Middle()
        middle.centre = motion.position + half * motion.velocity
        middle.orientation = turned_by(motion.orientation, motion.spin, motion.orientation, half)
        middle.turn = wp.quat_to_matrix(middle.orientation)
        k = gyroscopic_axis(theta, middle_spin(theta, motion.spin, dt))
        inverse = sharp_inverse(theta, k, dt)
        middle.body.inverse_mass = inverse_mass
        back = wp.transpose(middle.turn)
        middle.body.inverse_inertia = middle.turn @ inverse @ back
        weights = theta / (theta[0] * theta[1] * theta[2])
        middle.body.cofactor = middle.turn @ wp.diag(weights) @ back
        middle.start.velocity = motion.velocity
        middle.start.spin = middle.turn @ motion.spin
        middle.free.velocity = motion.velocity + dt * rules.gravity
        spin = motion.spin - dt * (inverse @ wp.cross(k, motion.spin))
        middle.free.spin = middle.turn @ spin
        return middle

    return middle_of


@inlined()
def press(
    rules: Rules, classes: GroundClasses, ground_class: int, middle: Middle, count: int,
    dt: wide, flights: Flights, slot: int,
) -> Twist:  # fmt: skip
    """Velocity and spin at the step's end, by the percussions of the listed contacts."""
    twist = middle.free
    scale = dt * wp.length(rules.gravity)
    for c in range(count):
        contact = prepared(flights.contact[slot, c], middle.body)
        before = velocity_at(middle.start, contact.arm)
        scale = wp.max(scale, wp.length(before))
        if contact.vertex >= 0:  # trunks give nothing back
            approach = wp.min(wide(0.0), wp.dot(before, contact.normal))
            contact.bias = classes.restitution[ground_class] * approach
        flights.contact[slot, c] = contact
        twist = struck(twist, middle.body, contact.arm, contact.percussion)
    solved = solve(
        flights.contact, flights.iterates, slot, count, middle.body, twist,
        rules.tolerance * scale, rules.sweeps, rules.accelerate_from,
    )  # fmt: skip
    twist = solved.twist
    if solved.converged == 0:
        flights.count[slot, UNCONVERGED] += 1
        residual = wp.max(flights.measure[slot, RESIDUAL], solved.residual / scale)
        flights.measure[slot, RESIDUAL] = residual
        share = passive_share(flights.contact, slot, count, middle.start, middle.free, twist)
        if share < wide(1.0):
            flights.count[slot, LIMITED] += 1
            twist.velocity = middle.free.velocity + share * (twist.velocity - middle.free.velocity)
            twist.spin = middle.free.spin + share * (twist.spin - middle.free.spin)
            for c in range(count):
                flights.contact[slot, c].percussion = share * flights.contact[slot, c].percussion
    elif solved.frozen == 1:
        flights.count[slot, FROZEN] += 1
    flights.count[slot, SWEEPS] += solved.sweeps
    flights.count[slot, MOST_SWEEPS] = wp.max(flights.count[slot, MOST_SWEEPS], solved.sweeps)
    return twist


@inlined()
def keep_percussions(flights: Flights, slot: int, count: int) -> int:
    """Keep the percussions by vertex for the next step; whether any of them presses."""
    touching = int(0)
    for c in range(count):
        p = flights.contact[slot, c].percussion
        vertex = flights.contact[slot, c].vertex
        if vertex >= 0:
            flights.percussion[slot, vertex] = p
            if wp.dot(p, flights.contact[slot, c].normal) > wide(0.0):
                touching = 1
    return touching


@wp.func
def energy_over_mass(rules: Rules, motion: Motion, theta_over_mass: wide3) -> wide:
    """Kinetic and potential energy over the mass [J/kg]."""
    spinning = wp.dot(motion.spin, wp.cw_mul(theta_over_mass, motion.spin))
    moving = wp.length_sq(motion.velocity)
    return wide(0.5) * (moving + spinning) - wp.dot(rules.gravity, motion.position)


@wp.func
def lifted(rules: Rules, motion: Motion, depth: wide) -> Motion:
    """The rock raised by a part of its depth beyond the slop, paid from its speed."""
    raised = motion
    g = wp.length(rules.gravity)
    speed2 = wp.length_sq(motion.velocity)
    up = wide(0.0)
    if g > wide(0.0):
        up = wp.min(rules.lift * (depth - rules.slop), wide(0.5) * speed2 / g)
    if up > wide(0.0):
        raised.position = motion.position - (up / g) * rules.gravity
        raised.velocity = motion.velocity * wp.sqrt(
            wp.max(wide(0.0), wide(1.0) - wide(2.0) * g * up / speed2)
        )
    return raised


@wp.func
def ended(
    motion: Motion, middle: Middle, twist: Twist, touching: int, drag: wide, beta: wide, dt: wide
) -> Motion:
    """The rock at the step's end; ``drag`` [1/s] slows one that touches the ground."""
    after = motion
    velocity = twist.velocity
    if touching == 1:
        velocity = velocity / (wide(1.0) + drag * dt)
        after.slip = motion.slip + dt * wp.length(velocity)
    else:
        after.slip = motion.slip * wp.exp(-beta * dt)
    spin = wp.transpose(middle.turn) @ twist.spin
    after.position = motion.position + (wide(0.5) * dt) * (motion.velocity + velocity)
    mean = wide(0.5) * (motion.spin + spin)
    after.orientation = turned_by(motion.orientation, mean, middle.orientation, dt)
    after.velocity = velocity
    after.spin = spin
    after.time = motion.time + dt
    after.touching = touching
    after.step = dt
    return after


@functools.cache
def contact_step(parts: Parts) -> wp.Function:
    """Function of one step of a rock that may touch something."""
    ground = parts.ground
    touch = touch_ground(ground, rounded=parts.rounded)
    middle_at = middle_of(parts)
    free = fly(parts.middle_spin, forest=parts.forest)
    canopy = canopy_drag(ground)

    @inlined()
    def contact_step(
        terrain: Terrain, rocks: Rocks, classes: GroundClasses, obstacles: Obstacles,
        rules: Rules, flights: Flights, slot: int, rock: int, motion: Motion, dt: wide,
    ) -> Motion:  # fmt: skip
        theta = rocks.inertia[rock]
        mass = rocks.mass[rock]
        middle = middle_at(rules, motion, theta, wide(1.0) / mass, dt)
        centre = middle.centre
        kind = terrain.class_of[row_of(terrain, centre[1]), column_of(terrain, centre[0])]
        friction = slip_friction(classes, kind, motion.slip)
        warm = wide(0.0)
        if motion.near_ground == 1:
            warm = dt / motion.step  # percussions go with the length of the step
        touched = touch(terrain, rocks, rock, centre, middle.turn, friction, warm, flights, slot)
        scar = wide(0.0)
        immersed = int(0)  # some vertex is below the surface, if not on the hard ground
        if touched.count > 0:
            immersed = 1
        slowing = wide(0.0)
        if wp.static(parts.scarring):
            if immersed == 1:
                scar = motion.scar
                if motion.near_ground == 0:
                    modulus = classes.scar_modulus[kind]
                    scar = scar_depth(mass, modulus, motion.velocity[2])
            if scar > wide(0.0):
                speed = wp.length(motion.velocity)
                plane = ground(terrain, centre[0], centre[1])
                along = motion.velocity / (speed + wide(1.0e-12))
                area = frontal_area(rocks, rock, middle.turn, centre, plane, along)
                slowing = soil_drag(classes.scar_drag[kind], area, speed, mass)
                touched = sink(flights, slot, touched, scar)
        depth = touched.depth
        if wp.static(parts.trees):
            touched = touch_trees(
                terrain, obstacles, rocks, rock, centre, middle.turn, flights, slot, touched
            )
        if wp.static(parts.forest):
            slowing += canopy(terrain, obstacles, motion.position, wide(1.0) / mass)
        after = Motion()
        if touched.count == 0 and immersed == 0:
            after = free(rules, motion, theta, slowing, dt)
            after.slip = motion.slip * wp.exp(-classes.beta[kind] * dt)
            flights.count[slot, FLIGHT_STEPS] += 1
        else:
            flights.count[slot, CONTACT_STEPS] += 1
            middle.free.velocity = middle.free.velocity / (wide(1.0) + slowing * dt)
            twist = middle.free
            touching = int(0)
            if touched.count > 0:
                twist = press(rules, classes, kind, middle, touched.count, dt, flights, slot)
                touching = keep_percussions(flights, slot, touched.count)
                flights.measure[slot, DEPTH] = wp.max(flights.measure[slot, DEPTH], depth)
            drag = classes.drag[kind]
            after = ended(motion, middle, twist, touching, drag, classes.beta[kind], dt)
            after.scar = scar
            after.near_ground = immersed
            before = energy_over_mass(rules, motion, theta / mass)
            gain = energy_over_mass(rules, after, theta / mass) - before
            flights.measure[slot, GAIN] = wp.max(flights.measure[slot, GAIN], gain)
            if wp.static(parts.lift):
                raised = lifted(rules, after, depth)
                up = wp.length(raised.position - after.position)
                flights.measure[slot, LIFTED] = flights.measure[slot, LIFTED] + up
                after = raised
        return after

    return contact_step
