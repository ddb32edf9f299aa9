"""What the benches against field data compute themselves."""

import numpy as np
import pytest
import rockfall_cases as cases
import rockfall_chant_sura as chant_sura
import rockfall_lu as lu
from runouts import compared
from slopes import law

from warpdem.geometry.orientation import turned
from warpdem.geometry.terrain import raster_of


def test_the_distance_of_two_samples_is_that_of_their_steps():
    # at 2: two thirds of the first, none of the second; ties count on both sides
    assert cases.kolmogorov_smirnov(np.array([1.0, 2.0, 5.0]), np.array([3.0, 5.0])) == (
        pytest.approx(2 / 3)
    )
    assert cases.kolmogorov_smirnov(np.array([3.0, 1.0]), np.array([1.0, 3.0])) == 0.0


def test_observations_like_their_groups_are_not_rejected_and_others_are():
    random = np.random.default_rng(1)
    level = 10.0 * np.arange(20)  # groups differ far more than their members
    groups = list(level[:, None] + random.normal(size=(20, 10)))
    assert cases.chance_within(groups, level + random.normal(size=20)) > 0.05
    assert cases.chance_within(groups, level + 500.0) == pytest.approx(1e-3)


def test_groups_without_other_values_say_nothing():
    seen = np.array([1.0, 2.5])
    assert cases.chance_within([np.zeros(0), np.array([2.5])], seen, draws=50) == 1.0


def test_refined_and_extended_rasters_are_the_same_surface():
    heights = np.random.default_rng(2).normal(size=(5, 6))
    raster = raster_of(heights, 100.0, 200.0, 2.0)
    x, y = np.random.default_rng(3).uniform([[100.0], [200.0]], [[110.0], [208.0]], (2, 40))
    one, fine, wide = (
        cases.height(cases.site_of(each, law(0.5)), x, y)
        for each in (raster, cases.refined(raster, 4), cases.extended(raster, 3.0))
    )
    np.testing.assert_allclose(fine, one, atol=1e-12)
    np.testing.assert_allclose(wide, one, atol=1e-12)


def test_coarse_rasters_of_a_plane_are_that_plane():
    x, y = np.arange(12.0), np.arange(8.0)
    plane = 0.3 * x - 0.2 * y[::-1, None]
    coarse = cases.coarsened(raster_of(plane, 0.0, 0.0, 1.0), 3)
    np.testing.assert_allclose(coarse.heights, 0.3 * coarse.x - 0.2 * coarse.y[:, None])


def test_an_observed_spin_turns_about_the_same_axis_of_the_rock_however_it_lies():
    rock = chant_sura.ROCKS["W200"]
    orientation = cases.random_orientations(5, seed=1)
    spin = chant_sura.spins(rock, orientation, np.array([2.0, 0.0, 0.0]))
    # the data's x is the axis of the largest moment: the short one of the plate
    short = np.eye(3)[np.argmax(rock.inertia)]
    along = np.einsum("ni,ni->n", spin, turned(orientation, np.tile(short, (5, 1))))
    np.testing.assert_allclose(np.abs(along), 2.0, rtol=1e-9)


def test_a_rolling_wheel_has_its_axis_across_the_slope():
    axis = np.eye(3)[np.argmax(lu.PLATE.inertia)]
    turning = turned(lu.rolling(6), np.tile(axis, (6, 1)))
    np.testing.assert_allclose(np.abs(turning[:, 1]), 1.0, rtol=1e-9)


def test_the_plates_have_the_recorded_moments():
    np.testing.assert_allclose(np.sort(lu.PLATE.inertia), [52.2, 52.2, 83.5], rtol=4e-3)
    recorded = [5.741, 5.741, 9.186]  # kg m^2; EnviDat, doi:10.16904/envidat.174
    np.testing.assert_allclose(np.sort(chant_sura.ROCKS["W200"].inertia), recorded, rtol=4e-3)


def test_chance_of_a_distance_is_that_of_the_tables():
    # of two samples of 100 the 5 % point is near D = 1.36 / sqrt(50)
    first = np.arange(100.0)
    shift = round(136.0 / np.sqrt(50.0))
    assert 0.03 < compared(first, first + shift)[1] < 0.07
    assert compared(first, first)[1] == 1.0
