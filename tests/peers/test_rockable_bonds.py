"""Rockable's bonded bodies: at equal dt as that program has them, and the default numerics."""

import numpy as np
import pytest
from bonded import as_rockable, distance, read_excerpt, scene

from warpdem.simulation import Simulation

GATE = 1e-9
RUPTURE = 0.03912


@pytest.mark.parametrize(
    "name", ["beam6_elastic_undamped", "beam6_elastic_damped", "outer_chain5_spheres"]
)
def test_elastic_bonds_are_repeated_at_equal_dt(name):
    case = read_excerpt(name)

    assert distance(Simulation(as_rockable(case), device="cpu", threads=1), case["rows"]) <= GATE


def test_rupture_comes_at_the_same_step():
    case = read_excerpt("beam6_break")
    simulation = Simulation(as_rockable(case), device="cpu", threads=1)
    before = [row for row in case["rows"] if row[0] < RUPTURE]

    assert len(before) > 0
    assert distance(simulation, before) <= GATE
    simulation.advance(RUPTURE + 0.01)
    broken = simulation.snapshot().breakage
    assert np.flatnonzero(~broken.intact).tolist() == [0]
    assert broken.time[0] == pytest.approx(RUPTURE, abs=0.5 * case["dt"])


def test_default_numerics_converge_to_the_refined_run():
    case = read_excerpt("beam6_elastic_undamped")
    own = case["self_diff_vs_refined_dt"]["4"]["pos"]
    # that program's shear forces keep their direction in space
    asked = scene(case, dt=case["dt"] / 4, friction_frame="fixed")
    simulation = Simulation(asked, device="cpu", threads=1)

    assert distance(simulation, case["finest"]) <= 2.0 * own
