"""A rebound is as elastic as asked, however many sub-contacts share it."""

import pytest
import restitution


@pytest.mark.parametrize("asked", [0.2, 0.8])
@pytest.mark.parametrize(
    ("pose", "count"),
    [
        ("plane, face", 4),
        ("plane, edge", 2),
        ("plane, oblique corner", 1),
        ("cube, face aligned (8)", 8),
        ("cube, face yaw 1e-6 (12)", 12),
        ("cube, face yaw .3 (8)", 8),
        ("cube, oblique corner", 1),
    ],
)
def test_cube_rebounds_as_asked(pose, count, asked):
    got, most = restitution.delivered(restitution.POSES[pose], asked)
    assert most == count
    assert got == pytest.approx(asked, abs=0.005)
