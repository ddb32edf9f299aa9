"""Each vertex counts once, edges by what they overlap more than their ends."""

import numpy as np
import partnership
import pytest

from warpdem.geometry.orientation import turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

ONCE = {"partnership": "once"}
SIDE, ROUNDING, KN = 1.0, 0.05, 1e5


def tower(*, count=3, offset=0.0, yaw=0.0, dt="auto", gap=0.0):
    shapes = [
        {"kind": "box", "name": "cube", "size": [SIDE] * 3, "rounding": ROUNDING},
        {"kind": "box", "name": "floor", "size": [20.0, 20.0, 2.0], "rounding": ROUNDING},
    ]
    bodies = [{"shape": "floor", "position": [0.0, 0.0, -1.0], "fixed": True}]
    bodies += [
        {
            "shape": "cube",
            "density": 1.0,
            "position": [offset * (k % 2), 0.0, 0.5 * SIDE + k * (SIDE + gap)],
            "orientation": [np.cos(0.5 * yaw * k), 0.0, 0.0, np.sin(0.5 * yaw * k)],
        }
        for k in range(count)
    ]
    return Scene.model_validate(
        {
            "run": {"duration": 1.0, "dt": dt, **ONCE},
            "gravity": {"vector": [0.0, 0.0, -9.81]},
            "shape": shapes,
            "body": bodies,
            "contact": [
                {"groups": ["default"] * 2, "kn": KN, "kt": 0.7 * KN, "mu": 0.5, "en2": 0.25}
            ],
        }
    )


@pytest.mark.parametrize("kind", partnership.KINDS)
def test_elastic_collisions_in_any_pose_keep_their_energy(kind):
    worst = partnership.changes(kind, 20, partnership.STEP / 4.0, ONCE).max()
    assert worst < 3e-3


def test_the_errors_of_elastic_collisions_fall_with_the_square_of_the_step():
    coarse, fine = (
        partnership.changes("cubes", 40, partnership.STEP / parts, ONCE) for parts in (2, 8)
    )
    assert fine.max() < coarse.max() / 8.0
    assert np.median(fine) < np.median(coarse) / 12.0


@pytest.mark.parametrize(("offset", "yaw"), [(0.0, 0.0), (0.1, 0.0), (0.0, 1e-6), (0.0, 1e-3)])
def test_a_tower_of_equal_cubes_keeps_account_of_its_energy(offset, yaw):
    simulation = Simulation(tower(offset=offset, yaw=yaw), device="cpu", threads=1)
    off = []
    while simulation.time < 0.3:
        simulation.advance(simulation.time + 8 * simulation.dt)
        off.append(abs(simulation.snapshot().energy.balance))
    assert max(off) < 1e-4  # of the 4 J that the blocks could fall


def test_aligned_cubes_at_rest_never_change_what_touches():
    simulation = Simulation(tower(), device="cpu", threads=1)
    simulation.advance(0.2)
    seen = set()
    while simulation.time < 0.3:
        simulation.advance(simulation.time + simulation.dt)
        touching = simulation.snapshot(contacts=True).contacts
        seen.add((touching.bodies.tobytes(), touching.kind.tobytes(), touching.features.tobytes()))
    assert len(seen) == 1


@pytest.mark.parametrize("shift", [-1e-9, 0.0, 1e-9, 1e-3])
def test_a_vertex_at_a_border_counts_once(shift):
    # two cubes, one over the other, moved along x: lower and upper corners carry what four springs
    # of their own do, wherever the borders are
    simulation = Simulation(tower(count=2, offset=shift, gap=-1e-3), device="cpu", threads=1)
    lifted = simulation.snapshot().force[2, 2] + 9.81 * simulation._model.mass[2]
    assert lifted == pytest.approx(8.0 * KN * 1e-3, rel=2e-2)


@pytest.mark.parametrize(("shift", "springs"), [((0.0, 0.0), 8), ((0.9, 0.0), 4), ((0.9, 0.9), 2)])
def test_corners_and_borders_that_lie_over_each_other_count_once_in_any_frame(shift, springs):
    random = np.random.default_rng(3)
    bodies = []
    for pair in range(60):
        turn = random.normal(size=4)
        turn /= np.linalg.norm(turn)
        middle = np.array([6.0 * pair, 0.0, 0.0])
        apart = turned(turn, np.array([*shift, SIDE - 1e-3]))
        bodies += [
            {"shape": "cube", "density": 1.0, "position": place, "orientation": turn}
            for place in (middle, middle + apart)
        ]
    cube = {"kind": "box", "name": "cube", "size": [SIDE] * 3, "rounding": ROUNDING}
    law = {"groups": ["default"] * 2, "kn": KN, "kt": 0.0, "mu": 0.0, "en2": 1.0}
    scene = {"run": {"duration": 1.0, "dt": 1e-4, **ONCE}, "shape": [cube], "body": bodies}
    scene |= {"gravity": {"vector": [0.0] * 3}, "contact": [law]}
    simulation = Simulation(Scene.model_validate(scene), device="cpu", threads=1)
    pressed = np.linalg.norm(simulation.snapshot().force, axis=1)
    assert pressed == pytest.approx(np.full(120, springs * KN * 1e-3), rel=2e-2)


def test_a_tilted_tower_keeps_account_of_its_energy():
    scene = tower(dt=1e-4)
    pull = 9.81 * np.array([np.sin(0.1), 0.0, -np.cos(0.1)])
    tilted = scene.model_copy(
        update={"gravity": scene.gravity.model_copy(update={"vector": tuple(pull)})}
    )
    simulation = Simulation(tilted, device="cpu", threads=1)
    simulation.advance(0.2)
    assert abs(simulation.snapshot().energy.balance) < 1e-4


@pytest.mark.parametrize("place", [1e-9, 0.005, 0.05, 0.5])
def test_a_bar_across_the_ridge_of_a_terrain_is_carried_at_its_nodes_too(place, tmp_path):
    side = np.arange(-3.0, 4.0)
    heights = np.repeat(-np.abs(side[::-1])[:, None], 7, axis=1)
    head = "ncols 7\nnrows 7\nxllcorner -3\nyllcorner -3\ncellsize 1\nNODATA_value -9999\n"
    rows = "\n".join(" ".join(map(str, row)) for row in heights)
    (tmp_path / "ridge.asc").write_text(f"{head}{rows}\n")
    bar = {"kind": "box", "name": "bar", "size": [0.4, 2.0, 0.4], "rounding": ROUNDING}
    half = 0.125 * np.pi  # on an edge
    ground = {"kind": "terrain", "name": "ground", "rounding": ROUNDING}
    lowest = (0.2 - ROUNDING) * np.sqrt(2.0) + ROUNDING
    bodies = [
        {"shape": "ground", "position": [0.0] * 3, "fixed": True},
        {
            "shape": "bar",
            "density": 1.0,
            "position": [place, 0.0, lowest + ROUNDING - 0.01],
            "orientation": [np.cos(half), 0.0, np.sin(half), 0.0],
        },
    ]
    law = {"groups": ["default"] * 2, "kn": KN, "kt": 0.0, "mu": 0.0, "en2": 1.0}
    scene = {
        "run": {"duration": 1.0, "dt": 1e-4},
        "gravity": {"vector": [0.0] * 3},
        "shape": [{**ground, "file": str(tmp_path / "ridge.asc")}, bar],
        "body": bodies,
        "contact": [law],
    }
    simulation = Simulation(Scene.model_validate(scene), device="cpu", threads=1)
    assert simulation.snapshot().force[1, 2] >= 0.9 * KN * 0.01
