"""What must not change a run: its frame, the order of its bodies, its lists, threads and pauses."""

import numpy as np
import pytest
from colliding import FLOOR, NO_FRICTION, heap, momenta, run, same, scene, strips, swarm, unit

import warpdem.simulation
from warpdem.checks.timestep import masses
from warpdem.geometry.orientation import product, turned
from warpdem.simulation import Simulation

WEIGHTLESS = (0.0, 0.0, 0.0)
UNTIL = 0.6
"""Of a heap [s]: its lower bodies have hit the floor and each other."""


def start(bodies, **keys):
    return Simulation(scene(bodies, **keys), device="cpu", threads=1)


@pytest.mark.parametrize("seed", [0, 1])
def test_collisions_of_free_bodies_conserve_momentum_to_rounding(seed):
    simulation = start(swarm(seed), gravity=WEIGHTLESS)
    size = np.abs(simulation.placement.velocity).sum()
    before = momenta(simulation)
    simulation.advance(0.8)
    assert simulation.snapshot().energy.friction > 1.0  # they did collide
    for old, new in zip(before, momenta(simulation), strict=True):
        assert np.abs(new - old).max() <= 1e-14 * size * np.sqrt(simulation.step_count)


def test_two_host_threads_give_bitwise_the_result_of_one(monkeypatch):
    monkeypatch.setattr(warpdem.simulation, "CREW_BODIES", 2)
    monkeypatch.setattr("warpdem.crews.WORTH", 1e9)  # two, though one be faster
    monkeypatch.setattr(warpdem.simulation.os, "cpu_count", lambda: 2)
    alone, together = (run(heap(1, 5), UNTIL, threads=threads) for threads in (1, 2))
    assert together.report()["cycles_by_threads"][2] > 0
    assert alone.snapshot().energy.contact_count > 0
    assert same(alone, together)
    assert alone.snapshot().energy == together.snapshot().energy


def test_run_goes_on_bitwise_from_a_checkpoint():
    later = UNTIL + 0.2
    whole = run(heap(1, 5), later)
    first = run(heap(1, 5), UNTIL)
    saved = first.checkpoint()
    assert len(saved["contact_code"]) > 0
    resumed = start(heap(1, 5))
    resumed.restore(saved)
    resumed.advance(later)
    first.advance(later)  # a checkpoint leaves no trace
    for simulation in (first, resumed):
        assert same(simulation, whole)
        assert simulation.time == whole.time
        assert simulation.step_count == whole.step_count
        assert simulation.snapshot().energy == whole.snapshot().energy


def test_two_runs_in_one_process_are_bitwise_equal():
    assert same(run(heap(2), UNTIL), run(heap(2), UNTIL))


def test_pauses_of_the_clock_do_not_change_a_run():
    paused = start(heap(2))
    for pause in np.linspace(0.0, UNTIL, 37)[1:]:
        paused.advance(pause)
    assert same(paused, run(heap(2), UNTIL))


def test_pauses_do_not_change_which_step_is_the_last():
    dt = 0.2 / 827.0  # 0.9 s lies in the middle of two steps, but for rounding
    counts = set()
    for pause in (0.1, 0.3, 0.57, 0.85, 0.9):
        simulation = start([{"shape": "cube", "position": [0.0, 0.0, 0.0]}], dt=dt)
        simulation.advance(pause)
        simulation.advance(0.9)
        counts.add(simulation.step_count)
    assert len(counts) == 1


def test_rotated_and_shifted_scene_moves_alike():
    turn, shift = unit(np.array([0.3, -0.5, 0.7, 0.4])), np.array([3.0, -2.0, 5.0])
    bodies = heap(1, 5)
    moved = [
        {
            **body,
            "position": turned(turn, np.array(body["position"])) + shift,
            "orientation": product(turn, np.array(body.get("orientation", [1.0, 0.0, 0.0, 0.0]))),
            **{key: turned(turn, body[key]) for key in ("velocity", "spin") if key in body},
        }
        for body in bodies
    ]
    here = run(bodies, UNTIL).snapshot()
    there = run(moved, UNTIL, gravity=turned(turn, np.array([0.0, 0.0, -9.81]))).snapshot()
    assert here.energy.friction > 1.0
    assert np.abs(turned(turn, here.position) + shift - there.position).max() <= 1e-9
    assert np.abs(turned(turn, here.velocity) - there.velocity).max() <= 1e-7


def test_order_of_the_bodies_does_not_matter():
    bodies, order = heap(1, 5), np.array([3, 5, 0, 2, 4, 1])
    listed = run(bodies, UNTIL).snapshot()
    shuffled = run([bodies[k] for k in order], UNTIL).snapshot()
    assert np.abs(listed.position[order] - shuffled.position).max() <= 1e-9


@pytest.mark.parametrize("seed", [1, 3])
def test_lists_are_conservative_skin_does_not_change_a_bit(seed):
    simulations = [run(heap(seed, 5), UNTIL, skin=skin) for skin in (0.02, 0.2, 3.0)]
    rebuilds = [simulation.report()["rebuilds"] for simulation in simulations]
    assert rebuilds[0] > 3 * rebuilds[1] > 3 * rebuilds[2]
    assert same(simulations[0], simulations[2])
    assert same(simulations[1], simulations[2])


def test_lists_grow_and_drop_nothing():
    random = np.random.default_rng(0)
    places = 1.9 * np.stack(np.meshgrid(*[np.arange(4.0)] * 3), axis=-1).reshape(-1, 3)
    bodies = [
        {
            "shape": "cube",
            "position": place,
            "orientation": unit(random.normal(size=4)),
            "velocity": (places.mean(axis=0) - place) * 2.0,
        }
        for place in places
    ]
    grown = start(bodies, gravity=WEIGHTLESS, skin=0.1)
    few = grown.report()
    grown.advance(0.18)
    many = grown.report()
    assert many["pairs"] > 80 > 2 * few["pairs"]  # room is made for 65, 257 at first
    assert many["candidates"] > 300 > 2 * few["candidates"]
    assert grown.snapshot().energy.friction > 1.0
    assert same(grown, run(bodies, 0.18, gravity=WEIGHTLESS, skin=0.8))


def test_fast_ball_meets_every_wall():
    wall = {"kind": "box", "name": "wall", "size": [1.0, 8.0, 8.0], "rounding": 0.05}
    ball = {"shape": "ball", "position": [0.0, 0.0, 0.0], "velocity": [500.0, 0.0, 0.0]}
    walls = [{"shape": "wall", "position": [x, 0.0, 0.0], "fixed": True} for x in (-3.0, 3.0)]
    law = {**NO_FRICTION, "kn": 1e8, "en2": 1.0 - 1e-12}
    simulation = start([ball, *walls], gravity=WEIGHTLESS, law=law, shapes=[wall], dt=1e-5)
    for instant in np.linspace(0.0, 0.04, 41)[1:]:  # ten rebounds, half a skin in three steps
        simulation.advance(instant)
        assert abs(simulation.snapshot().position[0, 0]) < 2.1
    assert abs(np.linalg.norm(simulation.snapshot().velocity[0]) / 500.0 - 1.0) < 2e-3


@pytest.mark.parametrize("seed", [0, 6])
def test_error_of_the_energy_balance_falls_with_the_square_of_the_step(seed):
    # in other swarms a vertex comes over a face when it is deep behind it: the energy jumps
    energies = [
        run(swarm(seed), 0.8, gravity=WEIGHTLESS, dt=dt).snapshot().energy for dt in (4e-4, 1e-4)
    ]
    lost = energies[1].dashpot + energies[1].friction + energies[1].rolling
    coarse, fine = (abs(energy.balance) / lost for energy in energies)
    assert fine < 2e-3
    assert coarse / fine > 8.0


def test_driven_plate_drags_a_block_and_its_work_is_accounted_for():
    block = {"shape": "cube", "position": [0.0, 0.0, 0.5]}
    simulation = run([block, {**FLOOR, "velocity": [0.5, 0.0, 0.0]}], 0.5)
    mass = masses(simulation.placement, simulation.polyhedra)[0][0]
    now = simulation.snapshot()
    # m v^2 of work: half moves the block, half is lost in friction while it slips
    assert now.velocity[0, 0] == pytest.approx(0.5, rel=1e-5)
    assert now.position[1, 0] == pytest.approx(0.25, rel=1e-12)
    assert now.energy.work == pytest.approx(mass * 0.25, rel=1e-4)
    assert now.energy.friction == pytest.approx(0.5 * mass * 0.25, rel=1e-3)
    assert abs(now.energy.balance) < 1e-4 * now.energy.work


@pytest.fixture
def grounds(tmp_path):
    """Planes z = 0 by name: many facets of one mesh, and a raster of heights."""
    raster = tmp_path / "flat.asc"
    header = "ncols 5\nnrows 4\nxllcorner -1\nyllcorner -1.5\ncellsize 0.9\n"
    raster.write_text(header + 4 * "-0.05 -0.05 -0.05 -0.05 -0.05\n")
    terrain = {"kind": "terrain", "name": "terrain", "file": str(raster), "rounding": 0.05}
    return {"strips": strips(), "terrain": terrain}


@pytest.mark.parametrize("ground", ["strips", "terrain"])
def test_block_stops_at_the_same_place_on_a_plane_of_many_facets(ground, grounds):
    block = {
        "shape": "brick",
        "position": [0.0, 0.0, 0.25],
        "orientation": unit(np.array([1.0, 0.0, 0.0, 0.3])),
        "velocity": [2.5, 0.3, 0.0],
        "spin": [0.0, 0.0, 0.4],
    }
    plane = {"shape": ground, "position": [0.0, 0.0, 0.0], "fixed": True}
    whole = run([block, FLOOR], 1.0).snapshot()
    cut = run([block, plane], 1.0, shapes=[grounds[ground]]).snapshot()
    assert whole.position[0, 0] > 0.6  # over the borders of facets
    assert np.linalg.norm(whole.velocity[0]) < 1e-6
    assert np.linalg.norm(whole.position[0] - cut.position[0]) <= 1e-6


def test_block_slides_ten_metres_over_facets_without_friction_at_its_speed():
    block = {"shape": "brick", "position": [0.0, 0.0, 0.25], "velocity": [8.0, 0.3, 0.0]}
    plane = {"shape": "strips", "position": [0.0, 0.0, 0.0], "fixed": True}
    end = run([block, plane], 1.25, law=NO_FRICTION, shapes=[strips()]).snapshot()
    assert end.position[0, 0] == pytest.approx(10.0)
    assert np.linalg.norm(end.velocity[0] - [8.0, 0.3, 0.0]) <= 1e-9 * 8.0
    assert np.linalg.norm(end.spin[0]) <= 1e-9


def test_friction_moves_with_a_ball_from_a_face_to_its_border_edge():
    ball = {"shape": "ball", "position": [0.43, 0.0, 0.99998], "velocity": [0.4, 0.0, 0.0]}
    bodies = [
        {**ball, "spin": [0.0, 0.8, 0.0]},
        {"shape": "cube", "position": [0.0, 0.0, 0.0], "fixed": True},
    ]
    law = {"mu": 5.0, "mur": 1e-30}
    simulation = start(bodies, gravity=(4.0, 1.0, -9.0), law=law, dt=5e-5)
    face, friction = 3, [np.zeros(3)]
    while simulation.step_count < 2000:
        simulation.advance(simulation.time + simulation.dt)
        touching = simulation.snapshot(contacts=True).contacts
        friction.append(touching.tangential_force.sum(axis=0))
        if face not in touching.kind:
            break
    sizes = np.linalg.norm(friction[-3:], axis=1)
    assert sizes[1] > 0.5
    # it goes on as it went; a contact without the other one's history would start from nothing
    assert sizes[2] == pytest.approx(2.0 * sizes[1] - sizes[0], rel=1e-3)


def test_fused_arithmetic_differs_by_rounding_and_repeats_for_two_threads(monkeypatch):
    monkeypatch.setattr(warpdem.simulation, "CREW_BODIES", 2)
    monkeypatch.setattr("warpdem.crews.WORTH", 1e9)  # two, though one be faster
    monkeypatch.setattr(warpdem.simulation.os, "cpu_count", lambda: 2)
    soon = 0.05  # before contacts make rounding grow
    separate = run(heap(1, 5), soon)
    fused, again = (
        run(heap(1, 5), soon, threads=threads, arithmetic="fused") for threads in (1, 2)
    )
    assert same(fused, again)
    positions = [s.snapshot().position for s in (separate, fused)]
    assert np.abs(positions[0] - positions[1]).max() < 1e-12


def hard(seed, **keys):
    """A heap whose dashpots are strong for its step: modes of pairs are held back."""
    return run(heap(seed, 6), UNTIL, dt=1e-3, law={"en2": 0.0025}, **keys)


@pytest.mark.parametrize("seed", [0, 2])
def test_skins_change_no_bit_where_dashpots_are_strong_and_contacts_open_and_close(seed):
    few, many = (hard(seed, skin=skin) for skin in (0.01, 0.5))
    assert few.report()["rebuilds"] > 2 * many.report()["rebuilds"]
    assert same(few, many)


@pytest.mark.parametrize("seed", [0, 1])
def test_hot_lists_leave_out_nothing_that_touches(monkeypatch, seed):
    lists = []
    for ahead, margin in ((10, 0.01), (0, 0.0), (0, 1e6)):  # the usual, the tightest, everything
        monkeypatch.setattr("warpdem.stages.AHEAD", ahead)
        monkeypatch.setattr("warpdem.stages.MARGIN", margin)
        lists.append(run(heap(seed, 5), UNTIL, skin=0.2))
    assert all(same(one, lists[-1]) for one in lists[:-1])
    hot = [
        int((s._lists.pairs.hot_end.numpy() - s._lists.pairs.start.numpy()[:-1]).sum())
        for s in lists
    ]
    assert hot[1] < hot[2]
