"""Trunks and barriers in a rock's way."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from slopes import (
    HARD,
    G,
    ball,
    box,
    fixed_step,
    flown,
    law,
    plane,
    random_orientations,
    site_on,
    starts,
    throw,
)

from warpdem.errors import UnstableError
from warpdem.rockfall.flights import MEASURES, Fate, Method
from warpdem.rockfall.site import Barrier, Trees


def test_barrier_is_met_where_the_parabola_is():
    line = Barrier("line", np.array([[6.3, -20.0], [6.3, 2.0], [6.3, 30.0]]), np.inf, 0.0)
    _, end = throw(barriers=(line,))
    met = end.crossings

    assert met.barrier.tolist() == [0]
    assert met.time[0] == pytest.approx(1.0, abs=1e-12)
    assert met.position[0] == pytest.approx([6.3, 3.9, 17.0 - 0.5 * G], abs=1e-9)
    assert met.energy[0] == pytest.approx(36 + 3.7**2 + (12.0 - G) ** 2, rel=1e-9)
    assert not met.caught[0]


def test_barrier_that_can_take_the_energy_catches_below_its_height():
    across = np.array([[6.3, -20.0], [6.3, 30.0]])
    low = Barrier("low", across, 3.0, 1e9)
    high = Barrier("high", across + np.array([3.0, 0.0]), 50.0, 1e9)
    _, end = throw(barriers=(high, low))

    assert end.crossings.barrier.tolist() == [1, 0]
    assert end.crossings.caught.tolist() == [False, True]
    assert end.fate[0] == Fate.CAUGHT
    assert end.position[0, 0] == pytest.approx(9.3, abs=1e-9)
    assert end.time[0] == pytest.approx(1.5, abs=1e-9)


def test_barrier_that_breaks_takes_its_capacity_from_the_rock():
    weak = Barrier("weak", np.array([[6.3, -20.0], [6.3, 30.0]]), 50.0, 20.0)
    probe = Barrier("probe", np.array([[6.31, -20.0], [6.31, 30.0]]), np.inf, 0.0)
    method = Method(duration=1.2, skip="none", dt=1e-4, stride=0.0)
    _, end = throw(barriers=(weak, probe), method=method)
    first, second = end.crossings.energy
    climbed = np.diff(end.crossings.position[:, 2])[0]

    assert climbed > 0.0
    assert second == pytest.approx(first - 20.0 - 2.0 * G * climbed, rel=1e-6)


def test_way_along_a_barrier_crosses_each_corner_once():
    # a line of many pieces through which the rock zigzags: parity decides which side it is on
    bend = np.array([[3.0, -20.0], [3.0, 1.0], [9.0, 1.0], [9.0, 30.0]])
    _, end = throw(barriers=(Barrier("bend", bend, np.inf, 0.0),))
    time = np.linspace(0.0, end.time[0], 2_000_001)
    x, y = 0.3 + 6.0 * time, 0.2 + 3.7 * time
    beyond = ((x > 3.0) & (y < 1.0)) | (x > 9.0)

    assert len(end.crossings.id) == np.count_nonzero(np.diff(beyond))


def trunk(x=3.0, radius=0.2, top=10.0):
    return Trees(np.array([[x, 0.0]]), np.array([radius]), np.array([top]), np.array([0.5]))


def test_ball_stops_at_a_trunk_and_flies_over_a_stump():
    method = Method(duration=0.6, dt=1e-4)
    begin = starts([[0.0, 0.0, 4.0]], velocity=[10.0, 0, 0])
    stopped = flown(site_on(plane(size=30), HARD, trees=trunk()), [ball(0.3)], method, begin)
    over = flown(site_on(plane(size=30), HARD, trees=trunk(top=2.0)), [ball(0.3)], method, begin)

    assert stopped.position[0, 0] == pytest.approx(3.0 - 0.2 - 0.3, abs=2e-3)
    assert over.position[0, 0] == pytest.approx(10.0 * over.time[0], rel=1e-12)


def test_thin_trunk_meets_the_edge_between_two_vertices():
    # no vertex of the cube comes near the trunk: its upright face does, by its two level edges
    method = Method(duration=0.5, dt=1e-4)
    begin = starts([[0.0, 0.0, 4.0]], velocity=[10.0, 0, 0])
    site = site_on(plane(size=30), HARD, trees=trunk(radius=0.1))
    end = flown(site, [box((1.0, 1.0, 1.0))], method, begin)

    assert end.position[0, 0] < 3.0 - 0.1 - 0.45


def test_cube_of_any_orientation_is_held_up_by_a_stump_lower_than_itself():
    # it slides at a stump that reaches up to a third of its height, and may tip over it
    count = 60
    turns = random_orientations(count, seed=4)
    level = np.zeros((count, 4))
    angle = np.random.default_rng(5).uniform(0, 2 * pi, count)
    level[:, 0], level[:, 3] = np.cos(angle / 2), np.sin(angle / 2)
    site = site_on(plane(size=30), law(0.0), trees=trunk(top=0.4))
    begin = starts(np.tile([1.2, 0.0, 0.5], (count, 1)), velocity=[6.0, 0, 0])
    upright = flown(site, [box()], Method(duration=0.5), replace(begin, orientation=level))
    high = starts(np.tile([1.2, 0.0, 4.0], (count, 1)), velocity=[6.0, 0, 0])
    tall = site_on(plane(size=30), law(0.0), trees=trunk(top=4.0))
    turned = flown(tall, [box()], Method(duration=0.3), replace(high, orientation=turns))

    free = 1.2 + 6.0 * 0.5
    assert upright.position[:, 0].max() < free - 1.0
    assert turned.position[:, 0].max() < 3.0


def test_contact_with_a_trunk_does_not_depend_on_the_order_of_vertices():
    rock = box((1.0, 0.8, 0.6))
    order = np.array([5, 2, 7, 0, 3, 6, 1, 4])
    back = np.argsort(order)
    other = replace(rock, vertices=rock.vertices[order], edges=back[rock.edges][::-1])
    site = site_on(plane(size=30), HARD, trees=trunk(top=4.1))
    begin = starts([[1.0, 0.1, 4.0]], velocity=[8.0, 0, 0], orientation=(0.8, 0.0, 0.6, 0.0))
    method = Method(duration=0.5)
    ends = [flown(site, [one], method, begin) for one in (rock, other)]

    assert ends[0].counts[0, 0] > 0
    assert ends[1].position[0] == pytest.approx(ends[0].position[0], abs=1e-9)


def test_trunk_gives_nothing_back_and_lifts_nothing():
    bouncy = law(0.5, restitution=0.8)
    begin = starts([[0.0, 0.0, 4.0]], velocity=[10.0, 0, 0])
    smooth = replace(trunk(), friction=np.zeros(1))
    site = site_on(plane(size=30), bouncy, trees=smooth)
    hit = flown(site, [box()], Method(duration=0.5), begin)
    raised = flown(site, [box()], Method(duration=0.5, lift=0.2), begin)

    assert hit.velocity[0, 0] == pytest.approx(0.0, abs=1e-6)
    assert raised.position[0] == pytest.approx(hit.position[0], abs=1e-9)
    assert raised.measures[0, MEASURES.index("depth")] == 0.0


def test_every_rock_is_caught_however_fine_the_terrain_and_long_the_step():
    ground = plane((-0.5, 0.0), size=60, cell=0.05)
    net = Barrier("net", np.array([[1.0, -3.0], [1.0, 3.0]]), 50.0, 1e12)
    coarse = replace(ground.grid, cell=1.0, rows=6, columns=6)
    site = replace(site_on(ground, HARD, barriers=(net,)), results=coarse)
    speed = np.linspace(20.0, 60.0, 50)
    begin = starts(np.tile([-2.0, 0.0, 1.6], (50, 1)))
    begin.velocity[:] = speed[:, None] * [0.9, 0.0, -0.3]
    end = flown(site, [ball(0.1, 2.0)], fixed_step(5e-3, 2.0), begin)

    assert end.fate.tolist() == [Fate.CAUGHT] * 50


def test_behind_a_broken_barrier_no_cell_sees_the_energy_it_took():
    weak = Barrier("weak", np.array([[6.3, -20.0], [6.3, 30.0]]), 50.0, 30.0)
    _, end = throw(barriers=(weak,))
    arrival = float(end.crossings.energy[0])
    column = end.visits.cell % 120 - 60
    behind = end.visits.energy[(column == 7) & (end.visits.jump > 5.0)]
    fall = 2.0 * G * end.measures[0, MEASURES.index("jump")]

    assert len(end.crossings.id) == 1
    assert len(behind) > 0
    assert behind.max() < arrival - 30.0 + 0.25 * fall
    assert end.velocity[0, 0] == pytest.approx(6.0 * np.sqrt(1.0 - 30.0 / arrival), rel=1e-6)


def test_barriers_of_many_corners_are_each_met_once_by_many_rocks():
    # rocks thrown across a zigzag, broken at every piece: crossings alternate from side to side
    corners = [[x, (-1.0) ** k * 4.0] for k, x in enumerate(np.arange(2.0, 14.0, 1.0))]
    probe = Barrier("zigzag", np.array(corners), np.inf, 0.0)
    angles = np.linspace(-0.6, 0.6, 40)
    begin = starts(np.tile([0.3, 0.0, 5.0], (40, 1)))
    begin.velocity[:] = np.column_stack([8 * np.cos(angles), 8 * np.sin(angles), 0 * angles + 9.0])
    site = site_on(plane(size=40), law(0.5), barriers=(probe,))
    end = flown(site, [ball(0.1, 2.0)], Method(duration=1.2), begin)
    for number in range(40):
        met = end.crossings.time[end.crossings.id == number]
        time = np.linspace(0.0, end.time[number], 4001)
        x = 0.3 + begin.velocity[number, 0] * time
        y = begin.velocity[number, 1] * time
        line = np.interp(x, *np.array(corners).T)
        inside = (x > 2.0) & (x < 13.0)
        sides = np.sign(y - line)[inside]
        assert len(met) == np.count_nonzero(np.diff(sides))


def test_a_motion_that_is_not_finite_is_an_error_and_harms_no_other():
    site = site_on(plane(size=30), HARD)
    begin = starts([[0.0, 0.0, 4.0], [1.0, 0.0, 0.5]], velocity=[1.0, 0, 0])
    begin.velocity[0] = np.nan

    with pytest.raises(UnstableError, match="trajectory 0"):
        flown(site, [box()], Method(duration=1.0), begin)
