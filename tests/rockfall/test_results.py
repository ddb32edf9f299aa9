"""All files of a set of trajectories, read back."""

import csv
from dataclasses import replace

import numpy as np
import pytest
import pyvista
from fields import ORIGIN, flights, rock, site
from slopes import ground_of

from warpdem.output.flight_lines import TRACE_COLUMNS, flight_lines, trace_rows
from warpdem.output.rockfall_results import Wanted, write_results
from warpdem.rockfall.tally import Tally, total
from warpdem.rockfall.trace import Trace

HERE = site()
ROCKS = [rock('a "flat" one, grey')]


def trace(number):
    t = np.linspace(0.0, 2.0, 11)
    place = np.column_stack([20 + 10 * t, 100 + 5 * number + 0 * t, 3 - 5 * t])
    velocity = np.tile([10.0, 0.0, -5.0], (11, 1))
    turn = np.tile([1.0, 0.0, 0.0, 0.0], (11, 1))
    return Trace(t, place, turn, velocity, 0.2 * velocity, np.zeros(11, bool), number, 0)


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    chunks = [flights(30, visits=200, crossings=20, first=30 * n) for n in range(3)]
    tally = total(Tally.of(chunk, HERE) for chunk in chunks)
    passages = write_results(
        folder, Wanted("A slope"), HERE, ROCKS, chunks=iter(chunks), tally=tally,
        traces=[trace(0), trace(1)],
    )  # fmt: skip
    return folder, chunks, passages


def table(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_deposits_are_a_row_a_trajectory_in_the_order_of_ids(results):
    folder, chunks, _ = results
    read = table(folder / "deposits.csv")
    assert [int(row["id"]) for row in read] == list(range(90))
    assert {row["rock"] for row in read} == {ROCKS[0].name}
    position = np.concatenate([chunk.position for chunk in chunks]) + ORIGIN
    np.testing.assert_allclose([[float(row[a]) for a in "xyz"] for row in read], position, 0, 1e-6)
    first = read[0]
    slope = np.tan(np.radians(float(first["reach_angle"])))
    assert slope == pytest.approx(float(first["fall"]) / float(first["runout"]), rel=1e-7)


def test_barrier_statistics_are_those_of_the_crossings(results):
    folder, _, passages = results
    crossings, statistics = table(folder / "barriers.csv"), table(folder / "barrier_statistics.csv")
    assert len(crossings) == 60
    for barrier, row, passage in zip(HERE.barriers, statistics, passages, strict=True):
        assert row["barrier"] == barrier.name
        energy = sorted(float(c["energy"]) for c in crossings if c["barrier"] == barrier.name)
        assert int(row["crossings"]) == passage.crossings == len(energy)
        assert float(row["energy_q90"]) == energy[-(-9 * len(energy) // 10) - 1]
        assert float(row["energy_max"]) == energy[-1]


def test_distance_along_a_bent_barrier_is_that_to_the_foot_of_the_crossing(results):
    crossed = [row for row in table(results[0] / "barriers.csv") if row["barrier"] != "road"]
    away = [float(row["y"]) - ORIGIN[1] for row in crossed]
    np.testing.assert_allclose([float(row["distance"]) for row in crossed], away, atol=1e-5)


def test_lines_carry_values_at_their_points_and_the_origin(results):
    lines = pyvista.read(results[0] / "trajectories.vtu")
    assert lines.n_cells == 2
    np.testing.assert_array_equal(lines.field_data["origin"], ORIGIN)
    np.testing.assert_array_equal(lines.cell_data["id"], [0, 1])
    np.testing.assert_allclose(lines.point_data["speed"], np.sqrt(125.0))
    np.testing.assert_allclose(lines.point_data["jump"], 13.0)
    turning = 0.5 * (22.0 * 4.0 + 42.0 * 1.0)
    np.testing.assert_allclose(lines.point_data["energy"], 250.0 * 125.0 + turning)
    assert len(table(results[0] / "trajectories.csv")) == 22


def test_the_height_above_unknown_ground_is_an_empty_field_and_nan_on_lines():
    ground = ground_of(np.zeros((13, 4)), cell=10.0)  # the way ends beyond it
    here = replace(HERE, ground=ground)
    way = trace(0)
    read = list(csv.DictReader([TRACE_COLUMNS, *trace_rows(way, here, ROCKS)]))
    known = way.position[:, 0] <= 30.0
    assert known.sum() == 6
    assert [row["jump"] for row in read] == [*(f"{z:.9g}" for z in way.position[:6, 2]), *[""] * 5]
    assert {row["contact"] for row in read} == {"0"}
    jump = flight_lines([way], here, ROCKS).GetPointData().GetArray("jump")
    last = [jump.GetValue(k) for k in range(11)]
    np.testing.assert_allclose(last, np.where(known, way.position[:, 2], np.nan))


def test_terrain_and_rocks_are_surfaces_in_local_coordinates(results):
    ground = pyvista.read(results[0] / "terrain.vtu")
    assert ground.n_cells == 30 * 40
    np.testing.assert_allclose(ground.point_data["height"], ground.points[:, 2] + ORIGIN[2])
    assert {*ground.cell_data["forest"].tolist()} == {-1}
    skins = pyvista.read(results[0] / "rocks.vtu")
    assert skins.n_cells == 2 * 2 * 12
    assert skins.bounds[0] == pytest.approx(20.0 - 0.4)


def test_the_map_is_a_picture_and_no_part_is_left(results):
    assert (results[0] / "map.png").read_bytes().startswith(b"\x89PNG")
    assert not list(results[0].glob("*.part"))
