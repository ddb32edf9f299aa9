"""Friction: an incremental spring in the contact plane under Coulomb's cap.

ft' = kt u while |ft| < mu F, else |ft| = mu F with the direction t turning as
t' = kt (u - (u.t) t) / (mu F). The same laws carry the rolling moment, with kr and the relative
spin. u is the sliding velocity of j over i at the half step [m/s].
"""

import warp as wp
from warpdem.kernels.precision import wide, wide3

# a force this close to its cap slid in the last step; rounding must not read as sticking
SLID = wp.constant(wide(1.0 - 1.0e-9))


@wp.func
def laid(t: wide3, n: wide3) -> wide3:
    """A tangent vector laid into the plane of ``n`` at its own length."""
    flat = t - n * wp.dot(t, n)
    size = wp.dot(flat, flat)
    if size == wide(0.0):
        return wide3()
    return flat * wp.sqrt(wp.dot(t, t) / size)


@wp.func
def spun(t: wide3, n: wide3, angle: wide) -> wide3:
    """A vector turned about the unit vector ``n`` [rad], to third order in the angle.

    An exact rotation by 2 atan(angle / 2) (Cayley): no length changes, no sine is needed.
    """
    h = wide(0.5) * angle
    part = wide(2.0) / (wide(1.0) + h * h)
    along = n * wp.dot(t, n)
    flat = t - along
    return t - flat * (part * h * h) + wp.cross(n, t) * (part * h)


@wp.func
def radial_return(trial: wide3, cap: wide) -> wide3:
    """``trial`` cut back along itself to at most ``cap``; the order is 1 where slip turns."""
    square = wp.dot(trial, trial)
    if square <= cap * cap:
        return trial
    return trial * (cap / wp.sqrt(square))


@wp.func
def slip_direction(t: wide3, u: wide3, s: wide) -> wide3:
    """Unit t after t' = u - (u.t) t over s; exact flow with b = 1/(1 + s + s^2/2) for exp(-s)."""
    b = wide(1.0) / (wide(1.0) + s + wide(0.5) * s * s)
    c = wide(1.0) - b
    return wp.normalize(
        t * (wide(2.0) * b) + u * (c * (wide(1.0) + b + c * wp.dot(t, u))),
    )


@wp.func
def coulomb(
    start: wide3,
    rate: wide3,
    stiffness: wide,
    cap: wide,
    cap_before: wide,
    slid: bool,
) -> wide3:
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
    middle = wide(0.5) * (cap + cap_before)
    if slid and speed > wide(0.0) and before > wide(0.0) and middle > wide(0.0):
        s = stiffness * speed / middle
        return slip_direction(start / before, rate / speed, s) * cap
    return trial * (cap / size)
