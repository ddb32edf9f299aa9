"""A step that changes by powers of two: what it saves, and that it costs no accuracy."""

import numpy as np
import pytest
from colliding import FLOOR, heap, same, scene

from warpdem.errors import SceneError
from warpdem.input import decode
from warpdem.input.scene import Scene
from warpdem.pacing import EVERY
from warpdem.simulation import Simulation

BALL = {"shape": "ball", "position": [0.0, 0.0, 4.0], "velocity": [0.5, 0.0, 0.0]}


def start(bodies, *, adaptive=True, threads=1, **keys):
    keys = {"dt": "auto", "adaptive_dt": adaptive, **keys}
    return Simulation(scene(bodies, **keys), device="cpu", threads=threads)


def bounce(until, *, adaptive, **keys):
    simulation = start([BALL, FLOOR], adaptive=adaptive, law={"en2": 0.8}, **keys)
    simulation.advance(until)
    return simulation


def column(*, adaptive):
    """Balls that fall on a floor and each other exactly in line, and come to rest."""
    balls = [{"shape": "ball", "position": [0.0, 0.0, 2.0 + 1.3 * k]} for k in range(6)]
    return start([*balls, FLOOR], adaptive=adaptive, law={"en2": 0.04})


def test_a_bouncing_ball_takes_a_quarter_of_the_steps_to_the_same_place():
    fixed, adaptive = (bounce(6.0, adaptive=which) for which in (False, True))
    assert adaptive.step_count < 0.25 * fixed.step_count
    one, other = fixed.snapshot(), adaptive.snapshot()
    assert other.position[0] == pytest.approx(one.position[0], abs=1e-4)
    assert other.velocity[0] == pytest.approx(one.velocity[0], abs=1e-4)
    assert other.energy.dashpot == pytest.approx(one.energy.dashpot, rel=1e-5)
    assert other.energy.friction == pytest.approx(one.energy.friction, rel=1e-3)
    assert other.energy.balance == pytest.approx(one.energy.balance, abs=1e-4)


def test_nothing_touches_in_a_longer_step():
    simulation = start([BALL, FLOOR], law={"en2": 0.8})
    base = simulation._pacing._base
    touched, longer = 0, 0
    while simulation.time < 2.0:
        before = simulation.dt
        simulation.advance(simulation.time + simulation.dt)
        touching = bool(simulation._lists.pairs.touching.numpy()[:1].sum())
        touched += touching
        longer += before > base
        assert not (touching and before > base)
    assert touched > 10
    assert longer > 100


def test_a_column_comes_to_rest_in_fewer_steps_at_the_same_place():
    fixed, adaptive = (column(adaptive=which) for which in (False, True))
    for simulation in (fixed, adaptive):
        simulation.advance(6.0)
    assert adaptive.step_count < 0.7 * fixed.step_count
    one, other = fixed.snapshot(contacts=True), adaptive.snapshot(contacts=True)
    assert np.abs(other.position - one.position).max() < 1e-8
    assert max(one.energy.kinetic, other.energy.kinetic) < 1e-12
    assert other.contacts.normal_force == pytest.approx(one.contacts.normal_force, rel=1e-6)
    assert other.energy.dashpot == pytest.approx(one.energy.dashpot, rel=1e-3)


def test_a_run_with_an_adaptive_step_goes_on_from_a_checkpoint_bitwise():
    for until in (0.2, 0.7, 1.1):  # in flight, and as they land
        whole, first, resumed = (start(heap(3, 4)) for _ in range(3))
        first.advance(until)
        resumed.restore(first.checkpoint())
        for simulation in (whole, first, resumed):
            simulation.advance(1.5)
        assert resumed.dt == whole.dt
        assert resumed.time == whole.time
        assert same(first, resumed)


def test_where_a_run_pauses_does_not_change_its_steps():
    whole, paused = start(heap(3, 4)), start(heap(3, 4))
    for time in np.linspace(0.05, 1.5, 30):
        paused.advance(time)
    whole.advance(paused.time)
    assert whole.step_count == paused.step_count
    assert whole.step_count > EVERY
    assert same(whole, paused)


def test_times_asked_for_are_met_within_half_a_step():
    simulation = start([BALL, FLOOR])
    for until in np.linspace(0.03, 1.2, 14):
        simulation.advance(until)
        assert abs(simulation.time - until) <= 0.5 * simulation.dt * (1.0 + 1e-9)


def test_a_given_step_is_that_of_contacts_and_grows_beyond_them():
    simulation = start([BALL, FLOOR], dt=1e-4)
    simulation.advance(0.3)
    assert simulation.dt > 1e-4
    assert np.log2(simulation.dt / 1e-4) % 1.0 == 0.0


TEXT = """
run = {duration = 1.0, dt = 1e-4, adaptive_dt = true}
shape = [{kind = "sphere", name = "ball", radius = 0.1}]
body = [{shape = "ball", position = [0, 0, 0], density = 1.0}]
contact = [{groups = ["default", "default"], kn = 1e6, kt = 1e6, en2 = 0.25, mu = 0.5}]
"""


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("cell = {size = [1.0, 1.0, 1.0]}", r"not with \[cell\]"),
        ('force = [{kind = "drag"}]', r"not with \[\[force\]\]"),
    ],
)
def test_a_step_adapts_only_where_contacts_alone_bound_it(more, words):
    with pytest.raises(SceneError, match=words):
        decode.loads(TEXT + more)
    with pytest.raises(SceneError, match=r"run\.compat has one step"):
        decode.loads(TEXT, overrides=['run.compat="rockable"'])


def test_a_step_that_adapts_is_for_the_smooth_method_alone():
    text = TEXT.replace("duration = 1.0", 'duration = 1.0, method = "nonsmooth"')
    with pytest.raises(SceneError, match=r'adaptive_dt = true: only with run\.method = "smooth"'):
        decode.loads(text)


def test_a_scene_without_contacts_runs_with_an_adaptive_step():
    text = {"run": {"duration": 1.0, "dt": 0.01, "adaptive_dt": True}}
    simulation = Simulation(Scene.model_validate(text), device="cpu", threads=1)
    simulation.advance(1.0)
    assert simulation.step_count == 100
