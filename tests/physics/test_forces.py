"""Drag, fluid, numerical damping and barriers in whole runs, against closed forms."""

from itertools import pairwise

import numpy as np
import pytest

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

G = 9.81


def simulated(force, *, dt, position=(0.0, 0.0, 0.0), **changes):
    """A ball of 1 kg and radius 0.1 m under one force or several."""
    body = {
        "shape": "ball",
        "density": 0.75e3 / np.pi,
        "position": position,
        **changes.pop("body", {}),
    }
    gravity = changes.pop("gravity", (0.0, 0.0, -G))
    scene = Scene.model_validate(
        {
            "run": {"duration": 10.0, "dt": dt, **changes.pop("run", {})},
            "gravity": {"vector": gravity},
            "shape": [
                {"kind": "sphere", "name": "ball", "radius": 0.1},
                {"kind": "plane", "name": "ground"},
            ],
            "body": [body, *changes.pop("others", [])],
            "force": [force] if isinstance(force, dict) else force,
            **changes,
        }
    )
    return Simulation(scene, device="cpu", threads=1)


def orders(error_at, steps=(0.04, 0.02, 0.01)):
    """Errors and orders of convergence of a function of the time step."""
    errors = [error_at(dt) for dt in steps]
    return errors, [np.log2(a / b) for a, b in pairwise(errors)]


def test_a_fall_under_drag_approaches_its_terminal_velocity_with_order_two():
    coefficient = 0.1
    terminal = np.sqrt(G / coefficient)

    def error(dt):
        simulation = simulated({"kind": "drag", "coefficient": coefficient}, dt=dt)
        simulation.advance(1.2)
        now = simulation.snapshot()
        assert abs(now.energy.balance) < 3.0 * dt**2 * now.energy.kinetic
        assert now.energy.external < -1.0
        fallen = terminal**2 / G * np.log(np.cosh(G * 1.2 / terminal))
        v = -terminal * np.tanh(G * 1.2 / terminal)
        return abs(now.velocity[0, 2] - v) / terminal + abs(now.position[0, 2] + fallen)

    errors, rates = orders(error)
    assert errors[-1] < 1e-4
    assert min(rates) > 1.9


def test_strong_drag_stays_stable_at_steps_that_do_not_resolve_it(tmp_path):
    storm = wind(tmp_path, np.tile([100.0, 0.0, 0.0], (2, 2, 2, 1)))
    force = [{"kind": "drag", "coefficient": 1e3}, {**storm, "cx": 1e3 / (np.pi * 0.01)}]
    simulation = simulated(force, dt=0.1, gravity=(0.0, 0.0, 0.0))
    simulation.advance(10.0)
    # halfway between the still air and the wind
    assert simulation.snapshot().velocity[0, 0] == pytest.approx(50.0, rel=1e-6)


def test_viscosity_times_cx_is_the_coefficient_of_drag():
    forces = [
        {"kind": "drag", "viscosity": 0.5, "cx": 0.4},
        {"kind": "drag", "coefficient": 0.2},
    ]
    ends = []
    for force in forces:
        simulation = simulated(force, dt=0.02)
        simulation.advance(1.0)
        ends.append(simulation.snapshot().velocity[0, 2])
    assert ends[0] == ends[1]


def test_drag_acts_on_its_groups_and_several_add_up():
    other = {"shape": "ball", "density": 0.75e3 / np.pi, "position": [5.0, 0.0, 0.0]}
    law = {"kn": 1e4, "kt": 0.0, "en2": 1.0, "mu": 0.0}
    pairs = [["default", "default"], ["default", "dusty"], ["dusty", "dusty"]]
    simulation = simulated(
        [
            {"kind": "drag", "coefficient": 0.1},
            {"kind": "drag", "coefficient": 0.2, "groups": ["dusty"]},
        ],
        dt=0.01,
        gravity=(0.0, 0.0, 0.0),
        body={"velocity": [0.0, 2.0, 0.0]},
        others=[{**other, "group": "dusty", "velocity": [0.0, 2.0, 0.0]}],
        contact=[{"groups": pair, **law} for pair in pairs],
    )
    simulation.advance(1.0)
    # 1/v grows by c t / m
    speed = simulation.snapshot().velocity[:, 1]
    assert speed == pytest.approx([1.0 / (0.5 + 0.1), 1.0 / (0.5 + 0.3)], rel=1e-4)


def wind(folder, velocity):
    path = folder / "wind.npz"
    np.savez(path, velocity=velocity, origin=[-10.0, -10.0, -10.0], spacing=[10.0, 10.0, 10.0])
    return {"kind": "fluid", "file": str(path), "cx": 4.0}


@pytest.mark.parametrize("interpolation", ["nearest", "trilinear"])
def test_an_even_wind_carries_a_body_along_with_order_two(tmp_path, interpolation):
    flow = np.tile([3.0, 0.0, 0.0], (3, 3, 3, 1))
    force = {**wind(tmp_path, flow), "interpolation": interpolation}
    friction = 4.0 * np.pi * 0.1**2

    def error(dt):
        simulation = simulated(force, dt=dt, gravity=(0.0, 0.0, 0.0))
        simulation.advance(2.0)
        now = simulation.snapshot()
        assert now.energy.external == pytest.approx(now.energy.kinetic, rel=5.0 * dt**2)
        lag = 3.0 / (1.0 + 3.0 * friction * 2.0)
        return abs(now.velocity[0, 0] - (3.0 - lag))

    errors, rates = orders(error, (0.1, 0.05, 0.025))
    assert errors[-1] < 1e-4
    assert min(rates) > 1.9


def test_a_linear_wind_is_felt_where_the_body_is(tmp_path):
    nodes = 10.0 * np.stack(np.meshgrid(*[np.arange(3) - 1] * 3, indexing="ij"), axis=-1)
    force = wind(tmp_path, nodes @ np.array([[0.0, 0.2, 0.0], [0.0, 0.0, 0.0], [0.1, 0.0, 0.3]]))
    place = np.array([2.0, -3.0, 4.0])
    simulation = simulated(force, dt=0.01, gravity=(0.0, 0.0, 0.0), position=place)

    flow = np.array([0.4, 0.4, 1.2])
    expected = 4.0 * np.pi * 0.1**2 * np.linalg.norm(flow) * flow
    assert simulation.snapshot().force[0] == pytest.approx(expected, rel=1e-13)


def test_the_friction_of_a_block_is_that_of_the_ball_of_its_volume(tmp_path):
    flow = np.tile([3.0, 0.0, 0.0], (2, 2, 2, 1))
    cube = {"kind": "box", "name": "cube", "size": [0.2, 0.1, 0.3], "rounding": 0.01}
    simulation = simulated(
        wind(tmp_path, flow),
        dt=0.01,
        gravity=(0.0, 0.0, 0.0),
        shape=[cube],
        body={"shape": "cube", "scale": 2.0},
    )
    volume = 8.0 * simulation.polyhedra["cube"].volume
    radius = np.cbrt(0.75 * volume / np.pi)
    expected = 4.0 * np.pi * radius**2 * 9.0
    assert simulation.snapshot().force[0] == pytest.approx([expected, 0.0, 0.0], rel=1e-12)


GROUND = {"shape": "ground", "position": [0.0, 0.0, 0.0], "fixed": True}
LAW = {"groups": ["default", "default"], "kn": 1e4, "kt": 0.0, "en2": 1.0, "mu": 0.0}
PRESSED = {"position": (0.0, 0.0, 0.1 - 2e-3), "others": [GROUND], "contact": [LAW]}
"""A ball on a spring, pressed in by twice what its weight does."""


def damped_spring(dt, until, **changes):
    simulation = simulated(
        {"kind": "numerical_damping", "coefficient": 0.3}, dt=dt, **PRESSED, **changes
    )
    simulation.advance(until)
    return simulation


def test_numerical_damping_of_a_bound_body_follows_its_closed_form_with_order_two():
    # no weight: released from the depth a, the spring does work and is 0.7 as strong
    a, omega = 2e-3, np.sqrt(0.7e4)

    until = 0.4 * np.pi / omega

    def error(dt):
        now = damped_spring(dt, until, gravity=(0.0, 0.0, 0.0)).snapshot()
        return abs(now.position[0, 2] - 0.1 + a * np.cos(0.4 * np.pi)) / a

    _, rates = orders(error, (until / 8, until / 16, until / 32))
    assert min(rates) > 1.9


def test_numerical_damping_keeps_order_two_through_its_changes():
    def place(dt):
        return damped_spring(dt, 0.2).snapshot().position[0, 2]

    exact = place(2.0**-4 / 1000)
    errors, rates = orders(lambda dt: abs(place(dt) - exact), (1e-3, 5e-4, 2.5e-4))
    assert errors[-1] < 2e-6
    assert rates[0] + rates[1] > 3.4


def test_numerical_damping_brings_a_body_to_rest_and_its_work_closes_the_account():
    now = damped_spring(2.5e-4, 0.6).snapshot()
    assert abs(now.velocity[0, 2]) < 1e-5
    # as the contact alone is damped, it may carry from 1/1.3 to 1/0.7 of the weight
    assert 1.0 / 1.3 < 1e4 * (0.1 - now.position[0, 2]) / G < 1.0 / 0.7
    start = 0.5e4 * 2e-3**2
    assert now.energy.external < -0.1 * start
    assert abs(now.energy.balance) < 2e-4 * start


def test_a_barrier_lets_no_fall_become_faster():
    limit, exponent = 2.0, 1.0
    force = {"kind": "velocity_barrier", "velocity": limit, "velocity_exponent": exponent}

    def error(dt):
        simulation = simulated(force, dt=dt)
        simulation.advance(0.3)
        now = simulation.snapshot()
        v = -now.velocity[0, 2]
        assert v < limit
        assert abs(now.energy.balance) < 10.0 * dt**2
        # v' = g (1 - v/V)/(1 + v/V): g t = -v - 2 V ln(1 - v/V)
        return abs(-v - 2.0 * limit * np.log(1.0 - v / limit) - G * 0.3)

    _, rates = orders(error, (0.02, 0.01, 0.005))
    assert min(rates) > 1.9


@pytest.mark.parametrize("contact_update", ["predicted", "lagged"])
def test_a_spin_barrier_holds_back_what_turns_a_body_and_nothing_else(contact_update):
    ground = {**GROUND, "velocity": [5.0, 0.0, 0.0]}
    law = {**LAW, "kt": 1e4, "mu": 0.5}
    simulation = simulated(
        {"kind": "velocity_barrier", "spin": 3.0, "spin_exponent": 2.0},
        dt=2e-4,
        position=(0.0, 0.0, 0.1 - G / 1e4),
        others=[ground],
        contact=[law],
        run={"contact_update": contact_update},
    )
    simulation.advance(0.2)
    now = simulation.snapshot()
    # sliding all the while: a = mu g; w' = (5 mu g / 2 R)(1 - r)/(1 + r), r = (w/W)^2
    assert now.velocity[0, 0] == pytest.approx(0.5 * G * 0.2, rel=5e-3)
    w = -now.spin[0, 1]
    assert abs(w) < 3.0
    assert abs(w) > 2.9


def test_a_run_under_all_forces_goes_on_bitwise_after_a_checkpoint(tmp_path):
    force = [
        {"kind": "drag", "coefficient": 0.3},
        wind(tmp_path, np.random.default_rng(0).normal(size=(3, 3, 3, 3))),
        {"kind": "numerical_damping", "coefficient": 0.2},
        {"kind": "velocity_barrier", "velocity": 3.0, "spin": 5.0},
    ]
    made = {"dt": 1e-3, **PRESSED, "body": {"velocity": [1.0, 0.0, 0.0]}}
    through, first, then = (simulated(force, **dict(made)) for _ in range(3))
    through.advance(0.4)
    first.advance(0.2)
    then.restore(first.checkpoint())
    then.advance(0.4)
    one, other = through.snapshot(), then.snapshot()
    for name in ("position", "velocity", "spin", "force"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert one.energy == other.energy
