"""Contact laws in motion: what they promise of rebounds, and energies that add up."""

from math import sqrt
from pathlib import Path

import numpy as np
import pytest
import warp as wp
from laws import KN, MASS, RADIUS, head_on, imbalance, separation

from scenes import ball, body, box, laboratory, record
from warpdem.errors import SceneError

OWN = str(Path(__file__).with_name("own_laws.py"))
HERTZ = {"law": "custom", "file": OWN, "normal": "hertz", "parameters": [1e5]}
LAWS = {
    "default": {"en2": 0.25},
    "avalanche": {"law": "avalanche", "en2": 0.25},
    "at a distance": {"en2": 0.25, "fc": 5.0, "dncut": 0.02},
    "adhesion": {"en2": 0.25, "gamma": 10.0},
    "custom": HERTZ,
    "pnorm": {"en2": 0.25},
}
RUNS = {"pnorm": {"partnership": "pnorm"}}


@pytest.mark.parametrize("name", LAWS)
def test_energies_of_a_law_add_up_to_second_order(name):
    run = RUNS.get(name, {})
    coarse, fine = (imbalance(LAWS[name], dt, **run) for dt in (1.6e-4, 2e-5))
    assert fine < 1e-5
    assert coarse / fine > 8.0**1.5


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_energies_of_a_law_add_up_to_a_millionth(name):
    assert imbalance(LAWS[name], 4e-6, **RUNS.get(name, {})) < 1e-6


@pytest.mark.parametrize("en2", [0.05, 0.5])
def test_avalanche_rebounds_with_the_energy_en2(en2):
    simulation = head_on({"law": "avalanche", "en2": en2}, 1.0, 1e-5)
    simulation.advance(0.1)
    assert separation(simulation) ** 2 == pytest.approx(en2, rel=2e-3)


def test_balls_part_only_if_their_energy_exceeds_that_of_the_attraction():
    fc, reach = 5.0, 0.02
    escape = sqrt(2.0 * (fc * reach / 2.0) / (0.5 * MASS))
    rules = {"en2": 1.0, "fc": fc, "dncut": reach}
    for factor, free in ((0.95, False), (1.05, True)):
        simulation = head_on(rules, -factor * escape, 1e-5)
        simulation.advance(0.5)
        gap = np.diff(simulation.snapshot().position[:2, 0])[0] - 2.0 * RADIUS
        assert bool(gap > reach) is free


def test_speed_after_attraction_at_a_distance_is_that_of_its_potential():
    fc, reach = 5.0, 0.02
    rules = {"en2": 1.0, "fc": fc, "dncut": reach}
    simulation = head_on(rules, 1.0, 1e-5, distance=2.0 * RADIUS + 2.0 * reach)
    deepest = 0.0
    while (energy := simulation.snapshot(contacts=True)).time < 0.1:
        gaps = energy.contacts.gap
        deepest = min(deepest, *gaps, 0.0)
        simulation.advance(simulation.time + 2e-4)
    # 1/2 m v^2 = 1/2 kn d^2 - fc d - fc dncut / 2
    d = (fc + sqrt(fc**2 + KN * (0.5 * MASS * 1.0 + fc * reach))) / KN
    assert -deepest == pytest.approx(d, rel=1e-3)
    assert separation(simulation) == pytest.approx(1.0, rel=1e-4)


def test_documented_cohesion_pulls_with_fc_where_the_dashpot_would_pull_more():
    rules = {"en2": 1e-4, "fc": 5.0, "dncut": 0.02}
    run = {"distance": 2.0 * RADIUS - 2e-3, "cohesion": "documented"}
    simulation = head_on(rules, -0.5, 1e-5, **run)
    assert simulation.snapshot().force[0, 0] == pytest.approx(5.0, rel=1e-12)
    resting = head_on(rules, 0.0, 1e-5, **run)
    assert resting.snapshot().force[0, 0] == pytest.approx(-KN * 2e-3, rel=1e-9)


def test_custom_law_stores_and_gives_back_the_energy_of_its_power_law():
    speed, factor = 1.0, 1e5
    simulation = head_on(HERTZ, speed, 1e-5)
    deepest = min(
        float(shot.position[1, 0] - shot.position[0, 0]) for shot in record(simulation, 8000)
    )
    # 1/2 m v^2 = 2/5 k d^(5/2)
    overlap = (0.5 * 0.5 * MASS * speed**2 * 2.5 / factor) ** 0.4
    assert 2.0 * RADIUS - deepest == pytest.approx(overlap, rel=1e-4)
    assert separation(simulation) == pytest.approx(speed, rel=1e-4)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"file": "nowhere.py"}, "cannot be read"),
        ({"normal": "herz"}, "it has: hertz, not_a_device_function"),
        ({"normal": "not_a_device_function"}, "decorated with @wp.func"),
    ],
)
def test_a_custom_law_that_is_not_there_is_told(wrong, message):
    with pytest.raises(SceneError, match=message):
        head_on({**HERTZ, **wrong}, 1.0, 1e-4)


WRONG = """
import warp as wp
from warpdem.kernels.custom import Kinematics, Parameters, Touch, real


@wp.func
def mixed(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:
    return touch.overlap * 3.0


@wp.func
def lonely(x: real) -> real:
    return x


@wp.func
def searching(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:
    return touch.nothing


@wp.func
def unheard(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:
    return softness * touch.overlap


@wp.func
def coarse(touch: Touch, motion: Kinematics, parameters: Parameters):
    return 3.0
"""


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mixed", r"wrong\.py:8  mixed: .*touch\.overlap \* 3\.0.*must be the same"),
        ("lonely", r"wrong\.py  lonely: .*cannot call it as a law: .*overload"),
        ("searching", r"wrong\.py:18  searching: .*`nothing` is not an attribute"),
        ("unheard", r"wrong\.py:23  unheard: .*softness"),
        ("coarse", r"wrong\.py  coarse: .*cannot call it as a law"),
    ],
)
def test_a_custom_law_that_warp_cannot_translate_is_told(name, message, tmp_path):
    (tmp_path / "wrong.py").write_text(WRONG)
    wrong = {"law": "custom", "file": str(tmp_path / "wrong.py"), "normal": name}
    with pytest.raises(SceneError, match=message) as error:
        head_on(wrong, 1.0, 1e-4)
    assert len(str(error.value).splitlines()) == 2


def test_what_is_no_fault_of_a_custom_law_is_raised_as_it_is(monkeypatch):
    load, calls = wp.load_module, []

    def fails_once(module, device):
        calls.append(module)
        if len(calls) == 1:
            raise RuntimeError('Error while parsing function "kick" at kick.py:1:\nx\n;no')
        load(module, device=device)

    monkeypatch.setattr(wp, "load_module", fails_once)
    with pytest.raises(RuntimeError, match="kick"):
        head_on(HERTZ, 1.0, 1e-4)
    assert len(calls) == 2


def settled(partnership):
    """Overlap of a cube at rest flat on the floor [m], of mass 1 and with four sub-contacts."""
    cube = box("cube", [0.2, 0.2, 0.2], rounding=0.01)
    law = {"kn": KN, "kt": 0.0, "mu": 0.0, "en2": 0.01}
    simulation = laboratory(
        [cube],
        [body("cube", [0.0, 0.0, 0.1])],
        law,
        dt=1e-4,
        gravity=(0, 0, -9.81),
        partnership=partnership,
    )
    simulation.advance(1.5)
    return 0.1 - simulation.snapshot().position[0, 2]


@pytest.mark.parametrize(
    ("partnership", "stiffness"),
    [("sum", 4.0), ("number", 1.0), ("overlap", 1.0), ("pnorm", 4.0**0.5)],
)
def test_four_subcontacts_have_the_stiffness_of_their_partnership(partnership, stiffness):
    assert settled(partnership) == pytest.approx(9.81 * MASS / (KN * stiffness), rel=1e-6)


def test_each_pair_of_groups_has_its_own_law():
    """Balls that fall on the floor at once, one by a dashpot, one by the law of avalanches."""
    falling = {"velocity": [0.0, 0.0, -1.0]}
    bodies = [body("ball", [x, 0.0, RADIUS], **falling) for x in (0.0, 1.0)]
    bodies[1]["group"] = "soft"
    base = {"kn": KN, "kt": 0.0, "mu": 0.0}
    other = [
        {"groups": ["soft", "floor"], **base, "law": "avalanche", "en2": 0.5},
        {"groups": ["soft", "free"], **base, "en2": 1.0},
    ]
    simulation = laboratory(
        [ball("ball", RADIUS)], bodies, {**base, "en2": 0.04}, dt=1e-5, contacts=other
    )
    simulation.advance(0.1)
    up = simulation.snapshot().velocity[:2, 2]
    assert up[0] == pytest.approx(0.2, rel=2e-3)
    assert up[1] == pytest.approx(sqrt(0.5), rel=2e-3)
