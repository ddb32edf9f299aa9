"""A ball on the floor or a slope: friction and rolling resistance against rigid-body formulas.

The formulas know no springs; errors of a few parts in a thousand are those of finite stiffness, and
fall with it.
"""

from math import asin, cos, radians, sin

import pytest
from impacts import order_of
from rolling import RADIUS, decay, descent, lag_of_friction, slip_to_roll, spinning_slide

G = 9.81
KN = 4e5


def sliding(kn):
    return slip_to_roll(v0=2.0, mu=0.3, beta=0.4, radius=RADIUS, g=G, kn=kn)


def test_sliding_ball_ends_rolling_at_its_speed_over_one_plus_beta():
    v0, mu, beta = 2.0, 0.3, 0.4
    got = sliding(KN)
    time = v0 / (mu * G * (1.0 + 1.0 / beta))
    assert got["t_roll"] == pytest.approx(time, rel=2e-3)
    assert got["v_final"] == pytest.approx(v0 / (1.0 + beta), rel=1e-3)
    assert got["omega_final"] == pytest.approx(v0 / (1.0 + beta) / RADIUS, rel=1e-3)
    path = v0 * time - 0.5 * mu * G * time**2
    assert got["distance_at_roll"] == pytest.approx(path, rel=2e-3)


def test_error_of_rolling_without_springs_falls_with_the_stiffness():
    exact = 2.0 / (0.3 * G * 3.5)
    soft, stiff = (abs(sliding(kn)["t_roll"] - exact) for kn in (KN / 16.0, KN))
    assert stiff < 0.5 * soft


def on_slope(degrees, *, mu, mur=0.0):
    return descent(angle=radians(degrees), mu=mu, mur=mur, beta=0.4, radius=RADIUS, g=G, kn=KN)


def test_ball_rolls_down_at_g_sin_over_one_plus_beta():
    got, acc = on_slope(20.0, mu=0.5), G * sin(radians(20.0)) / 1.4
    assert got["acc"] == pytest.approx(acc, rel=1e-3)
    assert got["alpha"] == pytest.approx(acc / RADIUS, rel=1e-3)
    assert got["x_after_1s"] == pytest.approx(0.5 * acc, rel=2e-3)


def test_ball_slips_on_a_slope_too_steep_to_roll():
    got, angle = on_slope(50.0, mu=0.2), radians(50.0)
    assert got["acc"] == pytest.approx(G * (sin(angle) - 0.2 * cos(angle)), rel=1e-9)
    assert got["alpha"] == pytest.approx(0.2 * G * cos(angle) / (0.4 * RADIUS), rel=1e-3)


def test_rolling_resistance_slows_the_ball_by_its_arm_over_the_radius():
    mur, angle = 0.005, radians(10.0)
    got = on_slope(10.0, mu=0.5, mur=mur)
    acc = G * (sin(angle) - mur / RADIUS * cos(angle)) / 1.4
    assert got["acc"] == pytest.approx(acc, rel=2e-3)
    assert got["x_after_1s"] == pytest.approx(0.5 * acc, rel=5e-3)


def test_ball_stays_on_a_slope_below_the_angle_of_rolling():
    # tan 2 degrees = .035 < mur / R = .05
    got = on_slope(2.0, mu=0.5, mur=0.005)
    assert abs(got["acc"]) < 1e-4
    assert abs(got["x_after_1s"]) < 1e-4


def test_rolling_ball_loses_mur_g_over_its_moment_about_the_contact():
    mur = 0.01
    got = decay(spin=10.0, mur=mur, beta=0.4, radius=RADIUS, g=G, kn=KN, upright=False)
    rate = mur * G / (RADIUS**2 * 1.4)
    assert got["deceleration"] == pytest.approx(rate, rel=2e-3)
    assert got["t_stop"] == pytest.approx(10.0 / rate, rel=5e-3)


def test_top_of_a_ball_stops_under_the_same_cap():
    mur = 0.001
    got = decay(spin=2.0, mur=mur, beta=0.4, radius=RADIUS, g=G, kn=KN, upright=True)
    rate = mur * G / (0.4 * RADIUS**2)
    assert got["deceleration"] == pytest.approx(rate, rel=1e-4)
    assert got["t_stop"] == pytest.approx(2.0 / rate, rel=5e-3)


def test_friction_of_a_spinning_ball_runs_ahead_of_its_slip_by_half_the_spin():
    # t' = spin/2 x t + kt (u - (u.t) t)/(mu F): in the end sin(angle) = spin mu F/(2 kt u)
    speed, spin, mu, kt, g = 1.0, 20.0, 0.3, 0.1, 0.01
    slide = {"speed": speed, "spin": spin, "mu": mu, "kn": 1e3, "kt": kt, "g": g}
    expected = asin(spin * mu * g / (2.0 * kt * speed))

    # the slide slows by mu g t, a thousandth
    assert lag_of_friction(dt=1.5e-3, time=0.3, **slide) == pytest.approx(expected, rel=2e-3)


def test_error_of_the_direction_of_slip_falls_with_the_square_of_the_step():
    slide = {"speed": 1.0, "spin": 20.0, "mu": 0.3, "kn": 1e3, "kt": 0.1, "g": 0.01}
    fine = lag_of_friction(dt=0.1 / 1600, time=0.1, **slide)

    def error(steps):
        return abs(lag_of_friction(dt=0.1 / steps, time=0.1, **slide) - fine)

    assert order_of(error, (25, 50, 100)) > 1.8


def test_account_of_friction_balances_to_second_order_while_slip_turns():
    slide = {"speed": 1.0, "spin": 200.0, "mu": 0.3, "kn": 1e3, "kt": 1.0, "g": 0.01}

    def imbalance(steps):
        return abs(spinning_slide(dt=0.3 / steps, time=0.3, **slide).energy.balance)

    # beyond, the rounding of 20 kJ of rotation
    assert order_of(imbalance, (25, 50, 100)) > 1.8
