"""Rockable's trajectories at equal dt; tools/bench/rockable.py prints them as a table."""

from pathlib import Path

import pytest
import rockable
import rockable_cases

from warpdem.simulation import Simulation

EXCERPTS = sorted((Path(__file__).parent / "data").glob("*.json"))


def cases():
    folder = rockable_cases.FOLDER
    found = [rockable_cases.read_case(path.parent) for path in sorted(folder.glob("*/case.json"))]
    if not found:
        reason = f"no reference runs of Rockable in {folder}"
        return [pytest.param(None, id="folder", marks=pytest.mark.skip(reason=reason))]
    # chaotic packings are compared by their means, in tools/bench alone
    return [pytest.param(case, id=case.name) for case in found if not case.is_packing]


def deviation(case, rows):
    simulation = Simulation(rockable_cases.equal(case), device="cpu", threads=1)
    return rockable.compare(simulation, rows)


@pytest.mark.parametrize("path", EXCERPTS, ids=[path.stem for path in EXCERPTS])
def test_excerpt_is_repeated_at_equal_dt(path):
    gate = rockable.GATES.get(path.stem, rockable.EQUAL)
    distance, angle = deviation(*rockable_cases.read_excerpt(path))
    assert distance <= gate.distance
    assert angle <= gate.angle


@pytest.mark.parametrize("case", cases())
def test_reference_run_is_repeated_at_equal_dt(case):
    gate = rockable.GATES.get(case.name, rockable.EQUAL)
    rows = case.trajectory()
    distance, angle = deviation(case, rows[rows[:, 0] < gate.until])
    assert distance <= gate.distance
    assert angle <= gate.angle


@pytest.mark.parametrize("name", rockable.RUPTURES)
def test_first_bond_breaks_in_the_step_of_the_reference(name):
    folder = rockable_cases.FOLDER / name
    if not folder.is_dir():
        pytest.skip(f"no reference run in {folder}")
    simulation = Simulation(
        rockable_cases.equal(rockable_cases.read_case(folder)), device="cpu", threads=1
    )

    step = rockable.first_rupture(simulation)

    assert step == round(rockable.RUPTURES[name] / simulation.dt)


@pytest.mark.parametrize("path", EXCERPTS, ids=[path.stem for path in EXCERPTS])
def test_converted_input_is_the_scene_of_its_definition(path):
    case, _ = rockable_cases.read_excerpt(path)
    folder = rockable_cases.FOLDER / case.name
    if not folder.is_dir():
        pytest.skip(f"no reference run in {folder}")
    brought = rockable_cases.equal(rockable_cases.read_case(folder))
    given = rockable_cases.defined(case)

    assert brought.contact == given.contact
    assert brought.gravity == given.gravity
    assert (brought.run.dt, brought.run.list_distance) == (given.run.dt, given.run.list_distance)
    assert brought.run.duration >= given.run.duration
    for one, other in zip(brought.body, given.body, strict=True):
        for key in ("shape", "group", "position", "velocity", "spin", "scale", "fixed"):
            assert getattr(one, key) == getattr(other, key)
        assert one.orientation == pytest.approx(other.orientation, rel=0, abs=3e-16)
