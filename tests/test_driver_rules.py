"""What is refused about drivers, and why."""

import json

import pytest
from driving import plan, scene

from warpdem.checks.check import build_shapes, check
from warpdem.driving.plan import plan_of
from warpdem.errors import SceneError
from warpdem.filling.placement import place
from warpdem.input.decode import loads
from warpdem.simulation import Simulation


@pytest.mark.parametrize(
    ("driver", "says"),
    [
        ({"bodies": ["b"], "kind": "constant", "velocity": [1, 0, 0]}, "moves freely"),
        (
            {"bodies": ["nobody"], "kind": "constant", "velocity": [1, 0, 0]},
            "no .*body.* this name",
        ),
        ({"bodies": ["a", "a"], "kind": "constant", "velocity": [1, 0, 0]}, "named twice"),
        ({"bodies": ["a"], "kind": "constant"}, "moves nothing"),
        (
            {"bodies": ["a"], "kind": "constant", "velocity": [1, 0, 0], "point": [0, 0, 0]},
            "no effect without spin",
        ),
        (
            {"bodies": ["a"], "kind": "constant", "velocity": [1, 0, 0], "start": 2.0, "stop": 1.0},
            "later than start = 2",
        ),
        (
            {"bodies": ["a"], "kind": "sine", "translation": [1, 0, 0], "frequency": 0.0},
            "frequency",
        ),
        ({"bodies": ["a"], "kind": "sine", "frequency": 1.0}, "moves nothing"),
        ({"bodies": ["a"], "kind": "expression", "x": "sin(u)"}, "cannot use 'u' at letter 5"),
        ({"bodies": ["a"], "kind": "table", "file": "none.csv"}, "no such file"),
        ({"bodies": ["a"], "kind": "control"}, "follows no force"),
        (
            {"bodies": ["a"], "kind": "control", "force": {"z": 1.0}, "velocity": {"z": 1.0}},
            "along this axis already",
        ),
        (
            {"bodies": ["a"], "kind": "control", "force": {"z": 1.0}, "inertia": {"z": 1.0}},
            "without moment.z",
        ),
        (
            {"bodies": ["a"], "kind": "control", "moment": {"z": 1.0}, "gravity": True},
            "without force",
        ),
        (
            {"bodies": ["a"], "kind": "control", "force": {"z": 1.0}, "ramp": [[0, 0], [0, 1]]},
            "times must increase",
        ),
        ({"bodies": ["a"], "kind": "pressure", "pressure": 1.0, "axis": "z", "sign": -1}, "area"),
        (
            {
                "bodies": ["a"],
                "kind": "pressure",
                "pressure": 1.0,
                "axis": "z",
                "sign": 2,
                "area": 1.0,
            },
            "sign",
        ),
        (
            {
                "bodies": ["a"],
                "kind": "pressure",
                "pressure": 1.0,
                "axis": "z",
                "sign": 1,
                "between": [["a", "c"], ["c", "d"]],
            },
            "pressed itself",
        ),
        ({"bodies": ["a"], "kind": "spiral"}, "spiral"),
    ],
)
def test_senseless_driver_is_refused_with_its_reason(driver, says):
    lines = ['[run]\nduration = 1.0\n[[shape]]\nname = "box"\nkind = "box"\nsize = [1, 1, 1]']
    for k, (name, fixed) in enumerate({"a": True, "b": False, "c": True, "d": True}.items()):
        lines.append(
            f'[[body]]\nname = "{name}"\nshape = "box"\nposition = [{2 * k}, 0, 0]\ndensity = 1.0\n'
            f"fixed = {str(fixed).lower()}"
        )
    lines.append("[[contact]]\ngroups = ['default', 'default']\nkn=1e5\nkt=0.0\nmu=0.0\nen2=0.5")
    lines.append("[[driver]]")
    lines += [f"{key} = {_toml(value)}" for key, value in driver.items()]
    with pytest.raises(SceneError, match=says) as caught:
        loads("\n".join(lines))
    assert all("driver[0]" in str(problem) for problem in caught.value.problems)


def _toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_toml(part)}" for key, part in value.items()) + "}"
    return json.dumps(value)


@pytest.mark.parametrize(
    ("drivers", "says"),
    [
        (
            [
                {"kind": "control", "force": {"x": 1.0}},
                {"kind": "sine", "frequency": 1.0, "translation": [1.0, 0, 0]},
            ],
            "motion along x, which follows a force of driver",
        ),
        (
            [{"kind": "control", "moment": {"x": 1.0}}, {"kind": "expression", "ry": "t"}],
            "rotation, which follows a moment",
        ),
        (
            [
                {"kind": "control", "force": {"x": 1.0}, "mass": 1.0},
                {"kind": "control", "force": {"x": 1.0}, "mass": 2.0},
            ],
            "another mass",
        ),
    ],
)
def test_axis_cannot_be_imposed_and_follow_a_force_at_once(drivers, says):
    with pytest.raises(SceneError, match=says):
        plan([{"bodies": ["a"], **driver} for driver in drivers])


def test_axis_may_follow_a_force_first_and_be_imposed_later():
    first = {"kind": "control", "bodies": ["a"], "force": {"x": 1.0}, "stop": 1.0}
    later = {"kind": "constant", "bodies": ["a"], "velocity": [1.0, 0, 0], "start": 1.0}
    assert len(plan([first, later]).imposed) == 1


def test_wall_without_mass_is_refused():
    massless = scene([{"kind": "control", "bodies": ["a"], "force": {"z": 1.0}}])
    body = massless.body[0].model_copy(update={"density": None})
    massless = massless.model_copy(update={"body": (body,)})
    shapes = build_shapes(massless)
    with pytest.raises(SceneError, match="give the driver mass"):
        plan_of(massless, place(massless, shapes), shapes)


def test_wall_that_follows_a_force_has_no_velocity_of_its_own_along_it():
    built = scene([{"kind": "control", "bodies": ["a"], "force": {"z": 1.0}}])
    body = built.body[0].model_copy(update={"velocity": (0.0, 0.0, 1.0)})
    built = built.model_copy(update={"body": (body,)})
    shapes = build_shapes(built)
    with pytest.raises(SceneError, match="velocity of its own"):
        plan_of(built, place(built, shapes), shapes)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("keys", "says"),
    [
        ({"z": "0.01 * sqrt(t)"}, r"z = .*: its velocity is inf at t = 0 s"),
        ({"x": "0.01 * log(t - 0.1)"}, r"x = .*: its value is nan at t = 0 s"),
        ({"ry": "10**10**10 * t"}, r"ry = .*: its value is nan at t = 0 s"),
        ({"x": "sqrt(1.1234567 - t)", "start": 0.5}, r"x = .*: its value is nan at t = 1\.123"),
        ({"x": "exp(40 * t)"}, r"x = .*: its velocity is .*at most 1e\+30"),
        ({"x": "log(t - 3)", "start": 3.0}, r"x = .*: its value is -inf at t = 3 s"),
    ],
)
def test_expression_that_is_not_finite_within_the_run_is_refused(keys, says):
    driver = {"bodies": ["a"], "kind": "expression", **keys}
    with pytest.raises(SceneError, match=says):
        plan([driver])
    assert "must be finite" in str(check(scene([driver])).problems[0])


@pytest.mark.parametrize(
    "keys",
    [
        {"x": "sqrt(2.1 - t)"},
        {"x": "sqrt(1 - t)", "stop": 0.9},
        {"x": "log(t)", "start": 0.5},
        {"x": "sqrt(t - 3)", "start": 3.0},
    ],
)
def test_expression_need_not_be_finite_outside_of_its_time(keys):
    assert plan([{"bodies": ["a"], "kind": "expression", **keys}]).imposed


@pytest.mark.filterwarnings("error")
def test_what_an_expression_is_after_the_run_goes_unsaid():
    turning = {"bodies": ["a"], "kind": "expression", "rx": "t / step(0.0105 - t)"}
    built = scene([turning], run={"duration": 0.01, "dt": 1e-3})
    simulation = Simulation(built, device="cpu", threads=1)
    simulation.advance(0.01)
    assert simulation.snapshot().spin[0, 0] == pytest.approx(1.0)
