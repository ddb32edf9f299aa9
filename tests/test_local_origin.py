"""Scenes far from the origin move as they do near it."""

import numpy as np
import pytest

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

FAR = np.array([2.6e6, 1.2e6, 0.0])
LAW = {"groups": ["default"] * 2, "kn": 1e6, "kt": 8e5, "en2": 0.1, "mu": 0.5}


def dropped(by, **more):
    scene = {
        "run": {"duration": 0.2, "device": "cpu"},
        "group": [{"name": "default", "density": 2500.0}],
        "shape": [
            {"name": "block", "kind": "box", "size": [0.125, 0.1, 0.0625]},
            {"name": "floor", "kind": "box", "size": [4.0, 4.0, 1.0]},
        ],
        "body": [
            {
                "shape": "block",
                "position": np.add(by, [0.125, 0.0625, 0.0625]).tolist(),
                "orientation": [0.8, 0.36, 0.48, 0.0],
                "velocity": [0.5, 0.25, -1.0],
            },
            {
                "name": "floor",
                "shape": "floor",
                "position": np.add(by, [0.0, 0.0, -0.5]).tolist(),
                "fixed": True,
            },
        ],
        "contact": [LAW],
        **more,
    }
    return Simulation(Scene.model_validate(scene), threads=1)


def test_a_block_falls_at_map_coordinates_as_at_the_origin():
    here, there = dropped(np.zeros(3)), dropped(FAR)
    for simulation in (here, there):
        simulation.advance(0.2)
    near, far = here.snapshot(contacts=True), there.snapshot(contacts=True)

    assert far.position - FAR == pytest.approx(near.position, abs=1e-9)
    assert far.orientation == pytest.approx(near.orientation, abs=1e-9)
    assert far.contacts.point - FAR == pytest.approx(near.contacts.point, abs=1e-9)


def test_potential_energy_is_that_of_the_scenes_own_origin():
    high = np.array([0.0, 0.0, 4096.0])
    energy, level = (dropped(by).snapshot().energy for by in (high, np.zeros(3)))

    mass = level.potential / (9.81 * 0.0625)
    assert energy.potential - level.potential == pytest.approx(mass * 9.81 * 4096.0, rel=1e-12)
    assert energy.balance == level.balance == 0.0


def test_a_driver_turns_what_is_far_about_its_own_axis():
    def turned(by):
        point = (np.array([1.0, 0.0, 0.0]) + by).tolist()
        spin = {"kind": "constant", "bodies": ["floor"], "spin": [0, 0, 2.0], "point": point}
        simulation = dropped(by, driver=[spin])
        simulation.advance(0.1)
        return simulation.snapshot().position[1]

    assert turned(FAR) - FAR == pytest.approx(turned(np.zeros(3)), abs=1e-9)
