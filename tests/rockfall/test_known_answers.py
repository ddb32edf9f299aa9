"""Rocks whose motion is known in closed form; tools/bench/rockfall_answers.py shows all."""

from math import acos, atan2, cos, degrees, pi, radians, sqrt

import numpy as np
import pytest
from motions import (
    LEINE,
    G,
    about_y,
    ball_that_slips,
    body_spin,
    bouncing_balls,
    edge_roll,
    flown,
    free_rotor,
    height_errors,
    impacts_of,
    painleve,
    rod_jams,
    rolling_since,
    rotation_zyx,
    sampled,
    slide,
    stop_of_slider,
    vertex_impact,
    way_until_it_opens,
)
from rocking import rockings
from slopes import ball, box, fixed_step, law, plane, site_on, starts

from warpdem.geometry.orientation import matrix
from warpdem.rockfall.flights import Fate, Method


def test_bouncing_ball_converges_with_order_one():
    coarse, fine = height_errors(1e-2), height_errors(1e-4)

    assert coarse.max() < 0.075
    assert fine.max() < 8e-4
    assert coarse.max() / fine.max() > 80.0


def test_impacts_of_a_bouncing_ball_come_within_a_microsecond_at_a_tenth_of_one():
    # the gate of the family moreau_bounce, case 01
    exact = [0.638550856814101, 1.277101713628202, 1.5963771420352524, 1.7560148562387776]
    for time, way in bouncing_balls(2.0, 0.5, 1e-7, 1.8):
        when, peak = impacts_of(time, way)
        assert when[:4] == pytest.approx(exact, abs=1e-6)
        assert peak[:4] == pytest.approx([0.5, 0.125, 0.03125, 0.0078125], abs=1e-6)


def test_ball_comes_to_rest_when_the_sum_of_its_bounces_says():
    # T = sqrt(2 h / g) (1 + e) / (1 - e), the family moreau_bounce
    site = site_on(plane(), law(0.0, restitution=0.5))
    method = fixed_step(1e-4, 10.0, skip="none")
    way = sampled(site, ball(0.1), method, starts([[0, 0, 2.1]]))

    moving = way.time[np.abs(way.position[:, 2] - 0.1) > 1e-3]
    assert moving[-1] == pytest.approx(1.9156525704423029, abs=0.05)
    assert way.position[-1, 2] == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("azimuth", [0.0, 0.7, 2.1, 4.0])
def test_slider_stops_where_friction_says(azimuth):
    # d = v0^2 / (2 g (mu cos a - sin a)); the scheme is of order 2 here
    mu, angle = 0.8, radians(25.0)
    exact = slide(mu, angle, 5.0)

    assert stop_of_slider(mu, angle, azimuth, 1e-2) == pytest.approx(exact, rel=1.7e-4)
    assert stop_of_slider(mu, angle, azimuth, 1e-3) == pytest.approx(exact, rel=3e-6)


def test_ball_rolls_at_five_sevenths_of_its_speed_when_friction_has_turned_it():
    way = ball_that_slips(3.0, 0.3, 0.5, 0.4, 1e-3, 2.0)

    rolls = rolling_since(way, 0.5)
    assert way.time[rolls] == pytest.approx(2.0 * 3.0 / (7.0 * 0.3 * G), abs=1e-3)
    assert way.velocity[-1, 0] == pytest.approx(5.0 / 7.0 * 3.0, rel=1e-12)


ROCKING = [
    # half width, half height, theta_0 / alpha; of two impacts: quarter times [s], amplitudes
    # [rad], spins before and after [rad/s]; the family rocking_block
    (
        (0.1, 0.4, 0.5),
        (0.3123085751126223, 0.25414182698498927), (0.12248933156343207, 0.09473679312081673),
        (0.8934143073025634, 0.8145836331288079), (0.8145836331288079, 0.742708606676266),
    ),
    (
        (0.05, 0.25, 0.3),
        (0.16702115631528225, 0.1522432494228434), (0.05921866795496423, 0.05139427777981385),
        (0.7554534573107716, 0.7118696040043809), (0.7118696040043809, 0.6708002037733589),
    ),
]  # fmt: skip


@pytest.mark.parametrize(("start", "quarters", "amplitudes", "before", "after"), ROCKING)
def test_rocking_block_follows_housner(start, quarters, amplitudes, before, after):
    # each impact comes late by a part of a step: all four are off by 5.1e-5 at most at 1.5e-6 s
    got = rockings(*start, (quarters[0], quarters[0] + 2.0 * quarters[1]), 1e-5)

    assert got["quarter_times"] == pytest.approx(quarters, rel=5e-4)
    assert got["amplitudes"] == pytest.approx(amplitudes, rel=5e-4)
    assert got["omega_before"] == pytest.approx(before, rel=5e-4)
    assert got["omega_after"] == pytest.approx(after, rel=5e-4)


def test_cube_that_lands_on_an_edge_keeps_a_quarter_of_its_spin():
    # about the edge it slides on: w+ / w- = 1 - 3/4 for a cube that trips over its next edge
    assert edge_roll(1e-9) == pytest.approx(0.25, abs=1e-9)


IMPULSES = [
    # size, turn about z y x by its x y z, velocity, spin, mu, e -> velocity and spin after; the
    # family box_impulse: without friction twice, sticking
    (
        (0.2, 0.2, 0.2), (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), 0.0, 1.0,
        (0.0, 0.0, 0.066637709002479), (-19.00883425200138, -15.42718810220366, 0.0),
    ),
    (
        (0.2, 0.3, 0.5), (1.0, 0.0, -2.0), (0.0, 3.0, 1.0), 0.0, 0.5,
        (1.0, 0.0, 0.3832637221819182),
        (-7.654072591122511, 5.156662585499514, -2.6926210517716695),
    ),
    (
        (0.2, 0.3, 0.5), (1.0, 0.5, -3.0), (0.0, 3.0, 1.0), 0.9, 0.5,
        (1.142231338506617, 1.1834395940255895, 1.1609673514559677),
        (-3.9723857240947105, 3.655882068613262, -0.6542173572146579),
    ),
]  # fmt: skip


@pytest.mark.parametrize(("size", "v", "w", "mu", "e", "v_after", "w_after"), IMPULSES)
def test_vertex_impact_of_a_box_is_exact_in_one_step(size, v, w, mu, e, v_after, w_after):
    turn = rotation_zyx(0.3, 0.4, 0.1)
    end = vertex_impact(size, 1000.0, turn, v, w, mu, e, 1e-12)

    assert end.counts[0, 0] == 1
    assert end.velocity[0] == pytest.approx(v_after, abs=1e-10)
    assert end.spin[0] == pytest.approx(w_after, abs=1e-10)


MOMENTS = np.array([1.0, 2.0, 3.0])


def free_rotor_error(dt, gyroscope="midpoint"):
    """Miss of the body spin after 1 s of a rotor without forces."""
    spin = np.array([1.0, 1.0, 1.0])
    end = free_rotor(MOMENTS, spin, dt, 1.0, gyroscope)
    return np.abs(body_spin(end) - euler_spin(MOMENTS, spin, end.time[0])).max(), end


def euler_spin(moments, spin, until, steps=4000):
    """Euler's equations by a fine classical Runge-Kutta."""

    def rate(w):
        return -np.cross(w, moments * w) / moments

    h = until / steps
    w = spin.copy()
    for _ in range(steps):
        a = rate(w)
        b = rate(w + h / 2 * a)
        c = rate(w + h / 2 * b)
        w = w + h / 6 * (a + 2 * b + 2 * c + rate(w + h * c))
    return w


def test_free_spin_is_of_second_order_and_keeps_its_energy():
    coarse, end = free_rotor_error(1e-2)
    fine, _ = free_rotor_error(1e-3)

    assert coarse / fine == pytest.approx(100.0, rel=0.1)
    assert MOMENTS @ body_spin(end) ** 2 == pytest.approx(6.0, rel=1e-13)


def test_published_gyroscopic_term_is_of_first_order():
    coarse, _ = free_rotor_error(1e-2, "leine")
    fine, _ = free_rotor_error(1e-3, "leine")

    assert coarse / fine == pytest.approx(10.0, rel=0.2)


def test_rear_contact_of_leines_bipyramid_opens_where_friction_reaches_one():
    # mu(s*) = 1: s* = tan(pi/2 (1 - mu_min) / (mu_max - mu_min)) / kappa; Leine et al., 5.1
    assert pytest.approx(3.1281, abs=5e-5) == LEINE.way
    assert way_until_it_opens(1e-3) == pytest.approx(LEINE.way, abs=2e-3)


@pytest.mark.parametrize("angle", [atan2(2.0, 1.0), radians(50.0)])
def test_painleves_paradox_is_noticed_where_it_begins(angle):
    # mu_P = (1 + 3 cos^2) / (3 sin cos), 4/3 at its least: beyond it no sliding percussion exists
    critical = painleve(angle)

    assert not rod_jams(critical - 1e-4, angle)
    assert rod_jams(critical + 1e-4, angle)


def test_rest_is_not_declared_while_a_rock_turns_over_its_edge():
    # nearly balanced on an edge, it hardly moves for longer than the window, then falls over
    block = box((1.0, 1.0, 1.0))
    angle = pi / 4 - 2e-3
    height = sqrt(0.5) * cos(pi / 4 - angle)
    begin = starts([[0, 0, height]], orientation=about_y(angle))
    end = flown(site_on(plane(), law(1.0)), block, Method(duration=20.0), begin)

    lying = degrees(acos(min(1.0, np.abs(matrix(end.orientation[0])[2]).max())))
    assert end.fate[0] == Fate.REST
    assert lying < 0.5
