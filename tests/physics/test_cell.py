"""A periodic cell that stands still: what happens across its boundary happens as elsewhere."""

import numpy as np
import pytest
from periodic import LAW, SHAPES, STATE, UNIT, at, lattice, momentum, start

BALL = {
    "shape": "ball",
    "position": [0.30, 0.04, 0.03],
    "velocity": [-2.0, 0.3, 0.0],
    "spin": [3.0, 5.0, 7.0],
}
CUBE = {
    "shape": "cube",
    "position": [0.0, 0.0, 0.0],
    "spin": [1.0, -2.0, 0.5],
    "orientation": [0.8, 0.6, 0.0, 0.0],
}
TARGET = {"shape": "ball", "position": [0.0, 0.0, 0.0], "spin": [1.0, -2.0, 0.5]}
IMAGES = [[1, 0, 0], [0, -1, 0], [1, 1, 0], [-1, 0, 1], [1, -1, 1], [3, 0, -2]]
WALL = {"shape": "slab", "position": [0.0, 0.0, -0.5], "fixed": True}
SLAB = {"kind": "box", "name": "slab", "size": [3.0, 3.0, 0.2], "rounding": 0.02}
FLOOR_CELL = {**UNIT, "periodic": [True, True, False]}


@pytest.mark.parametrize("target", [CUBE, TARGET], ids=["cube", "ball"])
def test_collision_across_the_boundary_is_that_of_free_space(target):
    free = start([BALL, target])
    free.advance(0.06)
    there = free.snapshot()
    assert np.linalg.norm(there.velocity[0] - BALL["velocity"]) > 0.5
    assert np.linalg.norm(there.spin[0] - BALL["spin"]) > 1.0
    for image in IMAGES:
        moved = at(target, position=image)
        periodic = start([BALL, moved], UNIT)
        periodic.advance(0.06)
        here = periodic.snapshot()
        assert np.abs(here.position - there.position - [[0, 0, 0], image]).max() < 1e-12
        for name in STATE[1:]:
            assert np.abs(getattr(here, name) - getattr(there, name)).max() < 3e-12


def test_large_body_is_found_across_the_boundary():
    small = {**BALL, "scale": 0.5, "position": [0.34, 0.05, 0.0]}
    other = {**small, "position": [0.4, -0.3, 0.3]}
    large = {"shape": "ball", "scale": 2.5, "position": [0.0, 0.0, 0.0], "spin": [0.0, 2.0, 1.0]}
    shots = []
    for image in ([0, 0, 0], [1, 0, 0], [-1, 1, 2]):
        simulation = start([small, other, at(large, position=image)], UNIT)
        assert simulation.features.large
        simulation.advance(0.06)
        shots.append((simulation.snapshot(), np.array(image)))
    (here, _), *others = shots
    assert np.linalg.norm(here.spin[0] - BALL["spin"]) > 1.0
    for there, image in others:
        moved = here.position + np.outer([0.0, 0.0, 1.0], image)
        assert np.abs(there.position - moved).max() < 1e-12
        for name in STATE[1:]:
            assert np.abs(getattr(there, name) - getattr(here, name)).max() < 3e-12


def test_body_pressed_against_its_own_image_stays_in_place():
    squeezed = {"size": [0.19, 1.0, 1.0]}
    simulation = start([{"shape": "ball", "position": [0.02, 0.5, 0.5]}], squeezed)
    simulation.advance(0.01)
    shot = simulation.snapshot(contacts=True)
    assert list(shot.contacts.bodies[0]) == [0, 0]
    assert len(shot.contacts.gap) == 1
    assert shot.contacts.normal_force[0] == pytest.approx(LAW["kn"] * 0.01, rel=1e-12)
    assert np.abs(shot.velocity).max() == 0.0
    assert np.abs(shot.force).max() == 0.0
    # f d / V: one contact of force kn 0.01 and branch 0.19
    stress = LAW["kn"] * 0.01 * 0.19 / 0.19
    assert shot.cell.contact_stress[0, 0] == pytest.approx(stress, rel=1e-12)


def test_body_meets_its_two_neighbours_twice_in_a_cell_of_two():
    size = [0.38, 1.0, 1.0]
    balls = [{"shape": "ball", "position": [x, 0.5, 0.5]} for x in (0.1, 0.29)]
    shot = start(balls, {"size": size}).snapshot(contacts=True)
    assert len(shot.contacts.gap) == 2
    assert np.abs(shot.force).max() < 1e-9


def test_stress_of_a_simple_cubic_lattice_is_that_of_its_springs():
    pitch = 0.195
    size = 3 * [3 * pitch]
    simulation = start(lattice(3, size), {"size": size})
    shot = simulation.snapshot(contacts=True)
    overlap = 0.2 - pitch
    # one contact a body and axis: sigma = kn overlap pitch / pitch^3
    expected = LAW["kn"] * overlap / pitch**2
    assert len(shot.contacts.gap) == 3 * 27
    assert np.abs(shot.cell.stress - expected * np.eye(3)).max() < 1e-9 * expected
    assert shot.cell.solid_fraction == pytest.approx(np.pi / 6 * (0.2 / pitch) ** 3, rel=1e-9)


def test_collisions_across_the_boundary_conserve_momentum_to_rounding():
    bodies = lattice(3, [1.0] * 3, seed=3, speed=1.0, jitter=0.01, shapes=("ball", "cube"))
    simulation = start(bodies, {"size": [1.0] * 3}, dt=5e-5)
    before = momentum(simulation)
    size = sum(np.abs(momentum(simulation))) + 100.0
    simulation.advance(0.1)
    assert simulation.snapshot().energy.friction > 1.0
    assert np.abs(momentum(simulation) - before).max() < 1e-13 * size * np.sqrt(2000)


def test_friction_goes_on_when_a_sliding_body_crosses_the_boundary():
    """A ball slides, then rolls on the floor: over the boundary as far from it."""
    shapes = {"shape": [*SHAPES, SLAB]}
    gravity = {"gravity": (0.0, 0.0, -9.81)}
    ends = []
    for x in (-0.4, 0.3):
        ball = {"shape": "ball", "position": [x, 0.1, -0.3], "velocity": [1.5, 0.7, 0.0]}
        simulation = start([ball, WALL], FLOOR_CELL, dt=1e-4, **gravity, **shapes)
        simulation.advance(0.4)
        shot = simulation.snapshot()
        assert shot.position[0, 0] - x > 0.4  # the second one has crossed
        assert simulation.report()["rebuilds"] > 5
        ends.append((shot, x))
    (near, x0), (far, x1) = ends
    assert near.energy.friction > 0.1
    assert np.abs(near.position - far.position - [[x0 - x1, 0, 0], [0, 0, 0]]).max() < 1e-12
    for name in STATE[1:]:
        assert np.abs(getattr(near, name) - getattr(far, name)).max() < 1e-11


def test_sliding_contact_of_two_bodies_keeps_its_history_over_the_boundary():
    """Two cubes pressed together drift across the boundary while one slides on the other."""
    ends = []
    for shift in (0.0, 0.45):
        pair = [
            {"shape": "cube", "position": [shift, 0.0, 0.0], "velocity": [3.0, 0.2, 0.0]},
            {
                "shape": "cube",
                "position": [shift + 0.02, 0.03, 0.2995],
                "velocity": [2.0, 0.0, 0.0],
                "orientation": [0.96, 0.0, 0.0, 0.28],
            },
        ]
        simulation = start(pair, UNIT, dt=2e-5)
        simulation.advance(0.05)
        ends.append((simulation.snapshot(), shift))
    (first, _), (second, shift) = ends
    assert first.energy.friction > 1e-3
    assert np.abs(second.position - first.position - [shift, 0.0, 0.0]).max() < 1e-12
    for name in STATE[1:]:
        assert np.abs(getattr(first, name) - getattr(second, name)).max() < 1e-11
