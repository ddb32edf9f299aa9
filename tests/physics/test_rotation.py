"""Rotation over a long time: free bodies and a heavy top against closed formulas."""

import numpy as np
import pytest
from impacts import order_of
from tops import angle_between, euler_zxz, free_rotor, heavy_top, principal_momentum
from warpdem.kernels.rotation import free_drift, free_torque, rkmk4_drift

from warpdem.geometry.orientation import product, turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

MOMENTS = np.array([1.0, 2.0, 3.0])
SPIN = np.array([1.0, 1.0, 1.0])
# exact orientation w, x, y, z of this body after 100 s (Jacobi's elliptic functions, 18 digits)
AFTER_100_S = [0.7543620159814326, -0.6111927854801947, 0.1860544358049818, 0.15088099528661478]


def turned_free(dt, times=(100.0,), **run):
    return free_rotor(MOMENTS, SPIN, times, dt=dt, **run)


def orientation_error(dt, **run):
    return angle_between(turned_free(dt, **run)[-1].orientation[0], AFTER_100_S)


@pytest.mark.parametrize(
    ("rotation", "dt", "most"),
    [
        ("no_squish", 0.05, 9.75e-3),
        ("no_squish", 0.01, 3.95e-4),
        ("rkmk4", 0.05, 4.55e-5),
        ("rkmk4", 0.01, 7.55e-8),
    ],
)
def test_free_body_is_where_elliptic_functions_put_it(rotation, dt, most):
    assert orientation_error(dt, rotation=rotation) < most


@pytest.mark.parametrize(("rotation", "order"), [("no_squish", 2), ("rkmk4", 4)])
def test_error_of_the_orientation_falls_with_the_order_of_the_drift(rotation, order):
    found = order_of(lambda n: orientation_error(0.05 / n, rotation=rotation), (1, 2, 4))
    assert found > 0.975 * order


def kept(shots):
    """Largest relative change of the world's angular momentum; energies over that of the start."""
    momentum = principal_momentum(shots, MOMENTS)
    world = turned(np.array([shot.orientation[0] for shot in shots]), momentum)
    energy = 0.5 * np.sum(momentum**2 / MOMENTS, axis=1)
    size = np.linalg.norm(MOMENTS * SPIN)
    return np.abs(world - MOMENTS * SPIN).max() / size, energy / energy[0]


def test_free_body_keeps_its_angular_momentum_to_rounding_and_its_energy_bounded():
    momentum, energy = kept(turned_free(0.01, np.linspace(0.0, 100.0, 51), rotation="no_squish"))
    assert momentum < 1e-13
    assert np.abs(energy - 1.0).max() < 3e-5
    assert np.abs(energy[25:] - 1.0).max() < 1.2 * np.abs(energy[:25] - 1.0).max()


def test_rkmk4_keeps_the_energy_of_a_free_body_in_1000_s_to_its_fifth_order():
    times = np.linspace(0.0, 1000.0, 51)
    momentum, energy = kept(turned_free(0.01, times, rotation="rkmk4"))
    assert momentum < 1e-13
    assert np.abs(energy - 1.0).max() < 1e-9


def test_symmetric_body_precesses_about_its_momentum():
    moment, axial, spin = 1.0, 1.8, np.array([0.6, 0.0, 2.0])
    momentum = np.array([moment * spin[0], 0.0, axial * spin[2]])
    time, size = 20.0, np.linalg.norm(momentum)
    angle = 0.5 * size / moment * time
    outer = np.append(np.cos(angle), np.sin(angle) * momentum / size)
    own = 0.5 * momentum[2] * (1.0 / axial - 1.0 / moment) * time
    exact = product(outer, [np.cos(own), 0.0, 0.0, np.sin(own)])
    shot = free_rotor([moment, moment, axial], spin, [time], dt=0.002)[0]
    assert angle_between(shot.orientation[0], exact) < 1e-4


def test_body_that_turns_about_its_middle_axis_flips():
    moments, spin = [1.0, 2.0, 3.0], [0.01, 1.0, 0.01]
    shots = free_rotor(moments, spin, np.linspace(0.0, 40.0, 401), dt=0.01)
    middle = principal_momentum(shots, np.ones(3))[:, 1]
    assert middle.min() < -0.99
    # it comes back after the period of the elliptic functions, 39.1057 s
    assert np.interp(39.105734, [shot.time for shot in shots], middle) > 0.9999


def test_ball_turns_at_its_spin_for_ever():
    shot = free_rotor([2.0, 2.0, 2.0], [0.0, 0.3, 0.0], [50.0], dt=0.1)[0]
    exact = [np.cos(7.5), 0.0, np.sin(7.5), 0.0]
    assert angle_between(shot.orientation[0], exact) < 1e-12


def test_ball_turns_the_same_with_either_drift():
    balls = [
        free_rotor([2.0, 2.0, 2.0], [0.1, 0.3, 0.0], [5.0], dt=0.1, rotation=rotation)[0]
        for rotation in ("no_squish", "rkmk4")
    ]
    assert np.array_equal(balls[0].orientation, balls[1].orientation)


# a top of I1 = 1, I3 = 1/2, m g l = 9.81, let go at 0.5 rad with 8 rad/s about its axis
TOP = {"moments": [1.0, 1.0, 0.5], "weight": 9.81, "tilt": 0.5, "spin": 8.0}


def lowest_tilt():
    """cos u of the largest tilt: L3^2 (u0 - u)^2 / (2 I1 (1 - u^2)) = m g l (u0 - u)."""
    a = (TOP["moments"][2] * TOP["spin"]) ** 2 / (2.0 * TOP["moments"][0] * TOP["weight"])
    return 0.5 * (a - np.sqrt(a * a - 4.0 * (a * np.cos(TOP["tilt"]) - 1.0)))


def nutation(dt):
    times = np.arange(0.0, 4.0, dt)
    orientation, momentum = heavy_top(times=times, dt=dt, **TOP)
    return times, turned(orientation, np.array([0.0, 0.0, 1.0])), momentum


def test_heavy_top_falls_to_the_tilt_that_energy_allows():
    _, axis, _ = nutation(1e-3)
    assert axis[:, 2].min() == pytest.approx(lowest_tilt(), abs=1e-5)


def test_error_of_the_tops_lowest_tilt_falls_with_the_square_of_the_step():
    def error(n):
        _, axis, _ = nutation(0.016 / n)
        low = int(np.argmin(axis[:, 2]))
        a, b, c = axis[low - 1 : low + 2, 2]
        return abs(b - (c - a) ** 2 / (8.0 * (a - 2.0 * b + c)) - lowest_tilt())

    assert order_of(error, (1, 2, 4, 8)) > 1.8


# exact Euler angles z, x, z of this top after 10 s (Jacobi's elliptic functions, 18 digits)
TOP_AFTER_10_S = euler_zxz(20.300191326165226, 1.4850980461230379, 76.64636765074466)


@pytest.mark.parametrize(("drift", "most"), [(free_drift, 1.85e-4), (rkmk4_drift, 3.25e-4)])
def test_heavy_top_is_where_elliptic_functions_put_it(drift, most):
    orientation, _ = heavy_top(times=[10.0], dt=5e-3, how=(drift, free_torque), **TOP)
    assert angle_between(orientation[0], TOP_AFTER_10_S) < most


def test_heavy_top_keeps_its_vertical_angular_momentum():
    _, _, momentum = nutation(5e-3)
    assert np.ptp(momentum[:, 2]) < 1e-13


def test_heavy_top_nutates_in_the_period_of_the_elliptic_integral():
    times, axis, _ = nutation(1e-3)
    rising = np.flatnonzero(np.diff(np.sign(np.gradient(axis[:, 2]))) < 0)
    assert np.diff(times[rising])[0] == pytest.approx(1.8618638655190678, abs=2e-3)


@pytest.mark.parametrize(("count", "drift"), [(1, "rkmk4"), (2, "no_squish")])
def test_what_nothing_can_turn_is_turned_by_rkmk4(count, drift):
    brick = {"kind": "box", "name": "brick", "size": [1.0, 2.0, 3.0]}
    bodies = [
        {"shape": "brick", "density": 1.0, "position": [9.0 * k, 0.0, 0.0]} for k in range(count)
    ]
    law = {"groups": ["default"] * 2, "kn": 1e5, "kt": 0.0, "mu": 0.0, "en2": 1.0}
    scene = {"run": {"duration": 1.0}, "shape": [brick], "body": bodies, "contact": [law]}
    assert Simulation(Scene.model_validate(scene), device="cpu").features.rotation == drift
