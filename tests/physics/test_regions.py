"""Each vertex counts once, edges by what they overlap more than their ends."""

import numpy as np
import partnership
import pytest

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
