"""Run-outs as distributions: halved steps, and the smooth method on the same scene."""

from pathlib import Path

import numpy as np
import pytest
from runouts import (
    BLOCK,
    SLAB,
    compared,
    flights,
    nonsmooth,
    runouts,
    sliders,
    smooth,
    tumblers,
    written,
)

TSCHAMUT = Path(__file__).resolve().parents[2] / "scenes" / "rockfall_tschamut.toml"


@pytest.fixture(scope="module")
def thrown():
    """Run-outs of some throws of the field test as the scene says."""
    return of_the_field_test()


def of_the_field_test(*changes):
    end, _ = flights(TSCHAMUT, "ensemble.count=300", *changes)
    return runouts(end)


def test_half_the_step_and_stride_give_the_same_distribution_of_run_outs(thrown):
    finer = of_the_field_test("run.dt=2.5e-3", "run.stride=0.015")

    assert not np.allclose(finer, thrown, rtol=0.1)  # the trajectories are others
    assert compared(thrown, finer)[1] > 0.05


def test_jumps_through_free_flight_give_the_same_distribution_of_run_outs(thrown):
    assert compared(thrown, of_the_field_test('run.skip="none"'))[1] > 0.05


def test_slabs_slide_as_far_by_the_smooth_method(tmp_path):
    # friction alone: each slab, not only their distribution
    path = written(tmp_path, SLAB, sliders(12))

    assert nonsmooth(path) == pytest.approx(smooth(path), rel=5e-3)


@pytest.mark.parametrize(("mu", "en2"), [(0.35, 0.04), (0.5, 0.36)])
def test_blocks_tumble_as_far_by_the_smooth_method(tmp_path, mu, en2):
    # where they stick and keep nothing of an impact, springs share it out otherwise: D is .2 to .3
    path = written(tmp_path, BLOCK, tumblers(48), mu=mu, en2=en2)
    hard, soft = nonsmooth(path), smooth(path)

    assert compared(hard, soft)[1] > 0.05
    assert np.median(hard) == pytest.approx(np.median(soft), rel=0.1)
