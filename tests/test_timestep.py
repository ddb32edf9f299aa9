import json
from math import cos, exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest

from warpdem.checks.check import build_shapes
from warpdem.checks.restitution import zeta_bilateral, zeta_clamped
from warpdem.checks.timestep import (
    automatic_step,
    block_bound,
    contact_time,
    loaded_points,
    single_contact_limit,
)
from warpdem.errors import SceneError
from warpdem.filling.placement import place
from warpdem.input.decode import loads
from warpdem.input.scene import Scene

REFERENCE = Path(__file__).parents[2] / "shared/reference/analytic/restitution_inverse.json"

BALLS = """
run = {{duration = 1.0, {run}}}
shape = [{{kind = "sphere", name = "ball", radius = 0.1}}]
body = [
    {{shape = "ball", position = [0, 0, 0], density = 1000.0}},
    {{shape = "ball", position = [1, 0, 0], density = 1000.0, scale = 2.0}},
    {{shape = "ball", position = [9, 0, 0], fixed = true}},
]
contact = [{{groups = ["default", "default"], kn = 1e6, kt = 1e6, en2 = 0.25, mu = 0.5}}]
"""
MASS = 1000.0 * 4.0 / 3.0 * pi * 0.1**3
EFFECTIVE = 8.0 / 9.0 * MASS


def step_of(text):
    scene = loads(text)
    polyhedra = build_shapes(scene)
    return automatic_step(scene, place(scene, polyhedra), polyhedra)


@pytest.mark.parametrize(
    ("e", "clamped", "bilateral"),
    [
        (1.0, 0.0, 0.0),
        (0.9, 0.03426520412623276, 0.03351844910567637),
        (0.5, 0.2552756376486518, 0.21545376196624677),
        (exp(-2), 1.0, 0.537029272146315),
        (0.1, 1.2431878510137804, 0.5911550337988976),
    ],
)
def test_damping_ratios_of_restitution_coefficients(e, clamped, bilateral):
    assert zeta_clamped(e) == pytest.approx(clamped, rel=1e-13)
    assert zeta_bilateral(e) == pytest.approx(bilateral, rel=1e-13)


@pytest.mark.skipif(not REFERENCE.exists(), reason="needs ../shared: restitution_inverse.json")
def test_damping_ratios_agree_with_25_digits():
    for case in json.loads(REFERENCE.read_text())["cases"]:
        e, expected = case["params"]["e_target"], case["expected"]
        assert zeta_clamped(e) == pytest.approx(expected["zeta_clamped"], rel=2e-15)
        assert zeta_bilateral(e) == pytest.approx(expected["zeta_bilateral"], rel=2e-15)


def test_clamped_damping_ratio_is_exact_over_its_whole_range():
    for u in (1e-12, 1e-3, 0.3, 0.5, 1.0, 1.4, 1.57):
        e = exp(-(pi - 2.0 * u) * np.tan(u))
        assert zeta_clamped(e) == pytest.approx(sin(u), rel=1e-12, abs=1e-16)
    assert zeta_clamped(1e-150) * 2.0 * sqrt(1e-150) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("e", [0.0, -0.1, 1.1, float("nan")])
def test_impossible_restitution_is_refused(e):
    with pytest.raises(ValueError, match="must lie in"):
        zeta_clamped(e)


def test_the_bound_of_one_central_contact_counts_it_as_between_two_that_move():
    square = block_bound(
        2.0, np.ones(3), np.array([[0.1, 0, 0]]), np.array([[1.0, 0, 0]]), (5.0, 0.0, 0.0)
    )
    assert square == pytest.approx(2.0 * 5.0 / 2.0, rel=1e-14)


def test_rolling_stiffness_acts_on_the_turn_alone():
    square = block_bound(
        1e9, np.array([1.0, 2.0, 4.0]), np.zeros((3, 3)), np.eye(3), (1.0, 0.0, 5.0)
    )
    assert square == pytest.approx(2.0 * 3 * 5.0 / 1.0, rel=1e-14)


def test_the_bound_is_never_below_the_highest_frequency_of_an_assembly():
    """Random bodies, random contacts between them: the exact eigenvalue against the bound."""
    dice = np.random.default_rng(3)
    kn, kt, kr = 7.0, 4.0, 0.3
    for _ in range(20):
        count = 4
        mass, inertia = dice.uniform(0.5, 2.0, count), dice.uniform(0.1, 1.0, (count, 3))
        contacts = [
            (*dice.permutation(count)[:2], dice.normal(size=3), dice.normal(size=(2, 3)))
            for _ in range(12)
        ]
        stiffness = np.zeros((6 * count, 6 * count))
        own = [([], []) for _ in range(count)]
        for i, j, n, arms in contacts:
            normal = n / np.linalg.norm(n)
            slide, turn = np.zeros((3, 6 * count)), np.zeros((3, 6 * count))
            for body, arm, sign in ((i, arms[0], -1.0), (j, arms[1], 1.0)):
                x, y, z = arm
                cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                slide[:, 6 * body : 6 * body + 6] = sign * np.hstack([np.eye(3), -cross])
                turn[:, 6 * body + 3 : 6 * body + 6] = sign * np.eye(3)
                own[body][0].append(arm)
                own[body][1].append(normal)
            block = kn * np.outer(normal, normal) + kt * (np.eye(3) - np.outer(normal, normal))
            stiffness += slide.T @ block @ slide + kr * turn.T @ turn
        pairs = list(zip(mass, inertia, strict=True))
        scale = 1.0 / np.sqrt(np.concatenate([[*[m] * 3, *t] for m, t in pairs]))
        exact = np.linalg.eigvalsh(scale[:, None] * stiffness * scale)[-1]
        bound = max(
            block_bound(m, t, np.array(arms), np.array(normals), (kn, kt, kr))
            for m, t, (arms, normals) in zip(mass, inertia, own, strict=True)
            if arms
        )
        assert exact <= bound * (1.0 + 1e-12)
        assert exact > 0.3 * bound


def test_balls_step_at_a_twentieth_of_the_stiffest_contact():
    step = step_of(BALLS.format(run="seed = 0"))
    assert step.chosen
    assert step.contact_time == pytest.approx(pi * sqrt(EFFECTIVE / 1e6), rel=1e-12)
    assert 0.98 < step.dt * 20 / step.contact_time <= 1.0
    assert not step.message


def test_a_chosen_step_divides_the_time_between_frames():
    step = step_of(BALLS.format(run="seed = 0"))
    count = (1.0 / 50) / step.dt
    assert count == pytest.approx(round(count), abs=1e-9)


def test_a_given_step_beyond_a_single_contact_is_refused_with_both_numbers():
    limit = single_contact_limit(1e6, EFFECTIVE)
    assert limit == pytest.approx(2.0 / pi * contact_time(1e6, EFFECTIVE), rel=1e-15)
    assert step_of(BALLS.format(run=f"dt = {0.99 * limit}")).dt == 0.99 * limit
    with pytest.raises(SceneError) as caught:
        step_of(BALLS.format(run=f"dt = {1.01 * limit:.4g}"))
    (problem,) = caught.value.problems
    assert problem.key == f"run.dt = {1.01 * limit:.4g}"
    assert f"less than {limit:.4g} s" in problem.message


def test_a_given_step_beyond_the_bound_is_warned_of_with_both_numbers():
    bound = step_of(BALLS.format(run="seed = 0")).bound
    step = step_of(BALLS.format(run=f"dt = {1.1 * bound}"))
    assert f"{1.1 * bound:.4g} s is above the stability bound {bound:.4g} s" in step.message
    assert not step_of(BALLS.format(run=f"dt = {0.9 * bound}")).message


def test_lagged_dashpots_lower_the_bound():
    predicted = step_of(BALLS.format(run="seed = 0")).bound
    lagged = step_of(BALLS.format(run='contact_update = "lagged"')).bound
    zeta = zeta_clamped(0.5)
    assert lagged == pytest.approx(predicted * (sqrt(1.0 + zeta * zeta) - zeta), rel=1e-12)


def test_the_bound_goes_with_the_smallest_body():
    small = BALLS.format(run="seed = 0").replace("scale = 2.0", "scale = 0.5")
    ratio = step_of(small).bound / step_of(BALLS.format(run="seed = 0")).bound
    assert ratio == pytest.approx(0.5**1.5, rel=1e-12)


def test_without_contacts_frames_and_motion_decide():
    text = """
    run = {duration = 1.0}
    gravity = {vector = [0, 0, 0]}
    shape = [{kind = "box", name = "b", size = [1, 2, 3]}]
    body = [{shape = "b", position = [0, 0, 0], density = 1.0, %s}]
    contact = [{groups = ["default", "default"], kn = 1e6, kt = 1e6, en2 = 0.25, mu = 0.5}]
    """
    step = step_of(text % "scale = 1.0")
    assert (step.dt, step.bound, step.contact_time) == (1.0 / 50, np.inf, np.inf)
    assert step_of(text % "spin = [0, 0, 10]").dt == pytest.approx(0.01)
    assert step_of(text % "velocity = [0, 0, 1000]").dt < 1e-3
    assert step_of(text.replace("0, 0]}", "0, -1000]}") % "scale = 1.0").dt < 1e-3


def test_a_cube_is_loaded_on_every_corner_twice():
    box = {"kind": "box", "name": "b", "size": [1, 1, 1], "rounding": 0.1}
    scene = Scene(run={"duration": 1.0}, shape=[box])
    arms, normals, share = loaded_points(build_shapes(scene)["b"])
    assert len(arms) == 8
    assert share == 2.0
    assert np.linalg.norm(arms, axis=1) == pytest.approx(0.4 * sqrt(3.0) + 0.1)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)


def test_a_drum_is_loaded_on_two_faces_and_a_gem_on_eight_corners():
    ring = [[cos(2 * pi * k / 30), sin(2 * pi * k / 30)] for k in range(30)]
    after = [(k + 1) % 30 for k in range(30)]
    drum = {
        "kind": "polyhedron",
        "name": "drum",
        "vertices": [[*p, z] for z in (0.0, 1.0) for p in ring],
        "faces": [
            list(range(30, 60)),
            list(range(29, -1, -1)),
            *([k, after[k], 30 + after[k], 30 + k] for k in range(30)),
        ],
        "rounding": 0.05,
    }
    gem = {
        "kind": "polyhedron",
        "name": "gem",
        "vertices": [*([*p, 0.0] for p in ring), [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]],
        "faces": [tip for k in range(30) for tip in ([k, after[k], 30], [after[k], k, 31])],
        "rounding": 0.05,
    }
    polyhedra = build_shapes(Scene(run={"duration": 1.0}, shape=[drum, gem]))
    assert loaded_points(polyhedra["drum"])[2] == 2.0
    assert loaded_points(polyhedra["gem"])[2] == 2.0 * 8 / 32


def test_masses_beyond_the_range_of_numbers_are_refused():
    text = BALLS.format(run="seed = 0").replace("radius = 0.1", "radius = 1e-30")
    text = text.replace("density = 1000.0,", "density = 1e-30,")
    with pytest.raises(SceneError, match="look at the unit"):
        step_of(text.replace("scale = 2.0", "scale = 1e-30"))
