"""Motion of drivers as functions of time, and what is refused about them."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from driving import plan, scene

from warpdem.checks.check import build_shapes
from warpdem.checks.timestep import automatic_step
from warpdem.driving.curve import Uniform, curve_of, exponential, motion, spin_of
from warpdem.driving.expression import ExpressionError, parse
from warpdem.driving.table import read_table
from warpdem.errors import GeometryError
from warpdem.filling.placement import place
from warpdem.geometry.orientation import turned

T = np.linspace(0.0, 2.0, 4001)


def slopes(values, times):
    return (values[2:] - values[:-2]) / (times[2:] - times[:-2])[:, None, None]


@pytest.mark.parametrize(
    ("text", "formula", "slope"),
    [
        ("2.5", lambda t: 2.5 + 0 * t, lambda t: 0 * t),
        ("-t ** 3 + 2 * t", lambda t: -(t**3) + 2 * t, lambda t: -3 * t**2 + 2),
        (
            "sin(2*pi*t)",
            lambda t: np.sin(2 * np.pi * t),
            lambda t: 2 * np.pi * np.cos(2 * np.pi * t),
        ),
        (
            "exp(-t) * cos(t)",
            lambda t: np.exp(-t) * np.cos(t),
            lambda t: -np.exp(-t) * (np.cos(t) + np.sin(t)),
        ),
        ("sqrt(1 + t)", lambda t: np.sqrt(1 + t), lambda t: 0.5 / np.sqrt(1 + t)),
        (
            "log(1 + t) / (2 + t)",
            lambda t: np.log(1 + t) / (2 + t),
            lambda t: 1 / (1 + t) / (2 + t) - np.log(1 + t) / (2 + t) ** 2,
        ),
        ("2 ** t", lambda t: 2**t, lambda t: np.log(2) * 2**t),
        (
            "atan(t) + tanh(t)",
            lambda t: np.arctan(t) + np.tanh(t),
            lambda t: 1 / (1 + t * t) + 1 / np.cosh(t) ** 2,
        ),
        ("tan(t / 2)", lambda t: np.tan(t / 2), lambda t: 0.5 / np.cos(t / 2) ** 2),
        ("min(t, 1, 3)", lambda t: np.minimum(t, 1), lambda t: np.where(t <= 1, 1.0, 0.0)),
        ("max(t - 1, 0)", lambda t: np.maximum(t - 1, 0), lambda t: np.where(t >= 1, 1.0, 0.0)),
        ("abs(t - 0.7)", lambda t: np.abs(t - 0.7), lambda t: np.sign(t - 0.7)),
        (
            "step(t - 0.5) * (t - 0.5) ** 2",
            lambda t: np.maximum(t - 0.5, 0) ** 2,
            lambda t: 2 * np.maximum(t - 0.5, 0),
        ),
    ],
)
def test_expression_has_its_value_and_its_exact_derivative(text, formula, slope):
    found = parse(text).at(T)
    assert found.value == pytest.approx(formula(T), rel=1e-14, abs=1e-14)
    assert found.rate == pytest.approx(slope(T), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("sin(2 * x)", "cannot use 'x' at letter 9"),
        ("__import__('os').system('true')", "cannot use '__import__"),
        ("t.real", "cannot use 't.real' at letter 1"),
        ("open('f')", "no function open"),
        ("t ^ 2", "a power is written"),
        ("sin", "a function needs parentheses"),
        ("sin(t, t)", "sin takes one argument"),
        ("min(t)", "min takes two or more"),
        ("1 if t else 2", "cannot use"),
        ("True", "not a real number"),
        ("1j * t", "not a real number"),
        ("1e999", "too large"),
        ("t +", "not an expression at letter"),
        ("", "not an expression"),
        ("[t]", "cannot use"),
        ("lambda: 0", "cannot use"),
        ("-" * 100 + "t", "inside one another"),
        ("t" * 3000, "longer than"),
    ],
)
def test_expression_refuses_all_else_and_says_where(text, says):
    with pytest.raises(ExpressionError, match=says.replace("(", r"\(").replace("^", r"\^")):
        parse(text)


def test_spin_of_a_changing_rotation_vector_is_the_derivative_of_the_rotation():
    h = 1e-6
    for size in (1.3, 3e-5, 0.0):
        r, rate = size * np.array([[0.6, -0.64, 0.48]]), np.array([[0.3, 0.7, -0.2]])
        arm = np.array([1.0, 2.0, 3.0])
        ahead, behind = (turned(exponential(r + s * h * rate), arm) for s in (1.0, -1.0))
        velocity = np.cross(spin_of(r, rate), turned(exponential(r), arm))
        assert (ahead - behind) / (2.0 * h) == pytest.approx(velocity, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(
    "driver",
    [
        {
            "kind": "constant",
            "velocity": [1.0, 2.0, 3.0],
            "spin": [0.1, 2.0, 0.3],
            "point": [1, 0, 0],
        },
        {
            "kind": "sine",
            "translation": [0.1, 0, 0.2],
            "rotation": [0, 0.3, 0.1],
            "frequency": 2.0,
            "phase": 0.4,
            "point": [0.0, 1.0, 0.0],
        },
        {
            "kind": "expression",
            "x": "0.1 * t ** 2",
            "rx": "sin(t)",
            "ry": "0.3 * t",
            "rz": "cos(3 * t)",
            "point": [0.5, 0.0, 0.1],
        },
    ],
)
def test_velocity_and_spin_are_derivatives_of_the_path(driver):
    path = plan([{"bodies": ["a"], **driver}]).path(T)
    assert path.velocity[1:-1] == pytest.approx(slopes(path.position, T), rel=1e-4, abs=2e-4)
    tip = turned(path.orientation, np.array([0.3, -0.5, 0.7]))
    assert np.cross(path.spin, tip)[1:-1] == pytest.approx(slopes(tip, T), rel=1e-4, abs=2e-4)
    assert path.position[0, 0] == pytest.approx([0.0, 0.0, 0.0], abs=1e-15)


def test_constant_driver_turns_about_an_axis_through_a_point():
    spin = {"kind": "constant", "bodies": ["a"], "spin": [0.0, 0.0, 2.0], "point": [1.0, 0.0, 5.0]}
    path = plan([{**spin, "start": 0.5, "stop": 1.0}]).path(np.array([0.2, 0.75, 1.7]))
    angle = np.array([0.0, 0.5, 1.0])
    x, y = 1.0 - np.cos(angle), -np.sin(angle)
    assert path.position[:, 0] == pytest.approx(np.stack([x, y, 0.0 * x], axis=1), abs=1e-14)
    assert path.velocity[:, 0] == pytest.approx(
        np.array([[0.0, 0, 0], [2 * np.sin(0.5), -2 * np.cos(0.5), 0.0], [0.0, 0, 0]]), abs=1e-14
    )
    assert path.orientation[2, 0] == pytest.approx([np.cos(0.5), 0, 0, np.sin(0.5)], abs=1e-14)
    assert path.spin[:, 0, 2] == pytest.approx([0.0, 2.0, 0.0])


def test_sine_starts_at_rest_place_with_its_phase_and_triangle_has_constant_speed():
    keys = {"bodies": ["a"], "translation": [0.5, 0, 0], "frequency": 3.0, "start": 0.25}
    sine = plan([{"kind": "sine", "phase": 0.7, **keys}]).path(T)
    angle = 2 * np.pi * 3.0 * np.maximum(T - 0.25, 0.0) + 0.7
    assert sine.position[:, 0, 0] == pytest.approx(0.5 * (np.sin(angle) - np.sin(0.7)), abs=1e-13)
    triangle = plan([{"kind": "sine", "wave": "triangle", **keys}]).path(T + 1e-5)
    moving = T > 0.25
    assert np.abs(triangle.velocity[moving, 0, 0]) == pytest.approx(4 * 0.5 * 3.0)
    assert triangle.position[:, 0, 0].max() == pytest.approx(0.5, rel=1e-3)
    inside = np.flatnonzero(np.diff(np.sign(triangle.velocity[:, 0, 0])) == 0)[1:-1]
    step = np.diff(triangle.position[:, 0, 0])[inside] / (T[1] - T[0])
    assert step == pytest.approx(triangle.velocity[inside, 0, 0], abs=1e-9)


def test_drivers_of_one_body_add_up_in_the_order_of_the_file():
    quarter = np.pi / 2
    about_z = {"kind": "constant", "bodies": ["a"], "spin": [0, 0, quarter], "point": [1.0, 0, 0]}
    about_x = {"kind": "constant", "bodies": ["a"], "spin": [quarter, 0, 0], "point": [0, 0, 2.0]}
    shift = {"kind": "constant", "bodies": ["a"], "velocity": [0.0, 0.0, 7.0]}
    one = np.array([1.0])
    # (0, 0, 0) about z through (1, 0): (1, -1, 0); about x through z = 2: y = 2, z = 1
    first = plan([about_z, shift, about_x]).path(one)
    assert first.position[0, 0] == pytest.approx([1.0, 2.0, 8.0])
    # (0, 0, 0) about x through z = 2: (0, 2, 2); about z through (1, 0): (-1, -1, 2)
    second = plan([about_x, about_z, shift]).path(one)
    assert second.position[0, 0] == pytest.approx([-1.0, -1.0, 9.0])
    path = plan([about_x, about_z, shift]).path(T)
    assert path.velocity[1:-1] == pytest.approx(slopes(path.position, T), abs=1e-4)


def test_bodies_of_one_driver_turn_about_one_point_as_a_rigid_whole():
    drive = {"kind": "sine", "rotation": [0, 0.4, 0], "frequency": 1.0}
    bodies = ["a", "b"]
    whole = plan([{**drive, "bodies": bodies, "point": [0, 0, 0]}], bodies).path(T)
    apart = np.linalg.norm(whole.position[:, 1] - whole.position[:, 0], axis=1)
    assert apart == pytest.approx(3.0)
    own = plan([{**drive, "bodies": bodies}], bodies).path(T)
    assert np.ptp(own.position, axis=0) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("cubic", [False, True])
def test_table_passes_through_its_rows_and_rests_outside(cubic, tmp_path):
    file = tmp_path / "motion.csv"
    file.write_text("t, x, rz\n0.5,0,0\n0.75,1,0.2\n1.0,0.5,0.1\n1.5,2,0\n")
    table = read_table(file, cubic=cubic)
    value, rate = table.at(np.array([0.0, 0.5, 0.75, 1.0, 1.5, 9.0]))
    assert value[:, 0] == pytest.approx([0, 0, 1, 0.5, 2, 2], abs=1e-14)
    assert value[:, 5] == pytest.approx([0, 0, 0.2, 0.1, 0, 0], abs=1e-14)
    assert rate[[0, -1]] == pytest.approx(0.0)
    times = np.linspace(0.51, 1.49, 5000)
    value, rate = table.at(times)
    middle = np.gradient(value[:, 0], times)[5:-5]
    smooth = np.abs(np.diff(rate[:, 0])).max()
    assert np.median(np.abs(middle - rate[5:-5, 0])) < 1e-4
    assert bool(smooth < 0.1) is cubic
    if cubic:  # the second derivative is continuous too
        assert np.abs(np.diff(rate[:, 0], n=2)).max() < 1e-3


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "needs a line of names and two rows"),
        ("time,x\n0,0\n1,1\n", "must name t"),
        ("t,x\n0,0\n", "needs two rows"),
        ("t,x\n0,0\n0,1\n", "motion.csv:3: times must increase"),
        ("t,x\n\n0,0\n\n0,1\n", "motion.csv:5: times must increase"),
        ("t,x\n0,0\n1,a\n", "motion.csv:3: x = 'a': must be a finite number"),
        ("t,x\n0,0\n1\n", "motion.csv:3: has 1 columns where the first line names 2: t, x"),
        ("t,x\n0,0,0\n\n1,1,1\n", "motion.csv:2: has 3 columns"),
        ("t,x\n0,nan\n1,1\n", "motion.csv:2: x = 'nan': must be a finite number"),
        ("t,q\n0,0\n1,1\n", "motion.csv: the first line must name t"),
        ("t,x,x\n0,0,0\n1,1,1\n", "must name t"),
    ],
)
def test_faulty_table_is_refused(text, says, tmp_path):
    (tmp_path / "motion.csv").write_text(text)
    with pytest.raises(GeometryError, match=says):
        read_table(tmp_path / "motion.csv", cubic=True)


def test_motion_is_held_outside_its_time():
    moved = motion(Uniform(np.array([1.0, 0, 0, 0, 0, 1.0]), 0.5), 0.5, 1.0, T)
    assert moved.displacement[:, 0] == pytest.approx(np.clip(T - 0.5, 0.0, 0.5))
    assert moved.rate[:, 0] == pytest.approx(((T >= 0.5) & (T < 1.0)).astype(float))
    assert curve_of(SimpleNamespace(), Path()) is None


def test_force_and_ramp_of_walls_at_the_ends_of_steps():
    push = {"kind": "control", "bodies": ["a"], "force": {"z": -500.0}, "gravity": True}
    ramp = [[0.0, 0.0], [1.0, 1.0]]
    walls = plan([{**push, "ramp": ramp, "stop": 1.5, "start": 0.5}]).walls
    loads = walls.loads(np.array([0.4, 0.55, 0.8, 1.4, 1.6]), 0.1)
    weight = 9.81 / walls.inverse_mass[0, 2]
    assert loads.force[:, 0, 2] == pytest.approx(
        [0.0, -275 - weight, -400 - weight, -500 - weight, 0.0]
    )
    assert loads.loose[:, 0, 2].tolist() == [0.0, 1.0, 1.0, 1.0, 0.0]
    assert walls.inverse_mass[0, :2].tolist() == [0.0, 0.0]


def test_automatic_step_resolves_the_period_of_a_driver():
    for driver in (
        {"kind": "sine", "translation": [0.1, 0, 0], "frequency": 50.0},
        {"kind": "expression", "x": "0.1 * sin(2 * pi * 50 * t)"},
    ):
        shaken = scene([{**driver, "bodies": ["a"]}])
        shapes = build_shapes(shaken)
        dt = automatic_step(shaken, place(shaken, shapes), shapes).dt
        assert dt == pytest.approx(1 / 5000, rel=0.02)
