"""Solids that are not convex: what lies in their hollows is outside of them."""

import numpy as np
import pytest

from warpdem import Scene, Simulation

CHANNEL = [(-0.5, 0), (0.5, 0), (0.5, 1), (0.4, 1), (0.4, 0.1), (-0.4, 0.1), (-0.4, 1), (-0.5, 1)]
BRACKET = [(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)]
BALL = 0.05
ROUNDING = 0.005


def prism(outline):
    """A prism one metre long in y over an outline in x and z."""
    count = len(outline)
    vertices = [(x, y, z) for y in (-0.5, 0.5) for x, z in outline]
    sides = [[k, (k + 1) % count, count + (k + 1) % count, count + k] for k in range(count)]
    ends = [list(range(count))[::-1], list(range(count, 2 * count))]
    return {"vertices": vertices, "faces": [*ends, *sides]}


def dropped(outline, start):
    """A ball let go at ``start`` over a fixed prism, a second later."""
    scene = Scene.model_validate(
        {
            "run": {"duration": 1.0},
            "shape": [
                {"kind": "polyhedron", "name": "solid", "rounding": ROUNDING, **prism(outline)},
                {"kind": "sphere", "name": "ball", "radius": BALL},
            ],
            "body": [
                {"shape": "solid", "group": "wall", "position": [0, 0, 0], "fixed": True},
                {"shape": "ball", "group": "ball", "position": start, "density": 2500.0},
            ],
            "contact": [{"groups": ["wall", "ball"], "kn": 1e5, "kt": 8e4, "en2": 0.05, "mu": 0.4}],
        }
    )
    simulation = Simulation(scene, threads=1)
    simulation.advance(1.0)
    assert simulation.notes == []
    return simulation.snapshot().position[1]


@pytest.mark.parametrize("x", [-0.3, 0.0, 0.34])
def test_a_ball_in_a_channel_falls_straight_to_its_floor(x):
    position = dropped(CHANNEL, [x, 0, 0.3])

    assert position[:2] == pytest.approx([x, 0.0], abs=1e-12)
    assert position[2] == pytest.approx(0.1 + ROUNDING + BALL, abs=1e-3)


def test_a_ball_in_the_notch_of_a_bracket_rests_on_its_ledge():
    position = dropped(BRACKET, [0.5, 0, 0.6])

    np.testing.assert_allclose(position, [0.5, 0.0, 0.3 + ROUNDING + BALL], atol=1e-3)
