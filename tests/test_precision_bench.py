"""Run time against error: what a ladder of steps measures, and what is read off its curve."""

from dataclasses import replace
from math import isnan

import numpy as np
import pytest
from precision_cases import CASES, impacts, peers, sliding
from precision_cases.curves import Curve
from precision_cases.measuring import Workers, measured
from precision_cases.proof import Proof, gain, proofs
from precision_cases.report import row
from precision_cases.settings import SETTINGS


def curve(order, *, name="default", case="normal_impact", pace=1.0, size=1.0, runs=5):
    """Errors size/n^order of n steps, which take n pace seconds."""
    steps = tuple(10 * 2**k for k in range(runs))
    seconds = tuple(pace * n for n in steps)
    return Curve(case, name, steps, seconds, tuple(size / n**order for n in steps))


@pytest.fixture(scope="module")
def impact_curves():
    case = replace(
        CASES["normal_impact"], steps=(30, 60, 120), settings=("default", "lagged"), programs=()
    )
    with Workers() as workers:
        return {one.name: one for one in measured(case, workers, rungs=None, repeats=1)}


def test_a_normal_impact_is_of_second_order_and_of_first_where_dashpots_lag(impact_curves):
    assert impact_curves["default"].order > 1.8
    assert impact_curves["lagged"].order == pytest.approx(1.0, abs=0.2)


def test_every_run_of_a_ladder_has_its_time(impact_curves):
    assert all(0.0 < s < 60.0 for one in impact_curves.values() for s in one.seconds)


@pytest.mark.parametrize("order", [1.0, 2.0, 4.0])
def test_the_order_of_a_curve_is_its_slope(order):
    assert curve(order).order == pytest.approx(order, abs=1e-9)


def test_where_errors_do_not_fall_there_is_no_order():
    assert isnan(curve(0.1).order)


def test_rounding_at_the_end_of_a_curve_is_not_in_its_order():
    falling = curve(4.0, runs=4)
    steps, seconds = (*falling.steps, 320, 640), (*falling.seconds, 320.0, 640.0)
    flat = replace(falling, steps=steps, seconds=seconds, error=(*falling.error, 2.3e-8, 2.4e-8))
    assert flat.order == pytest.approx(4.0, abs=1e-9)


def test_what_an_error_costs_is_read_between_two_runs():
    assert curve(2.0).cost(1.0 / 30.0**2) == pytest.approx(30.0)
    assert curve(2.0).steps_at(1.0 / 30.0**2) == pytest.approx(30.0)
    assert isnan(curve(2.0).cost(1e-9))


def test_an_error_that_only_a_coarse_run_has_by_chance_is_not_reached():
    lucky = replace(curve(1.0), error=(1e-6, 0.05, 0.025, 0.0125, 0.00625))
    assert isnan(lucky.cost(1e-3))
    assert lucky.cost(0.03) == pytest.approx(100.0 / 3.0)


def test_a_gain_is_the_ratio_of_errors_at_equal_time():
    assert gain(curve(2.0), curve(2.0, size=50.0)) == pytest.approx(50.0)
    # half as fast: a quarter of the error would be left in the same time
    assert gain(curve(2.0), curve(2.0, pace=2.0, size=50.0, runs=4)) == pytest.approx(200.0)


def test_a_proof_passes_only_where_the_figure_is_reached():
    lines = list(proofs([curve(2.0), curve(1.0, name="rockable")]))
    passed = {line.what: line.passes for line in lines}
    assert passed["normal_impact: order of the default"]
    assert passed['normal_impact: run time of "rockable" over ours at 1e-3'] is False
    assert not Proof("nothing", float("nan"), 1.0).passes


def test_a_line_of_the_table_shows_what_was_not_reached():
    words = row(curve(1.0)).split()
    assert words[:3] == ["normal_impact", "default", "1.0"]
    assert words.count("-") == 4


def test_heights_of_bouncing_balls_are_those_of_their_equation_of_motion():
    zeta, gap, left, dt = impacts.damping_ratio(0.8), 0.2, 0.45, 2e-7
    height, speed, damping = gap, 0.0, 2.0 * zeta * np.sqrt(impacts.KN)
    for _ in range(round(left / dt)):
        force = max(0.0, -impacts.KN * height - damping * speed) if height < 0.0 else 0.0
        speed += dt * (force - impacts.G)
        height += dt * speed
    assert impacts.gap_after(gap, left, zeta) == pytest.approx(height, abs=2e-6)


def test_an_oblique_hard_impact_stops_the_slip_or_slides_on():
    hit, before = impacts.oblique_rigid(), np.array(impacts.oblique_problem()["velocity"])
    slip = hit[:, :2] + np.cross(hit[:, 3:], [0.0, 0.0, -1.0])[:, :2]
    stuck = np.linalg.norm(slip, axis=1) < 1e-12
    assert 0.1 < stuck.mean() < 0.9
    assert hit[:, 2] == pytest.approx(-impacts.KEPT * before[:, 2])


def test_a_setting_that_is_the_default_anyway_is_left_out():
    assert SETTINGS["default"].known
    assert SETTINGS["lagged"].known
    assert not replace(SETTINGS["lagged"], run={"contact_update": "predicted"}).known
    assert not replace(SETTINGS["lagged"], run={"contact_update": "unheard of"}).known


def test_a_program_that_is_not_installed_says_so(monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert "no command" in peers.programs("nowhere")["LIGGGHTS"].missing()
    assert "no Python" in peers.programs("nowhere")["MuJoCo"].missing()


def test_balls_in_place_of_blocks_lie_at_their_static_overlap():
    problem = sliding.slope_problem(sliding.STILL)
    place = peers.liggghts.places(problem)
    sunk = 0.5 * problem["block"][2] - place[:, 2]
    assert problem["kn"] * sunk == pytest.approx(-problem["mass"] * problem["gravity"][2])
