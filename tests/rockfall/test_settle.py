"""Rocks set down on a slope and flown from there."""

import numpy as np
import pytest
from releasing import BALL, scene
from slopes import fixed_step, flyer, ground_of, law, plane, site_on

from warpdem.rockfall.flights import MEASURES
from warpdem.rockfall.releases import Releases
from warpdem.rockfall.rocks import rocks_of

BOX = {"name": "box", "kind": "box", "size": [0.6, 0.5, 0.4], "rounding": 0.1}
ROCKS = (BALL, {"name": "box", "kind": "shape", "shape": "box", "mass": 50.0})
AREA = {
    "kind": "area",
    "polygon": [[-9, -9], [9, -9], [9, 9], [-9, 9]],
    "rocks": ["ball", "box"],
}


def waves():
    at = np.arange(-20.0, 21.0)
    x, y = np.meshgrid(at, at)
    return ground_of(-0.7 * x + 0.4 * np.sin(0.9 * x) * np.cos(0.7 * y), -20.0, -20.0)


def depths(ground, height):
    """Of rounded rocks in their first step [m]."""
    made = scene([{**AREA, "height": height}], ROCKS, shape=[BOX])
    site, rocks = site_on(ground, law(0.5)), rocks_of(made)
    starts = Releases(made, site, rocks).starts(np.arange(60))
    end = flyer(site, rocks, fixed_step(1e-3, 1e-3)).fly(starts)
    assert {*starts.rock.tolist()} == {0, 1}
    assert np.all(end.counts[:, 0] + end.counts[:, 1] == 1)
    return end.measures[:, MEASURES.index("depth")]


@pytest.mark.parametrize(
    "ground", [plane((-1.0, 0.0), size=20), plane((-0.6, 0.8), size=20), waves()]
)
def test_rounded_rocks_released_at_no_height_touch_the_ground_and_no_more(ground):
    assert depths(ground, 0.0) == pytest.approx(np.zeros(60), abs=1e-12)
    assert depths(ground, 1e-6).tolist() == [0.0] * 60
