"""Forest, trunks and names on the map."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from slopes import bare, law, plane

from warpdem.output.map_cover import cover, names
from warpdem.output.relief import Window
from warpdem.rockfall.site import Barrier, Trees


@pytest.fixture
def axes():
    return Figure().subplots()


@pytest.fixture
def site():
    return bare(plane(size=10), law(0.5))


def labels(axes):
    return axes.get_legend_handles_labels()[1]


def test_bare_ground_has_no_entries(axes, site):
    cover(axes, site)
    cover(axes, replace(site, stand_of=np.full((20, 20), -1)))
    assert labels(axes) == []


def test_forest_and_trunks_are_in_the_legend(axes, site):
    stand_of = np.full((20, 20), -1)
    stand_of[3:8, 5:] = 0  # to the edge of the ground
    one = np.ones(1)
    cover(axes, replace(site, stand_of=stand_of, trees=Trees(np.zeros((1, 2)), one, one, one)))
    assert sorted(labels(axes)) == ["forest", "trunks"]


def test_names_of_barriers_that_end_together_are_drawn_apart(axes, site):
    line = np.array([[0.0, -5.0], [0.0, 5.0]])
    barriers = tuple(Barrier(name, line, 2.0, 1e5) for name in ("upper", "lower"))
    names(axes, replace(site, barriers=barriers), Window(-10.0, 10.0, -10.0, 10.0), "blue")
    first, second = (text.xy for text in axes.texts)
    assert abs(first[1] - second[1]) > 0.5
