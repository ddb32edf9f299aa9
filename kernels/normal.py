"""Normal force: linear spring and dashpot that never pull; small laws of one sub-contact.

Symbols: overlap d = -gap > 0 [m], approach vn [m/s] positive when closing, k = w kn [N/m], tau the
time of the dashpot (its force is k tau vn) [s], beta the share of the contact's own force that is
taken implicitly.
"""

import warp as wp
from warpdem.kernels.precision import real, vec3


@wp.func
def hooke(k: real, d: real, tau: real, vn: real) -> real:
    """k (d + tau vn), never pulling [N]; Cundall & Strack (1979), doi:10.1680/geot.1979.29.1.47."""
    return wp.max(k * (d + tau * vn), real(0.0))


@wp.func
def predicted_force(ahead: real, beta: real, before: real) -> real:
    """Spring and dashpot with vn predicted by the forces of the last pass; may pull [N].

    ``ahead`` = k (d + tau vn_predicted), of which the contact's own part ``before`` is renewed:
    from vn = vn_predicted + (before - f) beta / (k tau), f (1 + beta) = ahead + beta before.
    """
    return (ahead + beta * before) / (real(1.0) + beta)


@wp.func
def onset(d: real, vn: real, dt: real) -> real:
    """Part of the step that a contact has lasted which was not there before; 1 when it lasted."""
    if d < dt * vn:
        return d / (dt * vn)
    return real(1.0)


@wp.func
def pair_frequency(
    force: vec3,
    torque_i: vec3,
    torque_j: vec3,
    spin_i: vec3,
    spin_j: vec3,
    squares: real,
    single: real,
    inverse_mass: real,
) -> real:
    """Square of the frequency of a pair along its own elastic wrench, per stiffness [1/kg].

    ``force`` = sum w d n, torques its moments, spins I^-1 of them, ``squares`` = sum w d^2:
    Rayleigh's quotient of the mode that is being hit. Where normals oppose (a body pinched by one
    other) it is no less than that of its contacts one by one, ``single`` = sum (w d)^2.
    """
    moving = wp.dot(force, force) * inverse_mass
    moving += wp.dot(torque_i, spin_i) + wp.dot(torque_j, spin_j)
    return wp.max(moving, single * inverse_mass) / squares
