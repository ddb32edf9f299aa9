"""Friction: an incremental spring in the contact plane under Coulomb's cap.

ft' = kt u while |ft| < mu F, else |ft| = mu F with the direction t turning as
t' = kt (u - (u.t) t) / (mu F). The same laws carry the rolling moment, with kr and the relative
spin. u is the sliding velocity of j over i at the half step [m/s].
"""

import warp as wp
from warpdem.kernels.precision import real, vec3

# a force this close to its cap slid in the last step; rounding must not read as sticking
SLID = wp.constant(real(1.0 - 1.0e-9))


@wp.func
def laid(t: vec3, n: vec3) -> vec3:
    """A tangent vector laid into the plane of ``n`` at its own length."""
    flat = t - n * wp.dot(t, n)
    size = wp.dot(flat, flat)
    if size == real(0.0):
        return vec3()
    return flat * wp.sqrt(wp.dot(t, t) / size)


@wp.func
def spun(t: vec3, n: vec3, angle: real) -> vec3:
    """A vector turned about the unit vector ``n`` [rad], to third order in the angle.

    An exact rotation by 2 atan(angle / 2) (Cayley): no length changes, no sine is needed.
    """
    h = real(0.5) * angle
    part = real(2.0) / (real(1.0) + h * h)
    along = n * wp.dot(t, n)
    flat = t - along
    return t - flat * (part * h * h) + wp.cross(n, t) * (part * h)


@wp.func
def radial_return(trial: vec3, cap: real) -> vec3:
    """``trial`` cut back along itself to at most ``cap``; the order is 1 where slip turns."""
    square = wp.dot(trial, trial)
    if square <= cap * cap:
        return trial
    return trial * (cap / wp.sqrt(square))


@wp.func
def slip_direction(t: vec3, u: vec3, s: real) -> vec3:
    """Unit t after t' = u - (u.t) t over s; exact flow with b = 1/(1 + s + s^2/2) for exp(-s)."""
    b = real(1.0) / (real(1.0) + s + real(0.5) * s * s)
    c = real(1.0) - b
    return wp.normalize(
        t * (real(2.0) * b) + u * (c * (real(1.0) + b + c * wp.dot(t, u))),
    )


@wp.func
def coulomb(
    start: vec3,
    rate: vec3,
    stiffness: real,
    cap: real,
    cap_before: real,
    slid: bool,
) -> vec3:
    """Tangential spring under its cap, second order in time also while slip turns [N].

    ``start`` is the force carried from the last step, ``stiffness`` k dt, ``slid`` whether the
    contact slid then: it sticks, starts to slip (radially), or slides on (along the exact flow).
    """
    trial = start + rate * stiffness
    square = wp.dot(trial, trial)
    if square <= cap * cap:
        return trial
    size = wp.sqrt(square)
    speed = wp.length(rate)
    before = wp.length(start)
    middle = real(0.5) * (cap + cap_before)
    if slid and speed > real(0.0) and before > real(0.0) and middle > real(0.0):
        s = stiffness * speed / middle
        return slip_direction(start / before, rate / speed, s) * cap
    return trial * (cap / size)
