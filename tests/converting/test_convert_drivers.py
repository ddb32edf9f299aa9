"""drivingSystem.txt as [[driver]] and [cell]."""

from math import pi, sqrt, tan

import pytest
from conffiles import TWO, brought, problems, row, tables


def drivers(tmp_path, driving, **options):
    return tables(tmp_path, driving=driving, **options).get("driver", [])


def test_controls_of_a_body(tmp_path):
    control = "# remark\nControl _x_Vel_ 0 0.1\nControl _zrot_Vel_ 0 2\nControl _z_For_ 0 -500\n"
    result = brought(tmp_path, driving=control)

    assert result.tables["driver"] == [
        {
            "bodies": ["body0"],
            "kind": "constant",
            "velocity": [0.1, 0.0, 0.0],
            "spin": [0.0, 0.0, 2.0],
        },
        {"bodies": ["body0"], "kind": "control", "force": {"z": -500.0}},
    ]
    assert any("enters the velocities at contacts" in note for note in result.notes)


def test_vectors_of_controls_and_sums(tmp_path):
    driving = "Control _xyzrot_Vel_ 0 1 2 3\nControl _xrot_Vel_ 0 1\nControl _xyzrot_Mom_ 0 4 5 6\n"
    constant, control = drivers(tmp_path, driving)

    assert constant["spin"] == [2.0, 2.0, 3.0]
    assert control["moment"] == {"x": 4.0, "y": 5.0, "z": 6.0}


def test_shaker(tmp_path):
    (driver,) = drivers(tmp_path, "Servo shaker 0 3 0 4 0.01 5")

    assert driver == {
        "bodies": ["body0"],
        "kind": "sine",
        "translation": [0.01 * 3.0 / 5.0, 0.0, 0.01 * 4.0 / 5.0],
        "frequency": 5.0,
    }


def test_shaker_goes_on_where_the_clock_of_the_file_stands(tmp_path):
    (driver,) = drivers(tmp_path, "Servo shaker 0 1 0 0 0.01 5", head="t 0.3\ntmax 1\ndt 1e-4")

    assert driver["phase"] == 2.0 * pi * 5.0 * 0.3


@pytest.mark.parametrize(
    "line", ["triangle_shaker 0 1 0 0 0.01 5", "sawtooth_shaker 0 1 0 0 0.01 5 0"]
)
def test_triangle_shakers(tmp_path, line):
    (driver,) = drivers(tmp_path, f"Servo {line}")

    assert driver["wave"] == "triangle"
    assert driver["translation"] == [0.01, 0.0, 0.0]
    assert "start" not in driver


def test_sawtooth_with_a_late_start_is_listed(tmp_path):
    result = brought(tmp_path, driving="Servo sawtooth_shaker 0 1 0 0 0.01 5 0.4")

    assert result.tables["driver"][0]["start"] == 0.4
    assert any("drifts away" in note for note in result.notes)


def test_ramp_of_a_velocity_is_its_path(tmp_path):
    (driver,) = drivers(tmp_path, "Servo ramp _y_Vel_ 0 1 3 0.2 0.6")
    assert driver["kind"] == "expression"

    def y(t):
        return eval(driver["y"], {"min": min, "max": max}, {"t": t})  # noqa: S307 - of our own

    def velocity(t):
        return (y(t + 1e-6) - y(t - 1e-6)) / 2e-6

    for t, v in ((0.1, 1.0), (0.3, 1.5), (0.5, 2.5), (0.9, 3.0)):
        assert velocity(t) == pytest.approx(v, rel=1e-8)


def test_ramp_of_a_force(tmp_path):
    (driver,) = drivers(tmp_path, "Servo ramp _z_For_ 0 -10 -30 0.2 0.6")

    assert driver["force"] == {"z": 1.0}
    assert driver["ramp"] == [[0.2, -10.0], [0.6, -30.0]]


def test_only_the_last_servo_is_obeyed(tmp_path):
    driving = "Servo ramp _z_For_ 0 -10 -30 0.2 0.6\nServo shaker 0 1 0 0 0.01 5\n"
    result = brought(tmp_path, driving=driving)

    held, shaker = result.tables["driver"]
    assert held == {"bodies": ["body0"], "kind": "control", "force": {"z": -10.0}}
    assert shaker["kind"] == "sine"
    assert any("obeys the last servo alone" in note for note in result.notes)


WALLS = [row("plate", f"{k} 0 0") for k in range(6)] + [TWO[1]]


def walls(tmp_path, line, **options):
    return drivers(tmp_path, f"Servo {line}", rows=WALLS, driven=6, **options)


def test_isostatic_compression_presses_the_far_walls(tmp_path):
    x, y, z = walls(tmp_path, "tritriIsostaticCompression 0 1 2 3 4 5 1000")

    assert x == {
        "bodies": ["body1"],
        "kind": "pressure",
        "pressure": 1000.0,
        "between": [["body2", "body3"], ["body4", "body5"]],
        "axis": "x",
        "sign": -1,
    }
    assert (y["bodies"], y["axis"]) == (["body3"], "y")
    assert (z["bodies"], z["between"]) == (
        ["body5"],
        [["body0", "body1"], ["body2", "body3"]],
    )


def test_biaxial_compression_moves_the_wall_along_y(tmp_path):
    moved, *pressed = walls(tmp_path, "tritriBiaxialCompression 0 1 2 3 4 5 1000 0.2")

    assert moved == {"bodies": ["body3"], "kind": "constant", "velocity": [0.0, -0.2, 0.0]}
    assert [driver["axis"] for driver in pressed] == ["x", "z"]


def test_custom_walls(tmp_path):
    line = "tritriCustom 0 1 2 3 4 5  1 100  0 0.1  0 0.2  1 -50  0 0  1 0"
    made = walls(tmp_path, line)
    by_body = {driver["bodies"][0]: driver for driver in made}

    assert by_body["body0"]["sign"] == 1
    assert by_body["body0"]["pressure"] == 100.0
    assert by_body["body1"]["velocity"] == [-0.1, 0.0, 0.0]
    assert by_body["body2"]["velocity"] == [0.0, 0.2, 0.0]
    assert (by_body["body3"]["sign"], by_body["body3"]["pressure"]) == (1, 50.0)
    assert "body4" not in by_body
    assert by_body["body5"]["ramp"] == [[0.0, 0.0]]


def test_lode_angle_is_a_ramp_of_pressures(tmp_path):
    x, y, z = walls(tmp_path, "tritriLodeAngle 0 1 2 3 4 5 1000 30 50", head="tmax 2\ndt 1e-4")
    a = (3.0 * tan(pi / 6.0) - sqrt(3.0)) / (2.0 * sqrt(3.0))

    assert x["pressure"] == 1.0
    assert x["ramp"] == [[0.0, 1000.0], [2.0, 1100.0]]
    assert y["ramp"][1][1] == pytest.approx(1000.0 + 100.0 * a)
    assert z["ramp"][1][1] == pytest.approx(1000.0 - 100.0 * (1.0 + a))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("Control _x_Vl_ 0 1", 'did you mean "_x_Vel_"?'),
        ("Control _x_Vel_ 1 1", "not among the first nDriven = 1"),
        ("Control _x_Vel_ 0 fast", "should be a number, not 'fast'"),
        ("Servo shacker 0 1 0 0 1 1", 'did you mean "shaker"?'),
        ("Servo shaker 0 0 0 0 1 1", "a direction and a frequency above 0"),
        ("Servo ramp _x_Vel_ 0 1 2 3 3", "before it begins"),
        ("Servo tritriLodeAngle 0 0 0 0 0 0 1 70 1", "from 0 to 60 degrees"),
        ("Control _x_Vel_ 0 1e31", "too large to compute with"),
        ("PeriodicLoading Squeeze 1", "there is no loading"),
        ("PeriodicLoading TriaxialCompression W 1 1", "there are: X, Y, Z"),
        ("Contrl _x_Vel_ 0 1", 'did you mean "Control"?'),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path, line, said):
    (problem,) = problems(tmp_path, driving=f"# remark\n{line}\n")

    assert problem.startswith("drivingSystem.txt:2: ")
    assert said in problem


def test_no_driving_system_leaves_driven_bodies_at_rest(tmp_path):
    assert drivers(tmp_path, "") == []


CELL = "usePeriodicCell 1\nh 2 0.1 0 0 3 0 0 0 4\nmh 0.5"


def test_cell_and_what_it_lacks(tmp_path):
    result = brought(tmp_path, CELL)

    assert result.tables["cell"]["size"] == [2.0, 3.0, 4.0]
    assert result.tables["cell"]["periodic"] == [True, True, True]
    assert any("  h: a cell is upright" in note for note in result.notes)
    assert any("  mh: the cell's mass" in note for note in result.notes)


PRESSED = {"xx": 1000.0, "yy": 1000.0, "zz": 1000.0}


@pytest.mark.parametrize(
    ("loading", "stress", "entry"),
    [
        ("IsotropicCompression 1000", PRESSED, None),
        ("TriaxialCompression Y 1000 -0.2", {"xx": 1000.0, "zz": 1000.0}, (1, 1, -0.2)),
        ("SimpleShearDeformable XZ 1000 0.3", PRESSED, (0, 2, 0.3)),
    ],
)
def test_loading_of_a_cell(tmp_path, loading, stress, entry):
    cell = tables(tmp_path, CELL, driving=f"PeriodicLoading {loading}")["cell"]

    assert cell["stress"] == stress
    rate = [[0.0] * 3 for _ in range(3)]
    if entry:
        row, column, value = entry
        rate[row][column] = value
    assert cell.get("strain_rate", [[0.0] * 3] * 3) == rate


def test_cell_needs_lengths(tmp_path):
    (problem,) = problems(tmp_path, "usePeriodicCell 1")

    assert "three positive lengths" in problem


def test_loading_without_a_cell_is_listed(tmp_path):
    result = brought(tmp_path, driving="PeriodicLoading IsotropicCompression 1000")

    assert "cell" not in result.tables
    assert any("usePeriodicCell is not 1" in note for note in result.notes)
