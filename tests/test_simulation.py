"""The clock of a simulation, its step, and what it says when it cannot go on."""

import numpy as np
import pytest
from colliding import FLOOR, LAW, heap, run, same, scene, strips
from warpdem.kernels.forces import pair_forces

from warpdem.checks.timestep import masses
from warpdem.errors import UnstableError, WarpdemError
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

STATIC = {"shape": "cube", "position": [0.0, 0.0, 0.499975]}
"""A cube that rests on the floor."""


def start(bodies, **keys):
    return Simulation(scene(bodies, **keys), device="cpu", threads=1)


def brush(count=10):
    """A body of many points that no face tells of, so that no step foresees them."""
    x = np.linspace(-0.5, 0.5, count)
    return {
        "kind": "polyhedron",
        "name": "brush",
        "vertices": [[a, b, 0.0] for a in x for b in x],
        "rounding": 0.05,
        "volume": 1.0,
        "inertia_over_mass": [0.1, 0.1, 0.15],
    }


def test_one_free_body_falls_along_a_parabola():
    body = {"shape": "cube", "position": [0.0, 0.0, 1.0], "velocity": [1.0, 2.0, 3.0]}
    now = run([{**body, "spin": [0.0, 0.0, 0.5]}], 1.0).snapshot()
    assert now.position[0] == pytest.approx([1.0, 2.0, 4.0 - 0.5 * 9.81], rel=1e-12)
    assert now.velocity[0] == pytest.approx([1.0, 2.0, 3.0 - 9.81], rel=1e-12)
    assert now.orientation[0] == pytest.approx([np.cos(0.25), 0.0, 0.0, np.sin(0.25)], rel=1e-12)
    assert abs(now.energy.balance) < 1e-11


def test_fixed_bodies_alone_stay_and_driven_ones_move():
    still = run([FLOOR, {**FLOOR, "position": [0.0, 0.0, 5.0]}], 1.0).snapshot()
    assert still.position == pytest.approx(np.array([[0.0, 0.0, -2.0], [0.0, 0.0, 5.0]]), abs=0.0)
    moved = run([{**FLOOR, "velocity": [1.0, 0.0, 0.0], "spin": [0.0, 0.0, 2.0]}], 1.0).snapshot()
    assert moved.position[0] == pytest.approx([1.0, 0.0, -2.0], rel=1e-12)
    assert moved.orientation[0] == pytest.approx([np.cos(1.0), 0.0, 0.0, np.sin(1.0)], rel=1e-9)


def test_a_second_simulation_of_the_same_laws_composes_no_pair_kernel():
    run([STATIC, FLOOR], 1e-3)
    composed = pair_forces.cache_info().misses
    run([STATIC, FLOOR], 1e-3)
    assert composed > 0
    assert pair_forces.cache_info().misses == composed


def test_scene_without_bodies_runs():
    empty = Scene.model_validate({"run": {"duration": 1.0, "dt": 0.1}})
    simulation = Simulation(empty, device="cpu", threads=1)
    simulation.advance(0.5)
    simulation.restore(simulation.checkpoint())
    simulation.advance(1.0)
    assert simulation.step_count == 10
    assert simulation.snapshot(contacts=True).position.shape == (0, 3)


def test_free_flight_goes_on_from_a_checkpoint():
    body = {"shape": "brick", "position": [0.0, 0.0, 1.0], "spin": [1.0, 2.0, 3.0]}
    whole, first, resumed = run([body], 1.0), run([body], 0.4), start([body])
    resumed.restore(first.checkpoint())
    resumed.advance(1.0)
    assert same(whole, resumed)
    assert resumed.report()["rebuilds"] == 0


def test_clock_counts_whole_steps_and_stops_nearest():
    simulation = start([STATIC, FLOOR], dt=1e-3)
    simulation.advance(0.0104)
    assert simulation.step_count == 10
    simulation.advance(0.0104)
    assert simulation.step_count == 10
    simulation.advance(0.0106)
    assert simulation.time == pytest.approx(0.011, rel=1e-12)


def test_run_stops_when_asked():
    simulation = start([STATIC, FLOOR])
    simulation.advance(10.0, stop=lambda: simulation.step_count >= 7)
    assert 7 <= simulation.step_count < 20
    simulation.advance(10.0, stop=lambda: True)
    assert simulation.step_count < 20


def test_resting_cube_shows_its_weight_on_four_vertices():
    simulation = run([STATIC, FLOOR], 0.2)
    now = simulation.snapshot(contacts=True)
    weight = masses(simulation.placement, simulation.polyhedra)[0][0] * 9.81
    assert now.contacts.normal_force == pytest.approx(np.full(4, weight / 4.0), rel=1e-6)
    assert now.contacts.gap == pytest.approx(np.full(4, -weight / 4.0 / LAW["kn"]), rel=1e-6)
    assert now.contacts.point[:, 2] == pytest.approx(np.full(4, 0.0), abs=1e-4)
    assert now.contacts.kind.tolist() == [3] * 4
    assert now.force[1] == pytest.approx([0.0, 0.0, -weight], rel=1e-6, abs=1e-12)
    assert now.energy.contact_count == 4


def test_snapshot_after_a_restore_is_that_of_the_checkpoint():
    simulation = run(heap(1, 5), 0.6)
    before = simulation.snapshot(contacts=True)
    assert len(before.contacts.gap) > 0
    resumed = start(heap(1, 5))
    resumed.restore(simulation.checkpoint())
    after = resumed.snapshot(contacts=True)
    assert after.energy == before.energy
    for name in vars(before.contacts):
        assert np.array_equal(getattr(after.contacts, name), getattr(before.contacts, name)), name
    for name in ("time", "position", "velocity", "spin", "force", "torque"):
        assert np.array_equal(getattr(after, name), getattr(before, name)), name
    assert resumed.step_bound() == simulation.step_bound()


def test_step_bound_of_a_cube_on_a_plane():
    simulation = run([STATIC, FLOOR], 0.2)
    mass, moment = masses(simulation.placement, simulation.polyhedra)
    m, i = mass[0], moment[0, 0]
    kn, kt, kr = (LAW[key] for key in ("kn", "kt", "kr"))
    h, z = 0.45, 0.5  # arms of the four contacts, across and down
    rock = np.array(
        [
            [4.0 * kt / m, 4.0 * kt * z / np.sqrt(m * i)],
            [4.0 * kt * z / np.sqrt(m * i), 4.0 * (kn * h**2 + kt * z**2 + kr) / i],
        ]
    )
    modes = [4.0 * kn / m, 4.0 * (2.0 * kt * h**2 + kr) / i, *2 * [*np.linalg.eigvalsh(rock)]]
    exact = 2.0 / np.sqrt(max(modes))
    above = np.sum(np.array(modes) ** 8) ** (1.0 / 8.0)  # of the largest one
    assert simulation.step_bound() == pytest.approx(2.0 / np.sqrt(above), rel=1e-4)
    assert 0.88 * exact < simulation.step_bound() <= exact


def test_automatic_step_is_lowered_at_once_where_the_start_asks_for_it():
    resting = {"shape": "brush", "position": [0.0, 0.0, 0.0499]}
    simulation = start([resting, FLOOR], shapes=[brush()], dt="auto")
    assert simulation.dt <= 0.5 * simulation.step_bound()
    assert "dt lowered" in simulation.notes[-1]
    assert "t = 0 s" in simulation.notes[-1]


def test_automatic_step_is_halved_when_contacts_ask_for_it():
    landing = {"shape": "brush", "position": [0.0, 0.0, 0.051], "velocity": [3.0, 0.0, 0.0]}
    simulation = start([landing, FLOOR], shapes=[brush()], dt="auto")
    first = simulation.dt
    simulation.advance(0.1)
    assert simulation.dt == 0.5 * first
    assert simulation.dt <= 0.5 * simulation.step_bound()
    assert "dt lowered" in simulation.notes[-1]
    assert simulation.time == pytest.approx(0.1, abs=simulation.dt)
    resumed = start([landing, FLOOR], shapes=[brush()], dt="auto")
    resumed.restore(simulation.checkpoint())
    assert resumed.dt == simulation.dt
    assert resumed.time == simulation.time


def test_given_step_above_the_bound_of_the_contacts_is_told_with_both_numbers():
    simulation = start([STATIC, FLOOR], dt=3e-3)
    assert simulation.dt == 3e-3
    assert (
        f"dt = 0.003 s is above the stability bound {simulation.step_bound():.4g} s"
        in (simulation.notes[-1])
    )


def test_unstable_step_names_body_and_time():
    ceiling = {**FLOOR, "position": [0.0, 0.0, 2.999]}
    simulation = start([{**STATIC, "name": "victim"}, FLOOR, ceiling], dt=4.4e-3)
    with pytest.raises(UnstableError, match="victim") as caught:
        simulation.advance(3.0)
    assert caught.value.body == "victim"
    assert caught.value.exit_code == 3
    assert 0.0 < caught.value.time < 1.0
    assert f"t = {caught.value.time:.9g} s" in str(caught.value)


def test_body_too_fast_for_its_step_is_named_before_it_jumps_through_a_wall():
    bullet = {"shape": "cube", "name": "bullet", "position": [0.0, 0.0, 9.0]}
    with pytest.raises(UnstableError, match="bullet") as caught:
        start([{**bullet, "velocity": [0.0, 0.0, -1e4]}, FLOOR], dt=1e-3)
    assert caught.value.time == 0.0
    away = start([{**bullet, "velocity": [0.0, 0.0, -1e4]}, FLOOR], dt=2e-4)
    with pytest.raises(UnstableError, match=r'"bullet" moves 2\.\d* times its own size'):
        away.advance(1.0)


@pytest.mark.parametrize("name", ["cuda:99", "tpu"])
def test_unknown_device_is_told_with_those_there_are(name):
    with pytest.raises(WarpdemError, match=f'run.device = "{name}".*there are: .*cpu'):
        Simulation(scene([FLOOR]), device=name)


def test_report_tells_what_was_built_and_done():
    simulation = run(heap(1, 3), 0.2)
    report = simulation.report()
    assert report["bodies"] == 4
    assert report["steps"] == 400
    assert report["device"] == "cpu"
    assert report["threads"] == 1
    assert report["rebuilds"] > 0
    assert {"contacts", "friction", "rolling"} <= {*report["features"]}
    assert report["loop_seconds"] > 0.0


def test_block_rebounds_alike_from_a_box_and_from_a_plane_of_facets():
    block = {
        "shape": "brick",
        "position": [0.0, 0.0, 0.8],
        "velocity": [1.0, 0.2, -3.0],
        "orientation": [0.8, 0.6, 0.0, 0.0],
        "spin": [1.0, 2.0, 3.0],
    }
    plane = {"shape": "strips", "position": [0.0, 0.0, 0.0], "fixed": True}
    whole = run([block, FLOOR], 0.5).snapshot()
    cut = run([block, plane], 0.5, shapes=[strips()]).snapshot()
    assert whole.energy.dashpot > 1.0
    for name in ("position", "velocity", "spin"):
        assert getattr(whole, name)[0] == pytest.approx(getattr(cut, name)[0], rel=1e-9, abs=1e-9)
