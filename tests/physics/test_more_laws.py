"""Small laws beyond the default one: numbers in, closed formulas out."""

from math import inf, pi

import pytest
from gates import gate
from test_laws import of
from warpdem.kernels.avalanche import avalanche, axis_distance
from warpdem.kernels.codes import EE, FV, VF, VV
from warpdem.kernels.cohesion import (
    adhesion,
    at_distance,
    at_distance_energy,
    curvature_radius,
    documented,
)
from warpdem.kernels.precision import FARTHEST, vec3
from warpdem.kernels.sharing import (
    carried_share,
    number_share,
    overlap_share,
    passive_share,
    pnorm_share,
)


def test_avalanche_loads_along_the_spring():
    assert of(avalanche, 1e6, 0.3, -2e-4, -1.5e-4, 150.0) == pytest.approx(200.0)


def test_avalanche_unloads_along_the_softer_spring_whatever_it_bore():
    assert of(avalanche, 1e6, 0.3, -1e-4, -1.5e-4, 150.0) == pytest.approx(0.3 * 1e6 * 1e-4)


def test_avalanche_keeps_its_force_while_nothing_moves():
    assert of(avalanche, 1e6, 0.3, -1e-4, -1e-4, 77.0) == 77.0


def test_avalanche_counts_an_open_contact_as_just_touching():
    assert of(avalanche, 1e6, 0.3, -1e-4, 5e-3, 0.0) == pytest.approx(100.0)


def test_avalanche_never_pulls():
    assert of(avalanche, 1e6, 0.3, 1e-6, -1e-4, 10.0) == 0.0


def test_axis_distance_is_measured_across_the_spin():
    assert of(axis_distance, vec3(3.0, 4.0, 7.0), vec3(0.0, 0.0, -2.0)) == pytest.approx(5.0)


def test_a_body_at_rest_turns_about_no_axis_and_nothing_is_cut():
    assert of(axis_distance, vec3(3.0, 4.0, 7.0), vec3()) == pytest.approx(FARTHEST)


def test_attraction_at_a_distance_falls_from_fc_at_touch_to_nothing_at_dncut():
    assert of(at_distance, 20.0, 0.0, 0.05) == -20.0
    assert of(at_distance, 20.0, 0.02, 0.05) == pytest.approx(-12.0)
    assert of(at_distance, 20.0, 0.05, 0.05) == pytest.approx(0.0)


@pytest.mark.parametrize("gap", [-0.01, 0.01, 0.04])
def test_force_at_a_distance_is_the_slope_of_its_energy(gap):
    h = gate(1e-6, mixed=1e-3)
    rise = of(at_distance_energy, 20.0, gap + h, 0.05) - of(at_distance_energy, 20.0, gap - h, 0.05)
    force = -20.0 if gap < 0 else of(at_distance, 20.0, gap, 0.05)
    assert -rise / (2 * h) == pytest.approx(force, rel=gate(1e-6, mixed=1e-4))


def test_energy_of_attraction_is_continuous_at_touch():
    touch = of(at_distance_energy, 20.0, 0.0, 0.05)
    assert of(at_distance_energy, 20.0, -1e-15, 0.05) == pytest.approx(touch)
    assert touch == pytest.approx(-20.0 * 0.05 / 2)


@pytest.mark.parametrize(
    ("gap", "free", "force"), [(-0.01, -50.0, -20.0), (-0.01, 30.0, 30.0), (-0.06, -50.0, -50.0)]
)
def test_documented_cohesion_pulls_with_fc_at_most_until_dncut(gap, free, force):
    assert of(documented, gap, 0.05, 20.0, free) == force


def test_adhesion_of_two_balls_pulls_as_derjaguin_muller_and_toporov_say():
    radius = of(curvature_radius, VV, 0.2, 0.3)
    assert radius == pytest.approx(0.2 * 0.3 / 0.5)
    assert of(adhesion, radius, 0.07) == pytest.approx(2 * pi * 0.12 * 0.07)


def test_a_face_is_flat_whatever_its_rounding():
    assert of(curvature_radius, VF, 0.2, 0.01) == 0.2
    assert of(curvature_radius, FV, 0.01, 0.2) == 0.2
    assert of(curvature_radius, EE, 0.2, 0.2) == pytest.approx(0.1)


def test_shares_of_n_equal_subcontacts():
    n, d, p = 4, 1e-4, 4.0
    assert of(number_share, d, float(n), p) == 0.25
    assert of(overlap_share, d, n * d, p) == pytest.approx(0.25)
    g = n ** (1 / p) * d
    # the whole pair has the stiffness kn n^(2/p)
    assert n * of(pnorm_share, d, g, p) == pytest.approx(n ** (2 / p))


def test_pnorm_of_exponent_two_is_the_sum():
    assert of(pnorm_share, 3e-5, 8e-4, 2.0) == 1.0


@pytest.mark.parametrize(("before", "now"), [(0.2, 0.5), (0.5, 0.2), (0.4, 0.4)])
def test_moving_shares_give_a_tangential_spring_no_energy(before, now):
    force, kt = 10.0, 1e6
    kept = of(carried_share, before, now) * force
    assert kept**2 / (now * kt) <= force**2 / (before * kt) * (1 + 1e-15)


def test_stiffness_of_a_growing_share_is_that_of_the_middle_of_the_step():
    assert of(passive_share, 0.2, 0.5) == pytest.approx(0.35)
    assert of(passive_share, 0.5, 0.2) == pytest.approx(0.2)


def test_infinite_arms_do_not_make_nan():
    assert 0.0 * of(axis_distance, vec3(1.0, 0.0, 0.0), vec3()) == 0.0
    assert of(axis_distance, vec3(1.0, 0.0, 0.0), vec3()) < inf
