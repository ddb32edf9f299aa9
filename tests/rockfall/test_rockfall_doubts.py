"""Holes in the ground, rocks too large for it, rocks within trunks: what a check warns of."""

from dataclasses import replace

import numpy as np
import pytest
from slopes import ball, bare, box, ground_of, law, plane, random_orientations, starts

from warpdem.checks.rockfall_doubts import gaps, in_trunks, large_rocks, within_trunks
from warpdem.geometry.orientation import matrix
from warpdem.rockfall.facets import facet_ground
from warpdem.rockfall.gaps import enclosed
from warpdem.rockfall.site import Trees

MAZE = """
.......#
.#####..
.#...#.#
.#.#.#.#
.#.#####
.#......
.#######
........
"""


def flooded(known):
    """The same cell by cell."""
    rows, columns = known.shape
    out = {(-1, -1)}
    todo = [(-1, -1)]
    while todo:
        j, i = todo.pop()
        for at in ((j + 1, i), (j - 1, i), (j, i + 1), (j, i - 1)):
            beyond = not (0 <= at[0] < rows and 0 <= at[1] < columns)
            near = -1 <= at[0] <= rows and -1 <= at[1] <= columns
            if near and at not in out and (beyond or not known[at]):
                out.add(at)
                todo.append(at)
    return np.array([[not known[j, i] and (j, i) not in out for i in range(columns)]
                     for j in range(rows)])  # fmt: skip


def test_gaps_are_enclosed_where_only_ground_leads_out():
    maze = np.array([[c == "#" for c in line] for line in MAZE.split()])
    assert not enclosed(~maze).any()
    draw = np.random.default_rng(0)
    for share in (0.3, 0.5, 0.6, 0.7):
        known = draw.random((23, 31)) < share
        assert np.array_equal(enclosed(known), flooded(known))
    assert flooded(known).any()


def test_a_check_counts_the_cells_without_data_amid_the_ground():
    heights = np.zeros((9, 9))
    heights[4, 4] = heights[0, 8] = np.nan  # four cells, and one in the corner
    (text,) = gaps(bare(ground_of(heights), law(0.5)))
    assert text.startswith("4 cells without data lie amid the ground")
    heights[4, 4] = 0.0
    assert not [*gaps(bare(ground_of(heights), law(0.5)))]


def test_rocks_larger_than_cells_are_told_and_those_larger_than_the_reach_are_slow():
    site = bare(plane(size=5, cell=0.5), law(0.5))
    small, wide, huge = ball(0.5), ball(0.75), ball(1.25)
    assert not [*large_rocks(site, [small])]
    coarse, slow = large_rocks(site, [small, wide, huge])
    assert "is 1.5 m across on a terrain of 0.5 m cells" in coarse
    assert "slow" not in coarse
    assert "is 2.5 m across" in slow
    assert "for 1 m around alone, which is slow" in slow


def test_rocks_larger_than_triangles_are_told():
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    site = bare(facet_ground(points, [[0, 1, 2, 3]], np.zeros(3)), law(0.5))
    (text,) = large_rocks(site, [ball(1.5)])
    assert "on triangles of about 1 m" in text


def trunks(*rows):
    """Trunks of x, y, radius, top."""
    table = np.array(rows, float)
    return Trees(table[:, :2], table[:, 2], table[:, 3], np.full(len(table), 0.4))


@pytest.mark.parametrize(
    ("trunk", "meets"),
    [
        ((1.0, 0.0, 0.4, 9.0), False),
        ((0.8, 0.0, 0.4, 9.0), True),
        ((0.8, 0.8, 0.4, 9.0), False),  # within the bounding sphere, beside the corner
        ((0.7, 0.7, 0.4, 9.0), True),
        ((0.0, 0.0, 0.01, 9.0), True),  # inside
        ((0.8, 0.0, 0.4, 1.0), False),  # its top is below
        ((0.0, 0.0, 0.01, 1.0), False),
    ],
)
def test_a_box_overlaps_a_trunk_that_reaches_into_it(trunk, meets):
    found = within_trunks(trunks(trunk, (50, 0, 1, 9)), [box()], starts([0.0, 0.0, 2.0]))
    assert found.tolist() == [meets]


def test_a_ball_overlaps_a_trunk_nearer_than_both_radii():
    trees, begin = trunks((0, 0, 0.5, 9)), starts([[0.99, 0, 2], [1.01, 0, 2], [0.8, 0.8, 2]])
    assert within_trunks(trees, [ball(0.5)], begin).tolist() == [True, False, False]


def test_overlaps_are_those_of_points_inside_the_rock():
    draw = np.random.default_rng(2)
    place = np.column_stack([draw.uniform(-1.5, 1.5, (300, 2)), np.full(300, 2.0)])
    begin = replace(starts(place), orientation=random_orientations(300))
    trees = trunks((0.0, 0.0, 0.3, 9.0))
    cube = draw.uniform(-0.5, 0.5, (20_000, 3))
    found = within_trunks(trees, [box()], begin)
    for turn, at, meets in zip(matrix(begin.orientation), place, found, strict=True):
        away = np.linalg.norm((cube @ turn.T + at)[:, :2], axis=1).min() - 0.3
        assert meets == (away < 0.0) or 0.0 <= away < 0.05  # points miss what is that thin


def test_releases_within_trunks_are_told_with_the_first_place():
    site = replace(bare(plane(size=20), law(0.5)), origin=np.array([2.6e6, 1.2e6, 0.0]))
    begin = replace(
        starts([[9.0, 0, 2], [3.0, 1, 2], [3.1, 1, 2], [3.0, 1, 2]]),
        release=np.array([0, 1, 1, 0], np.int32),
    )
    assert not [*in_trunks(site, [box()], begin, releases=True)]
    site = replace(site, trees=trunks((3.0, 1.0, 0.2, 9.0)))
    first, second = in_trunks(site, [box()], begin, releases=True)
    assert first.startswith("release[0]: 1 of 2 rocks start within a trunk")
    assert (
        "release[1]: 2 of 2 rocks start within a trunk, the first at (2600003.00, 1200001.00)"
        in second
    )
    (bodies,) = in_trunks(site, [box()], begin, releases=False)
    assert bodies.startswith("[[body]]: 3 of 4 rocks")
