"""Dashpots of several sub-contacts: stable at the automatic step, whatever the restitution."""

import numpy as np
import pytest
from test_laws import of
from warpdem.kernels.braking import coupled, implicit_share
from warpdem.kernels.measures import largest_eigenvalue
from warpdem.kernels.precision import mat33

from scenes import body, box, laboratory, law
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

THICK = 0.08


def column(e, count=4):
    """Thin slabs of two sizes on each other, 1 kg in all, the top one spinning a little."""
    kn = 0.25 * 9.81 / 1e-5
    slabs = [
        box(name, (w, w + 0.14, THICK), rounding=1e-3) for name, w in (("a", 0.11), ("b", 0.13))
    ]
    bodies = [
        body("ab"[k % 2], [0.0, 0.0, THICK * (k + 0.5)], mass=1.0 / count) for k in range(count)
    ]
    bodies[-1]["spin"] = [0.01, 0.02, 0.0]
    rules = law(kn, kt=0.8 * kn, mu=0.5, e=e)
    return laboratory(slabs, bodies, rules, dt="auto", gravity=(0.0, 0.0, -9.81), skin=0.005)


@pytest.mark.parametrize("e", [0.05, 0.135, 0.3, 0.7])
def test_a_column_of_slabs_gains_no_energy_at_the_automatic_step(e):
    simulation = column(e)
    start = simulation.snapshot().energy
    # what falling by its static sinking sets free
    free = 1.0 * 9.81 * 4.0 * 1e-5
    simulation.advance(0.05)
    energy = simulation.snapshot().energy
    assert energy.kinetic + energy.elastic < start.kinetic + start.elastic + free
    assert abs(energy.balance) < free


def test_a_light_block_under_a_heavy_one_stays_in_place_however_strong_its_dashpots():
    shapes = [
        box("light", (1.0, 1.0, 1.0), rounding=0.05),
        box("heavy", (1.2, 1.2, 1.2), rounding=0.05),
    ]
    bodies = [body("light", [0.0, 0.0, 0.5]), body("heavy", [0.0, 0.0, 1.6], mass=1e6)]
    rules = law(1e8, kt=8e7, mu=0.5, zeta=100.0)
    simulation = laboratory(shapes, bodies, rules, dt="auto", gravity=(0.0, 0.0, -9.81))
    simulation.advance(0.1)
    shot = simulation.snapshot()
    assert np.abs(shot.position[0, :2]).max() < 1e-9
    # half as deep as the heavy one, which falls less than freely
    assert 0.0 < 0.5 - shot.position[0, 2] < 0.5 * 0.5 * 9.81 * 0.1**2
    assert abs(shot.energy.balance) < 0.02 * 1e6 * 9.81 * 0.1


def test_implicit_share_keeps_the_fastest_decay_within_a_step():
    for decay in (0.1, 1.0, 5.0):
        beta = max(of(implicit_share, decay), 0.0)
        assert decay < 1.0 + 2.0 * beta


def test_largest_eigenvalue_is_bounded_from_above_and_closely():
    random = np.random.default_rng(0)
    for _ in range(20):
        rows = random.normal(size=(4, 3))
        b = rows.T @ rows
        exact = np.linalg.eigvalsh(b)[-1]
        bound = of(largest_eigenvalue, mat33(*b.ravel()))
        assert exact <= bound * (1.0 + 1e-12)
        assert bound <= 3.0**0.125 * exact
    assert of(largest_eigenvalue, mat33()) == 0.0


def test_norm_of_blocks_bounds_that_of_the_whole_matrix():
    random = np.random.default_rng(1)
    for _ in range(20):
        rows = random.normal(size=(5, 6))
        b = rows.T @ rows
        shift, turn = np.linalg.norm(b[:3, :3], 2), np.linalg.norm(b[3:, 3:], 2)
        bound = of(coupled, float(shift), float(turn), float(np.linalg.norm(b[:3, 3:])))
        assert np.linalg.norm(b, 2) <= bound * (1.0 + 1e-12)


@pytest.mark.parametrize(("mass", "e"), [(0.2, 0.1), (0.01, 0.7), (0.001, 0.3)])
def test_a_light_wall_pushes_a_heavy_body_without_gaining_energy(mass, e):
    wall = {
        "name": "wall",
        "shape": "plate",
        "position": [0.0, 0.0, -0.01],
        "fixed": True,
    }
    block = {"shape": "block", "position": [0.0, 0.0, 0.05], "density": 2000.0}
    push = {"kind": "control", "bodies": ["wall"], "force": {"z": 60.0}, "mass": mass}
    scene = {
        "run": {"duration": 0.05},
        "gravity": {"vector": [0.0, 0.0, 0.0]},
        "shape": [
            {"kind": "box", "name": "plate", "size": [0.4, 0.4, 0.02], "rounding": 0.004},
            {"kind": "box", "name": "block", "size": [0.1, 0.1, 0.1], "rounding": 0.004},
        ],
        "body": [wall, block],
        "contact": [{"groups": ["default"] * 2, "kn": 1e5, "kt": 0.0, "mu": 0.0, "en2": e * e}],
        "driver": [push],
    }
    simulation = Simulation(Scene.model_validate(scene), device="cpu", threads=1)
    simulation.advance(0.05)
    energy = simulation.snapshot().energy
    assert abs(energy.balance) < 1e-2 * energy.work
    # both go with the force as one
    speed = 60.0 * 0.05 / (2000.0 * 1e-3 + mass)
    assert simulation.snapshot().velocity[1, 2] == pytest.approx(speed, rel=0.1)
