"""What finds jumps of the stored energy along sweeps, where the answer is known."""

import numpy as np
import pytest
from sweeps import CUBE, Pair, about, balance_error, jumps, line, slope_error, turning

BALL = {"kind": "sphere", "radius": 0.5}


def test_ball_over_a_face_stores_half_its_overlap_squared_without_jumps():
    pair = Pair(BALL, CUBE)
    assert jumps(pair, line([-0.1, 0.1, 0.98], [0.1, 0.15, 0.9]), 50) == []
    overlap = 0.03
    held = pair.at([0.1, 0.1, 1.0 - overlap])
    assert held.energy == pytest.approx(0.5 * overlap**2, rel=1e-12)
    assert held.force == pytest.approx([0.0, 0.0, overlap], rel=1e-12)


def test_sum_counts_a_ball_over_a_face_and_its_border_edge_twice_and_jumps_where_the_face_ends():
    overlap = 0.05
    path = line([0.3, 0.1, 1.0 - overlap], [0.5, 0.1, 1.0 - overlap])
    (jump,) = jumps(Pair(BALL, CUBE, partnership="sum"), path, 50)
    assert jump.at == pytest.approx(0.5, abs=1e-9)
    assert jump.energy == pytest.approx(-0.5 * overlap**2, rel=1e-6)
    assert jump.force == pytest.approx(overlap, rel=1e-6)


def test_sum_counts_corners_of_aligned_cubes_once_more_than_when_one_is_turned():
    pair = Pair(CUBE, CUBE, partnership="sum")
    found = jumps(pair, turning([0.0, 0.0, 0.95], [0.0, 0.0, 1.0], [-0.3, 0.3]), 100)
    assert [jump.share for jump in found] == pytest.approx([0.2, 0.2], rel=1e-6)
    assert [jump.energy > 0.0 for jump in found] == [False, True]


def test_wrench_is_the_slope_of_the_energy_and_is_balanced():
    pair = Pair(CUBE, CUBE)
    place = [0.45, 0.1, 1.08], about([1.0, 0.3, -0.2], 0.7)
    assert slope_error(pair, *place) < 1e-8
    held = pair.at(*place)
    force, torque = balance_error(held)
    assert max(force, torque) <= 1e-15
    assert np.linalg.norm(held.torque) > 1e-3
