"""Rotations: quaternions (x, y, z, w in memory) and the free drift of a body."""

import warp as wp
from warpdem.kernels.precision import quat, wide, wide3


@wp.func
def turned(q: quat, axis: int, angle: wide) -> quat:
    """``q`` after a turn by ``angle`` [rad] about one of its own axes."""
    s = wp.sin(wide(0.5) * angle)
    turn = quat(wide(0.0), wide(0.0), wide(0.0), wp.cos(wide(0.5) * angle))
    turn[axis] = s
    return q * turn


@wp.func
def about(v: wide3, axis: int, angle: wide) -> wide3:
    """``v`` seen from a frame turned by ``angle`` [rad] about one of its axes."""
    i = (axis + 1) % 3
    j = (axis + 2) % 3
    c = wp.cos(angle)
    s = wp.sin(angle)
    turned = wide3(v)
    turned[i] = c * v[i] + s * v[j]
    turned[j] = c * v[j] - s * v[i]
    return turned


@wp.func
def no_squish(q: quat, momentum: wide3, moment: wide3, dt: wide) -> quat:
    """Free rotation over ``dt`` at constant world angular momentum, second order, symplectic.

    Five turns about the principal axes 3 2 1 2 3; Dullweber, Leimkuhler & McLachlan (1997),
    doi:10.1063/1.474310.
    """
    half = wide(0.5) * dt
    body = wp.quat_rotate_inv(q, momentum)
    a = half * body[2] / moment[2]
    q = turned(q, 2, a)
    body = about(body, 2, a)
    a = half * body[1] / moment[1]
    q = turned(q, 1, a)
    body = about(body, 1, a)
    a = dt * body[0] / moment[0]
    q = turned(q, 0, a)
    body = about(body, 0, a)
    a = half * body[1] / moment[1]
    q = turned(q, 1, a)
    body = about(body, 1, a)
    a = half * body[2] / moment[2]
    q = turned(q, 2, a)
    return wp.normalize(q)


@wp.func
def exponential(q: quat, spin: wide3, dt: wide) -> quat:
    """``q`` after a constant world ``spin`` [rad/s] over ``dt``."""
    speed = wp.length(spin)
    if speed == wide(0.0):
        return q
    return wp.normalize(wp.quat_from_axis_angle(spin / speed, speed * dt) * q)


@wp.func
def free_drift(q: quat, momentum: wide3, torque: wide3, moment: wide3, dt: wide):
    """Half kick and drift at constant momentum: orientation and angular momentum [kg m^2/s].

    One exponential for spherical inertia, NO_SQUISH otherwise.
    """
    kicked = momentum + torque * (wide(0.5) * dt)
    if moment[0] == moment[1] and moment[1] == moment[2]:
        return exponential(q, kicked / moment[0], dt), kicked
    return no_squish(q, kicked, moment, dt), kicked


@wp.func
def spherical_drift(q: quat, momentum: wide3, torque: wide3, moment: wide3, dt: wide):
    """``free_drift`` of a scene in which every body has spherical inertia."""
    kicked = momentum + torque * (wide(0.5) * dt)
    return exponential(q, kicked / moment[0], dt), kicked


@wp.func
def spin_after(angle: wide3, momentum: wide3, moment: wide3) -> wide3:
    """I^-1 L of a body that has turned by the vector ``angle`` from its principal axes [rad/s]."""
    size = wp.length(angle)
    if size == wide(0.0):
        return wp.cw_div(momentum, moment)
    return inverse_inertia(wp.quat_from_axis_angle(angle / size, size), moment, momentum)


@wp.func
def rkmk4(q: quat, momentum: wide3, moment: wide3, dt: wide) -> quat:
    """Free rotation over ``dt`` at constant world angular momentum, fourth order.

    The classical Runge-Kutta method in the rotation vector, seen from the axes of the start, with
    the two commutators that order 4 takes; Munthe-Kaas (1999), doi:10.1016/S0168-9274(98)00030-0.
    """
    seen = wp.quat_rotate_inv(q, momentum)
    half = wide(0.5)
    a = wp.cw_div(seen, moment) * dt
    b = spin_after(a * half, seen, moment) * dt
    c = spin_after(b * half - wp.cross(a, b) * wide(0.125), seen, moment) * dt
    d = spin_after(c, seen, moment) * dt
    angle = (a + wide(2.0) * (b + c) + d - wp.cross(a, d) * half) / wide(6.0)
    size = wp.length(angle)
    if size == wide(0.0):
        return q
    return wp.normalize(q * wp.quat_from_axis_angle(angle / size, size))


@wp.func
def rkmk4_drift(q: quat, momentum: wide3, torque: wide3, moment: wide3, dt: wide):
    """``free_drift`` with RKMK4 where inertia is not spherical."""
    kicked = momentum + torque * (wide(0.5) * dt)
    if moment[0] == moment[1] and moment[1] == moment[2]:
        return exponential(q, kicked / moment[0], dt), kicked
    return rkmk4(q, kicked, moment, dt), kicked


@wp.func
def taylor_drift(q: quat, momentum: wide3, torque: wide3, moment: wide3, dt: wide):
    """Rockable's half kick and drift, first order in time, for comparison only.

    q + dt q' + dt^2/2 q'' from the state before the kick, with the sign of the scalar part of q''
    as that program has it; ``torque`` is I w', see ``taylor_torque``.
    """
    w = inverse_inertia(q, moment, momentum)
    a = inverse_inertia(q, moment, torque)
    v = wide3(q[0], q[1], q[2])
    s = q[3]
    dv = wide(0.5) * (wp.cross(w, v) + w * s)
    ds = wide(-0.5) * wp.dot(w, v)
    v = v + dv * dt
    s = s + ds * dt
    ww = wp.dot(w, w)
    ddv = wide(0.5) * (a * s + wp.cross(a, v)) - wide(0.25) * ww * v
    dds = wide(-0.5) * wp.dot(a, v) + wide(0.25) * ww * s
    h = wide(0.5) * dt * dt
    v = v + ddv * h
    s = s + dds * h
    turned = wp.normalize(quat(v[0], v[1], v[2], s))
    return turned, inertia(turned, moment, w + a * (wide(0.5) * dt))


@wp.func
def euler_drift(q: quat, momentum: wide3, torque: wide3, moment: wide3, dt: wide):
    """exaDEM's drift and half kick, first order in time, for comparison only.

    q + dt/2 w q from the spin before the kick; ``torque`` is I w', see ``taylor_torque``.
    """
    w = inverse_inertia(q, moment, momentum)
    a = inverse_inertia(q, moment, torque)
    v = wide3(q[0], q[1], q[2])
    half = wide(0.5) * dt
    dv = (wp.cross(w, v) + w * q[3]) * half
    ds = -wp.dot(w, v) * half
    turned = wp.normalize(quat(v[0] + dv[0], v[1] + dv[1], v[2] + dv[2], q[3] + ds))
    return turned, inertia(turned, moment, w + a * half)


@wp.func
def free_torque(torque: wide3, spin: wide3, momentum: wide3) -> wide3:
    """Torque of the kick on world angular momentum: the torque itself [N m]."""
    return torque


@wp.func
def taylor_torque(torque: wide3, spin: wide3, momentum: wide3) -> wide3:
    """I w' with the gyroscopic term at the half-step spin, as Rockable has it [N m]."""
    return torque - wp.cross(spin, momentum)


@wp.func
def inertia(q: quat, moment: wide3, spin: wide3) -> wide3:
    """World I w [kg m^2/s]."""
    return wp.quat_rotate(q, wp.cw_mul(wp.quat_rotate_inv(q, spin), moment))


@wp.func
def inverse_inertia(q: quat, moment: wide3, momentum: wide3) -> wide3:
    """World I^-1 L [rad/s]."""
    return wp.quat_rotate(q, wp.cw_div(wp.quat_rotate_inv(q, momentum), moment))


@wp.func
def arc(q: quat, p: quat) -> wide:
    """Chord between two orientations on the unit sphere: 2 sin(angle / 2)."""
    d = q * wp.quat_inverse(p)
    return wide(2.0) * wp.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
