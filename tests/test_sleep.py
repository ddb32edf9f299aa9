"""Bodies at rest that sleep: who does, what wakes them, and what is neglected."""

import numpy as np
import pytest
from colliding import FLOOR, LAW, run, same, scene

import warpdem.simulation
from warpdem.errors import SceneError
from warpdem.input import decode
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation
from warpdem.sleeping import EVERY

DT = 5e-4
"""Of these scenes [s]."""
SLEEP = {"speed": 0.01, "after": 0.1, "tolerance": 0.02}
STEEP, GENTLE = 0.45, 0.35
"""Slopes on either side of the friction, 0.4."""
SINK = 9.81 / (4.0 * LAW["kn"])
"""How far four corners sink under a cube of mass 1 [m]."""
HIT = 0.9
"""When the ball that is let go has hit the pile [s]."""


def columns():
    """Three columns of two cubes each that stand apart, in equilibrium but for rounding."""
    return [
        {"shape": "cube", "position": [1.5 * k, 0.0, 0.5 + level * (1.0 - SINK) - 2 * SINK]}
        for k in range(3)
        for level in range(2)
    ]


def pyramid():
    """Cubes of which each upper one stands on two."""
    places = [(-1.05, 0.0), (0.0, 0.0), (1.05, 0.0), (-0.525, 1.0), (0.525, 1.0), (0.0, 2.0)]
    return [{"shape": "cube", "position": [x, 0.0, 0.5 + z]} for x, z in places]


def balls():
    """Four balls with a fifth on top of them in a box of planes."""
    ring = [[x, y, 0.5] for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    free = [{"shape": "ball", "position": place} for place in [*ring, [0.0, 0.0, 1.207]]]
    h = np.sqrt(0.5)
    walls = {
        (0.0, 0.0, 0.0): [1.0, 0.0, 0.0, 0.0],
        (-1.0, 0.0, 0.0): [h, 0.0, h, 0.0],
        (1.0, 0.0, 0.0): [h, 0.0, -h, 0.0],
        (0.0, -1.0, 0.0): [h, -h, 0.0, 0.0],
        (0.0, 1.0, 0.0): [h, h, 0.0, 0.0],
    }
    fixed = [
        {"shape": "plane", "position": place, "orientation": turn, "fixed": True}
        for place, turn in walls.items()
    ]
    return free, fixed


def dropped(place):
    """A ball that falls on what lies below ``place``."""
    return {"shape": "ball", "position": place, "density": 2.0}


PLANE = {"kind": "plane", "name": "plane"}
FREE_BALLS, BOX = balls()
PILES = {
    "cubes": [*pyramid(), dropped([0.1, 0.1, 6.0]), FLOOR],
    "balls": [*FREE_BALLS, dropped([0.1, 0.1, 4.5]), *BOX],
}


@pytest.fixture(params=sorted(PILES))
def pile(request):
    """A pile, the ball that will fall on it, and what is fixed."""
    return PILES[request.param]


def sleeping(bodies, until, **keys):
    return run(bodies, until, **{"shapes": [PLANE], "sleep": SLEEP, **keys})


def waking(bodies, until, **keys):
    return run(bodies, until, shapes=[PLANE], **keys)


def asleep(simulation):
    return simulation.report()["asleep"]


def test_a_pile_at_rest_falls_asleep_and_does_not_move():
    simulation = sleeping([*columns(), FLOOR], 0.5)
    assert asleep(simulation) == 6
    before = simulation.snapshot(contacts=True)
    assert before.energy.kinetic == 0.0
    simulation.advance(1.0)
    after = simulation.snapshot(contacts=True)
    assert np.array_equal(after.position, before.position)
    assert np.array_equal(after.contacts.normal_force, before.contacts.normal_force)
    assert simulation.report()["woken"] == 0
    assert after.energy == before.energy


def test_a_sleeping_pile_lies_where_one_without_sleep_does():
    lying, moving = (
        make([*columns(), FLOOR], 0.8).snapshot(contacts=True) for make in (sleeping, waking)
    )
    assert np.abs(lying.position - moving.position).max() < 1e-6
    weight = moving.contacts.normal_force.sum()
    assert lying.contacts.normal_force.sum() == pytest.approx(weight, rel=1e-2)
    assert lying.force[-1] == pytest.approx(moving.force[-1], rel=1e-2, abs=0.1)


def test_a_ball_wakes_the_column_that_it_hits_and_no_other():
    simulation = sleeping([*columns(), dropped([1.6, 0.0, 4.0]), FLOOR], 0.5)
    assert asleep(simulation) == 6
    before = simulation.snapshot().position
    simulation.advance(HIT - 0.2)
    assert simulation.report()["woken"] == 2
    moved = np.abs(simulation.snapshot().position - before).max(axis=1) > 0.0
    assert moved.tolist() == [False, False, True, True, False, False, True, False]


def test_a_hit_pile_comes_to_rest_where_it_does_without_sleep():
    bodies = [*columns(), dropped([1.5, 0.0, 2.8]), FLOOR]
    lying, moving = (make(bodies, 3.0, dt=2.5e-4) for make in (sleeping, waking))
    assert asleep(lying) == 7
    assert lying.report()["woken"] > 0
    one, other = lying.snapshot(), moving.snapshot()
    # a hundred-thousandth of a cube
    assert np.abs(one.position[:-1, 2] - other.position[:-1, 2]).max() < 1e-5
    assert one.energy.potential == pytest.approx(other.energy.potential, rel=1e-5)
    assert one.energy.friction + one.energy.dashpot == pytest.approx(
        other.energy.friction + other.energy.dashpot, rel=1e-3
    )


def test_falling_asleep_makes_motion_a_loss_and_leaves_the_account_closed(pile):
    restless = {"speed": 0.04, "after": 0.1, "tolerance": 0.5}
    lying = sleeping(pile, EVERY * DT, sleep=restless)
    while not asleep(lying):
        lying.advance(lying.time + EVERY * DT)
    moving = waking(pile, lying.time)
    one, other = lying.snapshot(), moving.snapshot()
    taken = lying.report()["energy_taken_by_sleep"]
    assert np.array_equal(one.position, other.position)
    assert taken > 1e-12
    assert one.energy.kinetic == pytest.approx(other.energy.kinetic - taken, abs=1e-12)
    assert one.energy.dashpot == pytest.approx(other.energy.dashpot + taken, abs=1e-12)
    assert one.energy.balance == pytest.approx(other.energy.balance, abs=1e-12)


def test_account_closes_as_well_with_sleep_as_without(pile):
    lying, moving = (make(pile, 2.5).snapshot().energy for make in (sleeping, waking))
    turned_over = moving.dashpot + moving.friction
    assert turned_over > 1.0
    assert abs(lying.balance) < abs(moving.balance) + 1e-3 * turned_over


def test_a_block_on_a_slope_sleeps_only_below_its_friction_angle():
    block = [{"shape": "cube", "position": [0.0, 0.0, 0.5 - SINK]}, FLOOR]
    for slope, sleeps in ((STEEP, False), (GENTLE, True)):
        down = 9.81 * np.array([slope, 0.0, -1.0]) / np.hypot(slope, 1.0)
        lying, moving = (make(block, 1.5, gravity=down) for make in (sleeping, waking))
        assert asleep(lying) == sleeps
        assert lying.report()["woken"] == 0
        assert same(lying, moving) is not sleeps
        assert (moving.snapshot().position[0, 0] > 0.3) is not sleeps


@pytest.mark.parametrize("motion", [(0.0, 0.0, -1.0), (0.5, 0.0, 0.0)])
def test_a_support_that_moves_wakes_what_stands_on_it(motion):
    base = scene([*columns(), {**FLOOR, "name": "table"}], sleep=SLEEP).model_dump()
    base["driver"] = [{"kind": "constant", "bodies": ["table"], "velocity": motion, "start": 0.6}]
    simulation = Simulation(Scene.model_validate(base), device="cpu", threads=1)
    simulation.advance(0.59)
    assert asleep(simulation) == 6
    start = simulation.snapshot().position
    simulation.advance(0.9)
    assert asleep(simulation) == 0
    went = (simulation.snapshot().position - start)[:6] @ np.array(motion)
    assert (went > 0.02).all()


def test_a_run_with_sleepers_goes_on_bitwise_from_a_checkpoint(pile):
    until = 1.3
    whole = sleeping(pile, until)
    for pause in (0.5, HIT):
        first = sleeping(pile, pause)
        resumed = Simulation(first.scene, device="cpu", threads=1)
        resumed.restore(first.checkpoint())
        assert asleep(resumed) == asleep(first)
        before, after = first.snapshot(), resumed.snapshot()
        assert before.energy == after.energy
        first.advance(until)
        resumed.advance(until)
        for simulation in (first, resumed):
            assert same(simulation, whole)
            assert simulation.snapshot().energy == whole.snapshot().energy
            for key in ("asleep", "woken", "energy_taken_by_sleep"):
                assert simulation.report()[key] == whole.report()[key]
    assert whole.report()["woken"] > 0


def test_threads_do_not_change_a_bit_of_a_run_with_sleepers(pile, monkeypatch):
    monkeypatch.setattr(warpdem.simulation, "CREW_BODIES", 2)
    monkeypatch.setattr(warpdem.simulation.os, "cpu_count", lambda: 2)
    monkeypatch.setattr("warpdem.crews.WORTH", 1e9)  # two, though one be faster
    alone, together = (sleeping(pile, HIT + 0.2, threads=threads) for threads in (1, 2))
    assert together.report()["threads"] == 2
    assert same(alone, together)
    assert alone.snapshot().energy == together.snapshot().energy
    assert alone.report()["woken"] == together.report()["woken"] > 0


def test_lists_made_anew_do_not_change_a_bit_of_a_run_with_sleepers(pile):
    often, seldom = (sleeping(pile, HIT + 0.2, skin=skin) for skin in (0.02, 3.0))
    assert often.report()["rebuilds"] > 2 * seldom.report()["rebuilds"]
    assert same(often, seldom)
    assert often.report()["woken"] == seldom.report()["woken"] > 0


def test_a_scene_that_lets_nobody_sleep_has_nothing_of_it():
    simulation = waking([*columns(), FLOOR], 0.01)
    assert not simulation.features.sleeps
    assert simulation._state.bodies.sleep.asleep is None
    assert not [key for key in simulation.checkpoint() if "sleep" in key]
    assert "asleep" not in simulation.report()
    assert not simulation.notes


def test_what_is_neglected_is_said():
    simulation = sleeping([*columns(), FLOOR], 0.01)
    assert any("motion below 0.01 m/s that lasts 0.1 s" in note for note in simulation.notes)


TEXT = """
run = {duration = 1.0, sleep = {speed = 0.001, after = 0.05}}
shape = [{kind = "sphere", name = "ball", radius = 0.5}]
body = [{shape = "ball", position = [0.0, 0.0, 0.0], density = 1.0}]
"""


@pytest.mark.parametrize(
    ("override", "rule"),
    [
        ("run.sleep.speed=0.1", "would sleep: at most 0.0245"),
        ("run.method=nonsmooth", 'only with run.method = "smooth"'),
        ("cell={periodic=[true,true,true],size=[2.0,2.0,2.0]}", "not in a periodic cell"),
        ("bond=[{}]", "not with bonds"),
    ],
)
def test_sleep_is_refused_where_it_would_be_wrong(override, rule):
    assert decode.loads(TEXT).run.sleep.tolerance == 0.01
    with pytest.raises(SceneError, match=rule):
        decode.loads(TEXT, overrides=[override])
