"""Forces on single bodies besides gravity: drag, a flowing fluid, numerical damping, barriers.

Those that depend on the velocity take the one that ``drift`` predicts for the end of the step
(second order), or that of the half step where contacts do so too.
"""

import functools
from typing import NamedTuple

import warp as wp
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, External, Inertia


class Forces(NamedTuple):
    """Which of these forces a scene has; every field that is False is compiled out."""

    drag: bool
    fluid: bool
    trilinear: bool  # between the fluid's nodes; else the nearest node
    numerical_damping: bool
    velocity_barrier: bool
    spin_barrier: bool
    predicted: bool  # velocities of the step's end; else of the half step
    account: bool  # energy bookkeeping

    @property
    def some(self) -> bool:
        """Whether any of them acts."""
        return any(self[name] for name in (0, 1, 3, 4, 5))


# drag stops a body in no less than 1/0.4 steps: drag and fluid together are then stable
STIFFEST = wp.constant(wide(0.4))


@wp.func
def quadratic_drag(coefficient: wide, relative: wide3, most: wide) -> wide3:
    """Resistance -c |v| v to the motion relative to a medium [N]; ``coefficient`` c in kg/m.

    c |v| is cut at ``most`` [kg/s], for steps that do not resolve how fast the motion decays.
    """
    return relative * -wp.min(coefficient * wp.length(relative), most)


@wp.func
def nearest_node(field: wp.array(dtype=wide3, ndim=3), place: wide3) -> wide3:
    """Value at the node nearest to ``place``, in node spacings from the first node."""
    i = int(wp.clamp(wp.floor(place[0] + wide(0.5)), wide(0.0), wide(field.shape[0] - 1)))
    j = int(wp.clamp(wp.floor(place[1] + wide(0.5)), wide(0.0), wide(field.shape[1] - 1)))
    k = int(wp.clamp(wp.floor(place[2] + wide(0.5)), wide(0.0), wide(field.shape[2] - 1)))
    return field[i, j, k]


@wp.func
def between_nodes(field: wp.array(dtype=wide3, ndim=3), place: wide3) -> wide3:
    """Trilinear value at ``place``, in node spacings from the first node; held at the border."""
    x = wp.clamp(place[0], wide(0.0), wide(field.shape[0] - 1))
    y = wp.clamp(place[1], wide(0.0), wide(field.shape[1] - 1))
    z = wp.clamp(place[2], wide(0.0), wide(field.shape[2] - 1))
    i = int(x)
    j = int(y)
    k = int(z)
    i1 = wp.min(i + 1, field.shape[0] - 1)
    j1 = wp.min(j + 1, field.shape[1] - 1)
    k1 = wp.min(k + 1, field.shape[2] - 1)
    a = x - wide(i)
    b = y - wide(j)
    c = z - wide(k)
    low = wp.lerp(
        wp.lerp(field[i, j, k], field[i1, j, k], a),
        wp.lerp(field[i, j1, k], field[i1, j1, k], a),
        b,
    )
    high = wp.lerp(
        wp.lerp(field[i, j, k1], field[i1, j, k1], a),
        wp.lerp(field[i, j1, k1], field[i1, j1, k1], a),
        b,
    )
    return wp.lerp(low, high, c)


@wp.func
def damping_factor(power: wide, coefficient: wide) -> wide:
    """What Cundall's damping multiplies a force by: 1 - c while it does work, else 1 + c."""
    if power > wide(0.0):
        return wide(1.0) - coefficient
    return wide(1.0) + coefficient


@wp.func
def mean_damping_factor(power: wide, own: wide, other: wide, dt: wide, coefficient: wide) -> wide:
    """``damping_factor``'s mean over the step that begins with power P = F.v [W].

    P' = factor own + other, with own = F.F/m and other = F.W/m, W the forces that are not damped
    [W/s]. Where P passes zero the factor changes within the step, to the one that keeps P at zero
    if there is one: a balanced body comes to rest.
    """
    if own == wide(0.0):
        return wide(1.0)
    level = wp.clamp(-other / own, wide(1.0) - coefficient, wide(1.0) + coefficient)
    if power == wide(0.0):
        return level
    factor = damping_factor(power, coefficient)
    gain = (factor * own + other) * dt
    if power * (power + gain) >= wide(0.0):
        return factor
    share = -power / gain
    return factor * share + level * (wide(1.0) - share)


@wp.func
def barrier_factor(speed: wide, limit: wide, exponent: wide) -> wide:
    """(1 - r)/(1 + r), r = |v/limit|^exponent: 1 at rest, 0 at the limit, -1 far beyond it."""
    ratio = wp.abs(speed) / limit
    if ratio <= wide(1.0):
        r = wp.pow(ratio, exponent)
        return (wide(1.0) - r) / (wide(1.0) + r)
    r = wp.pow(wide(1.0) / ratio, exponent)
    return (r - wide(1.0)) / (r + wide(1.0))


@wp.func
def barriers(velocity: wide3, limit: wide, exponent: wide) -> wide3:
    """``barrier_factor`` of each component of a velocity."""
    return wide3(
        barrier_factor(velocity[0], limit, exponent),
        barrier_factor(velocity[1], limit, exponent),
        barrier_factor(velocity[2], limit, exponent),
    )


@wp.func
def turned_by(rotation: wide33, factors: wide3, vector: wide3) -> wide3:
    """A world vector multiplied along the principal axes: R diag(factors) R^T v."""
    return rotation * wp.cw_mul(factors, wp.transpose(rotation) * vector)


@functools.cache
def medium_force(forces: Forces) -> wp.Function:
    """Function of the force of the media a body moves in [N]."""
    value_at = between_nodes if forces.trilinear else nearest_node

    @inlined()
    def medium_force(
        inertia: Inertia, external: External, bodies: Bodies, body: int, dt: wide
    ) -> wide3:
        most = STIFFEST / (inertia.inverse_mass[body] * dt)
        velocity = bodies.velocity[body]
        if wp.static(forces.predicted):
            velocity = bodies.velocity_end[body]
        force = wide3()
        if wp.static(forces.drag):
            force += quadratic_drag(external.drag[body], velocity, most)
        if wp.static(forces.fluid):
            away = bodies.position[body] - external.origin
            flow = value_at(external.flow, wp.cw_div(away, external.spacing))
            force += quadratic_drag(external.fluid[body], velocity - flow, most)
        return force

    return medium_force


@functools.cache
def damped(forces: Forces) -> wp.Function:
    """Function of force and torque under numerical damping [N, N m]."""

    @inlined()
    def damped(
        inertia: Inertia,
        external: External,
        bodies: Bodies,
        weight: wide3,
        body: int,
        force: wide3,
        torque: wide3,
        dt: wide,
    ):
        c = external.damping
        spin = bodies.spin[body]
        power = wp.dot(force, bodies.velocity[body])
        turning = wp.dot(torque, spin)
        if wp.static(forces.predicted):
            inverse = inertia.inverse_mass[body]
            own = wp.dot(force, force) * inverse
            other = wp.dot(force, weight) * inverse
            rotation = wide33(bodies.rotation[body])
            reply = turned_by(rotation, inertia.inverse_moment[body], torque)
            whirl = wp.cross(spin, bodies.angular_momentum[body])
            held = mean_damping_factor(power, own, other, dt, c)
            spun = mean_damping_factor(turning, wp.dot(torque, reply), -wp.dot(reply, whirl), dt, c)
            return force * held, torque * spun
        return force * damping_factor(power, c), torque * damping_factor(turning, c)

    return damped


@functools.cache
def held_back(forces: Forces) -> wp.Function:
    """Function of force and torque whose accelerations barriers hold back [N, N m]."""

    @inlined()
    def held_back(
        inertia: Inertia, external: External, bodies: Bodies, body: int, force: wide3, torque: wide3
    ):
        velocity = bodies.velocity[body]
        spin = bodies.spin[body]
        whirl = wp.cross(spin, bodies.angular_momentum[body])
        if wp.static(forces.predicted):
            velocity = bodies.velocity_end[body]
            spin = bodies.spin_end[body]
        if wp.static(forces.velocity_barrier):
            limit = external.speed_limit
            force = wp.cw_mul(force, barriers(velocity, limit, external.speed_exponent))
        if wp.static(forces.spin_barrier):
            # the angular acceleration, along the world's axes
            rotation = wide33(bodies.rotation[body])
            a = turned_by(rotation, inertia.inverse_moment[body], torque - whirl)
            a = wp.cw_mul(a, barriers(spin, external.spin_limit, external.spin_exponent))
            torque = turned_by(rotation, inertia.moment[body], a) + whirl
        return force, torque

    return held_back


@functools.cache
def external_forces(forces: Forces) -> wp.Function:
    """Function of all forces on a body from those of its contacts, as Rockable composes them.

    Media add to the contacts, numerical damping acts on their sum, then comes the weight, and
    barriers act on the acceleration. Also returned: the power of all but the weight.
    """
    medium = medium_force(forces)
    damp = damped(forces)
    hold = held_back(forces)

    @inlined()
    def external_forces(
        inertia: Inertia,
        external: External,
        bodies: Bodies,
        weight: wide3,
        body: int,
        contact_force: wide3,
        contact_torque: wide3,
        dt: wide,
    ):
        force = contact_force
        torque = contact_torque
        if wp.static(forces.drag or forces.fluid):
            force += medium(inertia, external, bodies, body, dt)
        if wp.static(forces.numerical_damping):
            force, torque = damp(inertia, external, bodies, weight, body, force, torque, dt)
        force += weight
        if wp.static(forces.velocity_barrier or forces.spin_barrier):
            force, torque = hold(inertia, external, bodies, body, force, torque)
        power = wide(0.0)
        if wp.static(forces.account):
            half = wide(0.5) * dt
            velocity = bodies.velocity[body] + force * (half * inertia.inverse_mass[body])
            spun = bodies.angular_momentum[body] + torque * half
            spin = turned_by(wide33(bodies.rotation[body]), inertia.inverse_moment[body], spun)
            power = wp.dot(force - weight - contact_force, velocity)
            power += wp.dot(torque - contact_torque, spin)
        return force, torque, power

    return external_forces
