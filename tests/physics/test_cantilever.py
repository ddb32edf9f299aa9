"""A cantilever of bonded cubes against its closed forms; all cases in tools/bench/analytic.py."""

import numpy as np
import pytest
from beams import Beam, root_force

COUNT, SIDE, KN, KT = 3, 0.1, 1e7, 5e6
GRAVITY = 0.1


@pytest.fixture(scope="module")
def beam():
    return Beam(COUNT, SIDE, KN, KT)


def test_tip_sinks_under_the_weight_as_bending_and_shear_let_it(beam):
    measured = beam.at_rest(
        lambda shot: np.append(beam.tip(shot), root_force(shot)),
        periods=12,
        gravity=(0.0, 0.0, -GRAVITY),
    )
    weight = beam.mass * GRAVITY
    # the interface k sides from the root, 0 <= k < n, bears what lies beyond it
    beyond = COUNT - np.arange(COUNT)
    moment = weight * SIDE * beyond**2 / 2.0
    bending = np.sum(moment * beyond * SIDE) / (KN * SIDE**2)
    shear = np.sum(weight * beyond) / (4.0 * KT)

    assert -measured[2] == pytest.approx(bending + shear, rel=1e-4)
    # four bonds at half a side from the middle
    assert measured[3] == pytest.approx(moment[0] / (2.0 * SIDE), rel=1e-4)


def test_first_bending_mode_swings_at_its_frequency(beam):
    omega, shapes = beam.bending()
    weights = np.repeat([beam.mass, beam.mass * SIDE**2 / 6.0], COUNT)
    got = beam.frequency(shapes[:, 0], weights, along=2, expected=omega[0], periods=6)

    assert got == pytest.approx(omega[0], rel=5e-3)


def test_a_beam_drawn_evenly_breaks_at_its_strength(beam):
    strength, n = 1000.0, COUNT + 1
    strain = strength / KN
    speed = 0.02 * strain * n * beam.axial()[0][-1]
    velocity = [[speed * k / n, 0.0, 0.0] for k in range(n + 1)]
    simulation = beam.run(motion=(velocity, [[0.0] * 3] * (n + 1)), bond={"fn0": strength}, ends=1)
    simulation.advance(1.2 * strain * n / speed)
    broken = simulation.snapshot().breakage
    late = np.nanmin(broken.time) - strain * n / speed

    assert 0.0 <= late <= simulation.dt * (1.0 + 1e-6)
    assert not broken.intact.any()
