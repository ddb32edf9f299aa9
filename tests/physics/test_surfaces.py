"""Bodies on planes and in containers, against closed forms and against walls of other kinds."""

import numpy as np
import pytest
from colliding import FLOOR, LAW, NO_FRICTION, run, same, strips, unit

G = 9.81
SURFACES = [
    {"kind": "plane", "name": "plane"},
    {"kind": "cylinder", "name": "tube", "radius": 2.0},
    {"kind": "ball", "name": "dome", "radius": 2.0},
    {"kind": "capsule", "name": "pill", "radius": 0.2, "length": 1.0},
    {
        "kind": "polyhedron",
        "name": "triangle",
        "vertices": [[-60.0, -40.0, 0.0], [60.0, -40.0, 0.0], [0.0, 80.0, 0.0]],
        "faces": [[0, 1, 2]],
        "rounding": 0.05,
    },
    strips(),
]
PLANE = {"shape": "plane", "position": [0.0, 0.0, 0.0], "fixed": True}
TUBE = {"shape": "tube", "position": [0.0, 0.0, 0.0], "fixed": True}
LYING = [np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0]
"""Turns z into y."""
WALLS = [
    FLOOR,
    {"shape": "strips", "position": [0.0, 0.0, 0.0], "fixed": True},
    {"shape": "triangle", "position": [0.0, 0.0, -0.05], "fixed": True},
]
ELASTIC = {**NO_FRICTION, "en2": 1.0}


def made(bodies, until, **keys):
    return run(bodies, until, shapes=SURFACES, **keys)


@pytest.mark.parametrize("kind", ["ball", "cube"])
def test_plane_box_mesh_and_triangle_throw_a_body_back_alike(kind):
    body = {
        "shape": kind,
        "position": [1.1, 0.05, 1.0],
        "velocity": [1.0, 0.3, -3.0],
        "spin": [0.4, 1.0, -0.6],
        "orientation": unit(np.array([1.0, 0.2, 0.3, -0.1])),
    }
    ends = [made([body, wall], 0.9).snapshot() for wall in (PLANE, *WALLS)]
    first = ends[0]
    assert first.velocity[0, 2] > -1.0  # it has been thrown back
    for other in ends[1:]:
        for name in ("position", "orientation", "velocity", "spin"):
            mine, theirs = getattr(first, name)[0], getattr(other, name)[0]
            assert np.linalg.norm(mine - theirs) < 1e-9 * np.linalg.norm(mine), name


@pytest.mark.parametrize("container", ["tube", "dome"])
def test_a_ball_slides_in_a_container_with_the_period_of_a_pendulum(container):
    mass, angle, length = np.pi / 6.0, 0.05, 1.5
    arm = length + mass * G / LAW["kn"]
    body = {"shape": "ball", "position": [arm * np.sin(angle), 0.0, -arm * np.cos(angle)]}
    wall = {"shape": container, "position": [0, 0, 0], "orientation": LYING, "fixed": True}
    quarter = 0.5 * np.pi * np.sqrt(arm / G) * (1.0 + angle**2 / 16.0)
    simulation = made([body, wall], quarter, law=ELASTIC)
    x, speed = simulation.snapshot().position[0, 0], arm * angle * np.sqrt(G / arm)
    assert abs(x) < 1e-3 * quarter * speed
    assert simulation.snapshot().velocity[0, 0] == pytest.approx(-speed, rel=1e-3)


def test_a_ball_rolls_in_a_cylinder_with_the_period_of_seven_fifths():
    mass, angle = np.pi / 6.0, 0.05
    arm = 1.5 + mass * G / LAW["kn"]
    body = {"shape": "ball", "position": [arm * np.sin(angle), 0.0, -arm * np.cos(angle)]}
    quarter = 0.5 * np.pi * np.sqrt(1.4 * arm / G) * (1.0 + angle**2 / 16.0)
    law = {"en2": 1.0, "kr": 0.0, "mur": 0.0}
    simulation = made([body, {**TUBE, "orientation": LYING}], quarter, law=law)
    now = simulation.snapshot()
    speed = arm * angle * np.sqrt(G / (1.4 * arm))
    assert abs(now.position[0, 0]) < 5e-3 * quarter * speed
    # rolling: the ball turns about y as its contact, half a metre away, does not slip
    assert now.spin[0, 1] == pytest.approx(-now.velocity[0, 0] / -0.5, rel=5e-3)


@pytest.mark.parametrize("dt", [1e-3, 5e-4, 2.5e-4, 1.25e-4])
def test_bounces_in_a_hollow_ball_keep_their_energy_with_order_two(dt):
    body = {"shape": "ball", "position": [0.3, -0.2, 0.4], "velocity": [3.0, 1.0, -2.0]}
    dome = {"shape": "dome", "position": [0.0, 0.0, 0.0], "fixed": True}
    simulation = made([body, dome], 1.0, law=ELASTIC, dt=dt)
    now = simulation.snapshot()
    # beginning and end of a bounce within a step change the energy by k v^2 dt^2 / 8 at most
    bounces, square = 2, np.sum(now.velocity[0] ** 2) + 2.0 * G
    assert abs(now.energy.balance) < bounces * 0.25 * LAW["kn"] * square * dt**2


def test_a_capsule_lies_on_a_plane_on_both_its_ends():
    body = {"shape": "pill", "position": [0.0, 0.0, 0.2], "orientation": LYING}
    simulation = made([body, PLANE], 1.5)
    now = simulation.snapshot(contacts=True)
    weight = simulation.polyhedra["pill"].volume * G
    assert now.contacts.kind.tolist() == [6, 6]
    assert -now.contacts.gap == pytest.approx([weight / 2e5] * 2, rel=1e-3)
    assert now.contacts.normal == pytest.approx(np.tile([0.0, 0.0, 1.0], (2, 1)))


def test_a_plane_pushes_a_body_back_from_any_depth():
    body = {"shape": "cube", "position": [0.0, 0.0, -30.0]}
    simulation = made([body, PLANE], 0.0, overlap="note")
    # eight vertices, each k d
    depth = np.array([30.45] * 4 + [29.55] * 4) + 0.05
    force = simulation.snapshot().force[0, 2]
    assert force == pytest.approx(LAW["kn"] * depth.sum() - G, rel=1e-3)


def test_a_plane_that_tilts_carries_what_lies_on_it():
    omega, place, radius = 0.6, 4.0, 0.5
    spin = np.array([0.0, -omega, 0.0])  # lifts +x
    mass = np.pi / 6.0
    height = radius - mass * G / LAW["kn"]
    body = {
        "shape": "ball",
        "position": [place, 0.0, height],
        "velocity": np.cross(spin, [place, 0.0, height]),
    }
    simulation = made([body, {**PLANE, "spin": spin}], 0.8, law=ELASTIC, dt=2e-4)
    now, angle = simulation.snapshot().position[0], 0.8 * omega
    along = np.array([np.cos(angle), 0.0, np.sin(angle)])
    upward = np.array([-np.sin(angle), 0.0, np.cos(angle)])
    c = G / (2.0 * omega**2)
    expected = place * np.cosh(angle) - c * np.sinh(angle) + c * np.sin(angle)
    assert now @ along == pytest.approx(expected, abs=1e-3)
    assert now @ upward == pytest.approx(radius, abs=1e-3)


def test_a_drum_that_turns_drags_its_bodies_and_renews_no_lists():
    body = {"shape": "ball", "position": [0.0, 0.0, -1.5]}
    drum = {**TUBE, "orientation": LYING, "spin": [0.0, 3.0, 0.0]}
    law = {"kr": 0.0, "mur": 0.0, "mu": 0.1}
    simulation = made([body, drum], 0.1, law=law)
    now = simulation.snapshot()
    # the wall slips by at up to 6 m/s: friction mu m g turns the ball, 5 mu g / 2 R
    assert now.spin[0, 1] == pytest.approx(2.5 * 0.1 * G / 0.5 * 0.1, rel=0.05)
    assert simulation.snapshot().energy.work > 0.0
    empty = made([{**body, "position": [0.0, 0.0, 0.0]}, drum], 0.1, gravity=(0.0, 0.0, 0.0))
    assert empty.report()["rebuilds"] == 1


def crowd(count=110):
    """Small balls and cubes that fall on a plane in a tube."""
    random = np.random.default_rng(3)
    bodies = []
    for k in range(count):
        layer, place = divmod(k, 9)
        x, y = 0.7 * (place % 3 - 1), 0.7 * (place // 3 - 1)
        bodies.append(
            {
                "shape": ("ball", "cube")[k % 2],
                "scale": 0.4,
                "position": [x, y, 0.38 + 0.72 * layer],
                "orientation": unit(random.normal(size=4)),
                "velocity": random.normal(size=3) - [0.0, 0.0, 1.0],
            }
        )
    return [*bodies, PLANE, {**TUBE, "spin": [0.0, 0.0, 4.0]}]


def test_runs_in_a_drum_are_bitwise_alike_on_two_threads_and_after_a_checkpoint():
    through = made(crowd(), 0.3)
    assert through.snapshot(contacts=True).contacts.kind.max() == 6
    assert same(through, made(crowd(), 0.3, threads=2))
    first, then = made(crowd(), 0.15), made(crowd(), 0.0)
    then.restore(first.checkpoint())
    then.advance(0.3)
    assert same(through, then)
    position = through.snapshot().position[:-2]
    assert np.hypot(position[:, 0], position[:, 1]).max() < 2.0
    assert position[:, 2].min() > 0.0
