"""Impacts: restitution, duration, overlap, friction, against the formulas of a linear contact."""

from math import acos, acosh, atan, cos, exp, pi, sin, sqrt

import numpy as np
import pytest
from blocks import corner_impact, rotated, turned_about
from gates import gate, not_in_mixed
from impacts import (
    PHASES,
    Collision,
    Grazing,
    bounces,
    largest_force,
    order_of,
    parting,
    release,
    restitution,
    rms,
    turning,
)

from scenes import clamped_restitution, law

KN = 1e5


def contact_time(zeta, omega):
    """Time until the force of a clamped contact ends: 2 acos(z)/(w0 sqrt(1 - z^2))."""
    if zeta == 1.0:
        return 2.0 / omega
    ratio = acos(zeta) / sqrt(1 - zeta**2) if zeta < 1 else acosh(zeta) / sqrt(zeta**2 - 1)
    return 2.0 * ratio / omega


def against_the_floor(zeta, *, mass=1.0, speed=1.0):
    return {
        "mass": mass,
        "rules": law(KN, zeta=zeta),
        "speed": speed,
        "duration": contact_time(zeta, sqrt(KN / mass)),
    }


# head-on


@pytest.mark.parametrize("asked", [0.95, 0.8, 0.5, 0.2, 0.1])
def test_ball_rebounds_with_the_restitution_asked_for(asked):
    got = restitution(mass=1.0, rules=law(KN, e=asked), speed=1.0, steps=50, duration=pi / sqrt(KN))
    assert rms(got - asked) < 1e-3


@pytest.mark.parametrize("zeta", [0.1, 0.3, 0.8, 1.5])
def test_error_of_the_restitution_falls_with_the_square_of_the_step(zeta):
    hit, e = against_the_floor(zeta), clamped_restitution(zeta)
    assert order_of(lambda n: rms(restitution(steps=n, **hit) - e), (25, 50, 100)) > 1.8
    assert rms(restitution(steps=50, **hit) - e) < 1e-3


def test_elastic_ball_keeps_its_speed():
    assert rms(restitution(steps=50, **against_the_floor(0.0)) - 1.0) < 1e-4


def test_restitution_does_not_depend_on_mass_and_speed():
    got = restitution(steps=50, **against_the_floor(0.3, mass=250.0, speed=7.0))
    assert rms(got - restitution(steps=50, **against_the_floor(0.3))) < gate(1e-12, mixed=1e-5)


def test_ball_is_not_thrown_back_less_than_a_bilateral_dashpot_pulls():
    # the ratio for a contact that may pull, in one that does not: the known excess
    for asked in (0.2, 0.5):
        zeta = -np.log(asked) / np.hypot(np.log(asked), pi)
        got = restitution(
            mass=1.0,
            rules=law(KN, e=asked),
            speed=1.0,
            steps=50,
            duration=contact_time(zeta, sqrt(KN)),
            restitution="bilateral",
        )
        assert rms(got - clamped_restitution(zeta)) < 1e-3


def test_overlap_force_and_times_of_a_damped_impact():
    zeta, omega, speed = 0.3, sqrt(KN), 2.0
    damped, lag = omega * sqrt(1.0 - zeta**2), acos(zeta) / sqrt(1.0 - zeta**2)
    hit = Collision(steps=50, **against_the_floor(zeta, speed=speed))
    top, end = hit.each(turning), hit.each(release)
    deepest = speed / omega * exp(-zeta * lag)
    strongest = max(_force(t / omega, zeta, omega, speed) for t in np.linspace(0.0, lag, 4001))
    assert rms(top[:, 0] * omega - lag) < 1e-3
    assert rms(top[:, 1] / deepest - 1.0) < 1e-3
    assert rms(hit.each(largest_force) / strongest - 1.0) < 1e-3
    assert rms(end[:, 0] * omega - 2.0 * lag) < 1e-3
    left = speed / damped * exp(-2.0 * zeta * lag) * sin(2.0 * lag * sqrt(1.0 - zeta**2))
    assert rms(end[:, 1] / left - 1.0) < 1e-3
    # free flight out of the overlap left, at e times the speed
    apart = 2.0 * lag / omega + left / (clamped_restitution(zeta) * speed)
    assert rms(hit.each(parting) / apart - 1.0) < 1e-3


def _force(t, zeta, omega, speed):
    """kn d + c d' of a unit mass with d(0) = 0, d'(0) = speed."""
    damped = omega * sqrt(1.0 - zeta**2)
    decay, a, b = speed * exp(-zeta * omega * t), cos(damped * t), sin(damped * t)
    overlap, rate = decay * b / damped, decay * (a - zeta * omega / damped * b)
    return omega**2 * overlap + 2.0 * zeta * omega * rate


def test_force_of_a_strong_dashpot_is_largest_at_the_touch():
    zeta, speed = 1.0, 1.0
    hit = Collision(steps=50, **against_the_floor(zeta, speed=speed))
    assert rms(hit.each(largest_force) / (2.0 * zeta * sqrt(KN) * speed) - 1.0) < 1e-3


@pytest.mark.parametrize(("mass", "other", "zeta"), [(0.5, 0.5, 0.2), (2.0, 1.0, 0.8)])
def test_two_balls_part_with_the_restitution_and_the_momentum(mass, other, zeta):
    speed, m_eff = 3.0, mass * other / (mass + other)
    duration = contact_time(zeta, sqrt(KN / m_eff))
    rules = law(KN, zeta=zeta)
    hit = Collision(mass=mass, other=other, rules=rules, speed=speed, steps=50, duration=duration)
    common, e = mass * speed / (mass + other), clamped_restitution(zeta)
    assert rms(hit.first - (common - e * (speed - common))) < 1e-3 * speed
    assert rms(hit.second - common * (1.0 + e)) < 1e-3 * speed
    assert np.abs(mass * hit.first + other * hit.second - mass * speed).max() < 1e-13


def test_dashpot_takes_the_kinetic_energy_that_is_lost():
    zeta = 0.2
    hit = Collision(steps=200, **against_the_floor(zeta))
    lost = 0.5 * (1.0 - clamped_restitution(zeta) ** 2)
    assert hit.spent / PHASES == pytest.approx(lost, rel=1e-3)


# oblique and spinning


def grazing(*, zeta=0.0, mu=0.3, ratio=0.8, beta=0.4, steps=100, **motion):
    """A ball of mass 1; ``ratio`` is kt over kn."""
    rules = law(KN, kt=ratio * KN, mu=mu, zeta=zeta)
    duration = contact_time(zeta, sqrt(KN))
    return Grazing(mass=1.0, rules=rules, beta=beta, steps=steps, duration=duration, **motion)


@pytest.mark.parametrize("zeta", [0.0, 0.2])
def test_ball_that_slips_throughout_loses_mu_times_the_normal_impulse(zeta):
    # so fast that the moment counts for nothing in which the spring stretches to the dashpot's jump
    fall, slide, mu, beta = 1.0, 100.0, 0.2, 0.4
    hit = grazing(zeta=zeta, mu=mu, beta=beta, fall=fall, slide=slide)
    impulse = mu * (1.0 + clamped_restitution(zeta)) * fall
    assert rms(hit.along - (slide - impulse)) < 1e-3
    assert rms(hit.turning - impulse / beta) < 1e-3


def test_contact_point_that_sticks_swings_back():
    # kt (1 + 1/beta) = kn: half a tangential period in the time of contact
    fall, slide, beta = 1.0, 0.3, 0.4
    hit = grazing(mu=1.0, ratio=beta / (1.0 + beta), beta=beta, fall=fall, slide=slide)
    assert rms(hit.slip + slide) < gate(1e-5, mixed=2e-4)
    impulse = 2.0 * slide / (1.0 + 1.0 / beta)
    assert rms(hit.along - (slide - impulse)) < gate(1e-5, mixed=2e-4)


@pytest.mark.parametrize("spin", [-1.0, -4.0])
def test_spinning_ball_gains_mu_times_the_normal_impulse(spin):
    fall, mu, beta = 0.2, 0.4, 0.4
    hit = grazing(mu=mu, beta=beta, fall=fall, spin=spin)
    assert rms(hit.along - 2.0 * mu * fall) < gate(1e-5, mixed=5e-5)
    assert rms(hit.turning - (-spin - 2.0 * mu * fall / beta)) < gate(1e-5, mixed=2e-4)


@not_in_mixed("the touch is known to the rounding of gaps only, and the slide is fast")
def test_friction_of_a_fast_slide_takes_its_impulse_from_the_dashpots_first_instant_too():
    # the dashpot's force jumps at the touch, somewhere within a step
    zeta, mu, beta = 0.8, 0.2, 0.4
    impulse = mu * (1.0 + clamped_restitution(zeta))

    def error(steps):
        hit = grazing(zeta=zeta, mu=mu, beta=beta, fall=1.0, slide=1e4, steps=steps)
        return rms(hit.turning * beta / impulse - 1.0)

    assert error(100) < 1e-3
    assert order_of(error, (25, 50, 100)) > 1.8


# stick, slip, stick, slip: solved piece by piece to 1e-15 (Chung and Ooi (2011), linear contact)
PIECES = [
    # speed 3.9 at an angle from the normal, zeta, mu, kt/kn; slip of the contact point after
    (35.0, 0.0, 0.3, 0.8, -0.9016426054554021),
    (50.0, 0.0, 0.3, 0.8, -1.3500044152633501),
    (40.0, 0.2154, 0.3, 0.8, -1.2076043751568566),
    (30.0, 0.1, 0.5, 0.5, -1.626753067499571),
    (15.0, 0.2154, 0.1, 0.8, -0.5026792581472693),
]


def slip_errors(steps):
    """Errors of the slip after each impact of ``PIECES``, over the speed of impact."""
    speed = 3.9
    errors = []
    for degrees, zeta, mu, ratio, after in PIECES:
        angle = np.radians(degrees)
        motion = {"fall": speed * cos(angle), "slide": speed * sin(angle)}
        hit = grazing(zeta=zeta, mu=mu, ratio=ratio, steps=steps, **motion)
        errors.append(rms(hit.slip - after) / speed)
    return np.array(errors)


def test_oblique_impacts_that_stick_and_slip_in_turn():
    assert slip_errors(100).max() < 1e-3


@not_in_mixed("fine steps meet the rounding of gaps before the square of the step")
def test_error_of_oblique_impacts_falls_with_the_square_of_the_step():
    assert order_of(lambda n: rms(slip_errors(n)), (25, 50, 100, 200)) > 1.8


# bounces and a corner


def test_elastic_ball_bounces_in_the_period_of_flight_and_contact():
    height, g, mass = 0.5, 9.81, 1.0
    omega, speed = sqrt(KN / mass), sqrt(2.0 * g * height)
    touching = 2.0 / omega * (pi - atan(speed * omega / g))
    times, speeds, peaks = bounces(
        mass=mass, kn=KN, zeta=0.0, height=height, g=g, steps=100, count=3
    )
    period = 2.0 * speed / g + touching
    expected = speed / g + period * np.arange(3)
    assert times == pytest.approx(expected, rel=1e-3)
    assert speeds == pytest.approx([speed] * 3, rel=1e-3)
    assert peaks == pytest.approx([height] * 2, rel=1e-3)


def corner_error(kn, *, e):
    """Distance of a sharp box's velocity after a frictionless blow on one corner from the rigid."""
    size, density, angles = np.array([0.2, 0.3, 0.5]), 1000.0, (0.3, 0.4, 0.1)
    velocity, spin = np.array([1.0, 0.0, -2.0]), np.array([0.0, 3.0, 1.0])
    q, mass = turned_about(angles), density * size.prod()
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    arms = rotated(q, corners * 0.5 * size)
    arm = arms[np.argmin(arms[:, 2])]
    moment = mass / 12.0 * (size @ size - size**2)
    axes = rotated(q, np.eye(3)).T
    turn = np.cross(arm, [0.0, 0.0, 1.0])
    unlocked = axes @ (axes.T @ turn / moment)
    m_eff = 1.0 / (1.0 / mass + turn @ unlocked)
    closing = (velocity + np.cross(spin, arm))[2]
    impulse = -(1.0 + e) * m_eff * closing
    got, spun = corner_impact(
        size=size,
        density=density,
        angles=angles,
        velocity=velocity,
        spin=spin,
        rules=law(kn, e=e),
        m_eff=m_eff,
        steps=100,
    )
    error = got - velocity - [0.0, 0.0, impulse / mass]
    return np.linalg.norm(error), np.linalg.norm(spun - spin - impulse * unlocked)


@pytest.mark.parametrize("e", [1.0, 0.5])
def test_corner_blow_nears_the_rigid_one_with_the_root_of_the_stiffness(e):
    soft, stiff = corner_error(1e8, e=e), corner_error(1e10, e=e)
    assert stiff[0] < 2e-3 * 2.0
    assert stiff[1] < 2e-3 * 8.0
    assert soft[0] / stiff[0] == pytest.approx(10.0, rel=gate(0.2, mixed=0.3))
