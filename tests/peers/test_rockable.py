"""Rockable's trajectories at equal dt; tools/bench/rockable.py prints them as a table."""

from pathlib import Path

import pytest
import rockable

from warpdem.simulation import Simulation

EXCERPTS = sorted((Path(__file__).parent / "data").glob("*.json"))


def cases():
    folder = rockable.FOLDER
    found = [rockable.read_case(path.parent) for path in sorted(folder.glob("*/case.json"))]
    if not found:
        reason = f"no reference runs of Rockable in {folder}"
        return [pytest.param(None, id="folder", marks=pytest.mark.skip(reason=reason))]
    # chaotic packings are compared by their means, in tools/bench alone
    return [
        pytest.param(case, id=case.name)
        for case in found
        if not rockable.needs(case) and not case.is_packing
    ]


def deviation(case, rows):
    simulation = Simulation(rockable.equal(case), device="cpu", threads=1)
    return rockable.compare(simulation, rows)


@pytest.mark.parametrize("path", EXCERPTS, ids=[path.stem for path in EXCERPTS])
def test_excerpt_is_repeated_at_equal_dt(path):
    distance, angle = deviation(*rockable.read_excerpt(path))
    gate = rockable.gate(path.stem)
    assert distance <= gate
    assert angle <= 10.0 * gate


@pytest.mark.parametrize("case", cases())
def test_reference_run_is_repeated_at_equal_dt(case):
    distance, angle = deviation(case, case.trajectory())
    gate = rockable.gate(case.name)
    assert distance <= gate
    assert angle <= 10.0 * gate
