"""Blocks at rest and on the verge of falling, columns of springs, the limit of the time step."""

from math import asin, cos, hypot, radians, sin

import numpy as np
import pytest
from blocks import (
    Column,
    chain_mode,
    growth,
    limit_of_stability,
    mode_frequency,
    on_slope,
    overhang,
)
from gates import gate, not_in_mixed

from warpdem.errors import SceneError

G = 9.81
KN = 1e6


def block(degrees, *, mu, base=0.2, height=0.1, rounding=0.0, duration=0.5, stiffer=1.0):
    return on_slope(
        angle=radians(degrees),
        mu=mu,
        base=base,
        height=height,
        rounding=rounding,
        g=G,
        kn=KN,
        kt=0.8 * KN,
        duration=duration,
        stiffer=stiffer,
    )


@pytest.mark.parametrize(
    ("degrees", "mu", "base", "height", "rounding"),
    [(20.0, 0.5, 0.2, 0.1, 0.0), (35.0, 0.9, 0.1, 0.12, 0.005), (10.0, 0.4, 0.3, 0.1, 0.01)],
)
def test_corners_of_a_block_at_rest_carry_what_statics_says(degrees, mu, base, height, rounding):
    # stiff, so that the overlap does not shorten the arm of friction
    got = block(
        degrees,
        mu=mu,
        base=base,
        height=height,
        rounding=rounding,
        duration=0.05,
        stiffer=100.0,
    )
    angle = radians(degrees)
    share = sin(angle) * 0.5 * height / (0.5 * base - rounding)
    assert got["front"] / G == pytest.approx(0.25 * (cos(angle) + share), abs=1e-6)
    assert got["back"] / G == pytest.approx(0.25 * (cos(angle) - share), abs=1e-6)
    assert got["mean_overlap"] == pytest.approx(G * cos(angle) / (4.0 * KN), rel=1e-6)
    assert abs(got["speed"]) < 1e-9


def test_friction_of_a_block_at_rest_is_shared_by_equal_springs():
    got = block(10.0, mu=0.4, base=0.3, duration=0.05, stiffer=100.0)
    assert got["offset"] == pytest.approx(G * sin(radians(10.0)) / (4.0 * 0.8 * KN), rel=1e-5)


def test_block_slides_beyond_the_angle_of_friction():
    got, angle = block(30.0, mu=0.3), radians(30.0)
    assert got["acc_slide"] == pytest.approx(G * (sin(angle) - 0.3 * cos(angle)), rel=1e-6)
    assert got["tilt"] < 1e-4
    # friction is now mu N, and so is its moment
    share = 0.3 * cos(angle) * 0.05 / 0.1
    assert got["front"] / G == pytest.approx(0.25 * (cos(angle) + share), rel=1e-4)


@pytest.mark.parametrize(("share", "tips"), [(0.97, False), (1.03, True)])
def test_tall_block_tips_where_its_weight_passes_the_edge(share, tips):
    base, height = 0.1, 0.3
    degrees = np.degrees(np.arctan(share * base / height))
    # it starts with no friction; the swing to rest is not to tip it
    got = block(degrees, mu=1.5, base=base, height=height, duration=0.5, stiffer=100.0)
    assert (got["tilt"] > 0.1) == tips


# columns


def test_column_of_balls_settles_to_the_weights_above():
    count, k = 5, 1e6
    expected = G * np.arange(count, 0, -1) / k
    column = Column(count=count, k=k, g=G, dt=3e-4, zeta=1.0, overlaps=1.1 * expected)
    slowest = chain_mode(count, 1)[0]
    column.simulation.advance(22.0 * np.sqrt(2.0 / k) / slowest**2)
    assert column.overlaps() == pytest.approx(expected, rel=gate(1e-8, mixed=2e-3))


@not_in_mixed("it starts from a disturbance below the rounding of gaps")
@pytest.mark.parametrize(("count", "number"), [(2, 1), (2, 2), (10, 1), (10, 10)])
def test_modes_of_a_column_have_the_frequencies_of_a_chain(count, number):
    k = 1e6
    omega, dt = chain_mode(count, number)[0] * np.sqrt(k), 1e-4
    # kick-drift-kick turns by 2 asin(w dt/2) a step
    expected = 2.0 / dt * asin(0.5 * omega * dt)
    got = mode_frequency(count=count, number=number, k=k, g=G, dt=dt)
    assert got == pytest.approx(expected, rel=1e-6)


def test_step_bound_lies_just_below_the_limit_of_a_column():
    k, count = 1e6, 10
    static = G * np.arange(count, 0, -1) / k
    column = Column(count=count, k=k, g=G, dt=1e-4, overlaps=static)
    limit = 2.0 / (chain_mode(count, count)[0] * np.sqrt(k))
    assert 0.9 * limit < column.simulation.step_bound() <= limit


@not_in_mixed("it starts from a disturbance below the rounding of gaps")
def test_column_is_stable_below_two_over_its_highest_frequency_and_not_above():
    k, count = 1e6, 3
    limit = 2.0 / (chain_mode(count, count)[0] * np.sqrt(k))
    found = limit_of_stability(0.9 * limit, 1.1 * limit, count=count, k=k, g=G)
    assert found == pytest.approx(limit, rel=2e-3)


@not_in_mixed("it starts from a disturbance below the rounding of gaps")
@pytest.mark.parametrize("zeta", [0.0, 0.2, 1.0])
def test_damping_takes_nothing_from_the_step_of_a_single_contact(zeta):
    ball = {"count": 1, "k": 1e5, "g": G, "zeta": zeta, "steps": 2000}
    limit = 2.0 / np.sqrt(1e5)
    assert growth(dt=0.98 * limit, **ball) < 1e2
    assert growth(dt=1.02 * limit, **ball) > 1e3


@not_in_mixed("it starts from a disturbance below the rounding of gaps")
def test_damping_of_the_last_velocity_takes_its_known_share_of_the_step():
    zeta = 1.0
    limit = 2.0 / np.sqrt(1e5) * (hypot(1.0, zeta) - zeta)
    ball = {"count": 1, "k": 1e5, "g": G, "zeta": zeta, "steps": 2000, "contact_update": "lagged"}
    assert growth(dt=0.98 * limit, **ball) < 1e2
    assert growth(dt=1.02 * limit, **ball) > 1e3


def test_step_above_the_limit_of_one_contact_is_refused_with_both_numbers():
    with pytest.raises(SceneError, match=r"unstable.*0\.006325"):
        Column(count=1, k=1e5, g=G, dt=0.0064)


# stacks


@pytest.mark.parametrize(("share", "falls"), [(0.98, False), (1.02, True)])
def test_harmonic_overhang_is_the_limit(share, falls):
    shifts = 0.5 / np.arange(1, 4)
    tilt = overhang(shifts=shifts, length=1.0, share=share, duration=0.8, kn=2e5)
    assert tilt > 0.02 if falls else tilt < 2e-3
