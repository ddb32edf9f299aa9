"""What happens to rocks on their way: cells, barriers, trees, forest, soil, the end."""

from dataclasses import fields, replace
from math import exp, sqrt
from pathlib import Path

import numpy as np
import pytest
from slopes import (
    HARD,
    G,
    ball,
    bare,
    box,
    box_skin,
    fixed_step,
    flown,
    flyer,
    ground_of,
    law,
    plane,
    random_orientations,
    site_on,
    starts,
    throw,
)

import warpdem
from warpdem.rockfall.flights import COUNTS, MEASURES, Fate, Method
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.site import Facets, Ground, Stand
from warpdem.rockfall.trajectories import Stopped

SCENES = Path(__file__).resolve().parents[2] / "scenes"


def waves(slope=-0.7, size=40, cell=2.5):
    """A rough slope."""
    at = cell * np.arange(-size, size + 1)
    x, y = np.meshgrid(at, at)
    z = slope * x + 0.4 * np.sin(0.9 * x) * np.cos(0.7 * y) + 0.3 * np.sin(0.31 * y)
    return ground_of(z, -size * cell, -size * cell, cell)


def tumbling(count=24, seed=1):
    """Boxes above the rough slope, in random orientation."""
    rng = np.random.default_rng(seed)
    at = np.column_stack([rng.uniform(-60, -40, count), rng.uniform(-9, 9, count)])
    ground = waves().height(at[:, 0], at[:, 1])
    begin = starts(np.column_stack([at, ground + 1.5]), velocity=(2.0, 0.3, 0.0))
    return replace(begin, orientation=random_orientations(count, seed))


def rows(record):
    """All arrays of a record, by name."""
    return {field.name: getattr(record, field.name) for field in fields(record)}


def assert_same(first, second):
    for name, value in rows(first).items():
        other = getattr(second, name)
        if isinstance(value, np.ndarray):
            assert np.array_equal(value, other), name
        else:
            assert_same(value, other)


@pytest.fixture(scope="module")
def bundle():
    """Boxes on the rough slope, and their ends."""
    site = site_on(waves(), HARD)
    rocks = [box((0.8, 0.6, 0.5), 400.0), box((0.5, 0.5, 0.5), 200.0)]
    begin = tumbling()
    begin = replace(begin, rock=(np.arange(len(begin.id)) % 2).astype(np.int32))
    method = Method(duration=12.0)
    return site, rocks, method, begin, flown(site, rocks, method, begin)


def test_results_do_not_depend_on_slots_nor_on_passes_of_a_launch(bundle):
    site, rocks, method, begin, whole = bundle

    assert_same(flown(site, rocks, method, begin, slots=5, passes=37), whole)


def test_results_do_not_depend_on_which_rocks_fly_together(bundle):
    site, rocks, method, begin, whole = bundle
    some = np.array([17, 3, 8])
    part = flown(site, rocks, method, type(begin)(**{k: v[some] for k, v in rows(begin).items()}))

    assert np.array_equal(part.position, whole.position[some])
    assert np.array_equal(part.spin, whole.spin[some])
    assert np.array_equal(part.measures, whole.measures[some])
    mine = np.isin(whole.visits.id, some)
    assert len(part.visits.id) == mine.sum()


def test_bounding_sphere_skips_vertices_without_changing_anything(bundle):
    site, rocks, method, begin, _ = bundle
    every = flown(site, rocks, replace(method, skip="none"), begin, fused=False)
    skipped = flown(site, rocks, replace(method, skip="sphere"), begin, fused=False)

    assert np.array_equal(every.position, skipped.position)
    assert np.array_equal(every.visits.energy, skipped.visits.energy)


def test_no_step_creates_energy_beyond_g_dt(bundle):
    *_, end = bundle

    assert end.measures[:, MEASURES.index("gain")].max() < 5e-4 * G * 5e-3 * 10
    assert end.counts[:, COUNTS.index("contact_steps")].sum() > 1000
    assert end.counts[:, COUNTS.index("dropped")].sum() == 0


def test_unconverged_steps_are_rare_and_counted(bundle):
    *_, end = bundle
    counts = dict(zip(COUNTS, end.counts.sum(axis=0), strict=True))

    assert counts["unconverged"] <= 0.002 * counts["contact_steps"]
    assert counts["limited"] <= counts["unconverged"]


def test_what_no_rock_comes_near_changes_nothing(bundle):
    site, rocks, method, begin, _ = bundle
    furnished = flown(site, rocks, method, begin, fused=False)

    assert_same(flown(bare(waves(), HARD), rocks, method, begin, fused=False), furnished)


def test_following_a_rock_ends_where_it_fell(bundle):
    site, rocks, method, begin, whole = bundle
    one = type(begin)(**{k: v[:1] for k, v in rows(begin).items()})
    way = flyer(site, rocks, method).follow(one, 0.05)[0]

    assert np.array_equal(way.position[-1], whole.position[0])
    assert way.time[-1] == whole.time[0]
    assert np.all(np.diff(way.time)[:-1] >= 0.05)


@pytest.mark.parametrize("finer", [1, 4])
def test_no_cell_below_a_parabola_is_left_out(finer):
    grid = plane(size=60).grid
    fine = replace(
        grid, cell=grid.cell / finer, rows=grid.rows * finer, columns=grid.columns * finer
    )
    _, end = throw(results=fine)
    time = np.linspace(0.0, end.time[0], 200_001)
    x, y = 0.3 + 6.0 * time, 0.2 + 3.7 * time
    z = 5.0 + 12.0 * time - 0.5 * G * time**2
    cell = fine.index(x, y)
    first = np.flatnonzero(np.diff(cell, prepend=-2))

    assert end.counts[0, COUNTS.index("jumps")] < 30
    assert end.visits.cell.tolist() == cell[first].tolist()
    highest = np.maximum.reduceat(z, first)
    assert end.visits.jump == pytest.approx(highest, abs=2e-2)
    speed = np.maximum.reduceat(np.sqrt(36 + 3.7**2 + (12.0 - G * time) ** 2), first)
    assert end.visits.speed == pytest.approx(speed, rel=1e-4)
    assert end.visits.energy == pytest.approx(0.5 * 2.0 * end.visits.speed**2, rel=1e-5)


def test_border_is_crossed_by_steps_shorter_than_rounding_shows():
    # far from the origin a step of 1e-13 m is a few units in the last place
    begin = starts([[55.0 - 2e-13, 0.5, 0.5]], velocity=[2e-11, 0, 0])
    end = flown(site_on(plane(size=60), law(0.0)), [ball()], fixed_step(5e-3, 0.2), begin)

    assert end.position[0, 0] > 55.0
    assert end.visits.cell.tolist() == [60 * 120 + 114, 60 * 120 + 115]


def forest(drag, height):
    """Site under trees everywhere."""
    ground = plane(size=60)
    stand = np.zeros((ground.grid.rows, ground.grid.columns), np.int32)
    return site_on(ground, HARD, stands=(Stand(drag, height),), stand_of=stand)


def test_forest_slows_exponentially_below_its_canopy():
    begin = starts([[0.0, 0.0, 30.0]], velocity=[10.0, 0, 0])
    method = Method(duration=1.0 - 1e-3, dt=1e-2, stride=0.0)
    end = flown(forest(250.0, 100.0), [ball(0.3, 500.0)], method, begin)
    above = flown(forest(250.0, 10.0), [ball(0.3, 500.0)], method, begin)
    k, t = 0.5, end.time[0]

    assert end.velocity[0, 0] == pytest.approx(10.0 * exp(-k * t), rel=1e-12)
    assert end.velocity[0, 2] == pytest.approx(-G / k * (1.0 - exp(-k * t)), rel=1e-12)
    assert end.position[0, 0] == pytest.approx(10.0 / k * (1.0 - exp(-k * t)), rel=1e-12)
    assert above.velocity[0, 0] == 10.0


def test_rock_sinks_into_the_scarring_layer_by_lus_formula():
    # d = 0.1 M^(1/3) M_E^(-0.4) |v|^0.8; without drag it meets the hard ground there
    soil = law(0.5, scar_modulus=500.0, scar_drag=-1.0)
    speed = sqrt(2 * G * 5.0)
    depth = 0.1 * 780.0 ** (1 / 3) * 500.0**-0.4 * speed**0.8
    begin = starts([[0, 0, 5.6 + 5e-4]])
    method = fixed_step(1e-4, 1.4, skip="none")
    way = flyer(site_on(plane(), soil), [ball(0.6, 780.0)], method).follow(begin, 0.0)[0]

    assert 0.6 - way.position[:, 2].min() == pytest.approx(depth, rel=0.01)


def test_soil_slows_a_rock_before_it_meets_the_hard_ground():
    # F = (C_f + C_s) rho A v^2 / 2 over the depth of the layer, A the immersed part
    begin = starts([[0, 0, 3.0]], velocity=[0, 0, -12.0])
    method = fixed_step(1e-4, 1.0, skip="none")
    speeds = []
    for drag in (-1.0, 2.0):
        soil = law(0.5, scar_modulus=200.0, scar_drag=drag)
        way = flyer(site_on(plane(), soil), [box((1, 1, 1), 900.0)], method)
        way = way.follow(begin, 0.0)[0]
        below = way.position[:, 2] < 0.5 - 0.1
        speeds.append(-way.velocity[below, 2][0])
    entry = sqrt(144 + 2 * G * 2.5)
    # dv/dz = -(C rho A / 2 m) v for a face of 1 m^2: v decays over depth
    decay = 0.5 * 3.0 * 1700.0 / 900.0

    assert speeds[0] == pytest.approx(sqrt(144 + 2 * G * 2.6), rel=1e-3)
    assert speeds[1] == pytest.approx(entry * exp(-decay * 0.1), rel=3e-2)


def test_lift_raises_a_sunken_rock_without_energy():
    method = Method(duration=4.0, dt=1e-2, stride=0.0)
    ground = waves()
    plain = flown(site_on(ground, HARD), [box((0.8, 0.6, 0.5))], method, tumbling())
    raised = flown(
        site_on(ground, HARD), [box((0.8, 0.6, 0.5))], replace(method, lift=0.2), tumbling()
    )

    assert raised.measures[:, MEASURES.index("lifted")].max() > 0.0
    assert plain.measures[:, MEASURES.index("lifted")].max() == 0.0
    gain = MEASURES.index("gain")
    assert raised.measures[:, gain].max() <= max(plain.measures[:, gain].max(), 5e-3)


def triangles_of(raster):
    """The same plane as triangles."""
    grid = raster.grid
    x = grid.x + grid.cell * np.arange(grid.columns + 1)
    y = grid.y + grid.cell * np.arange(grid.rows + 1)
    points = np.column_stack([*(c.ravel() for c in np.meshgrid(x, y)), raster.heights.ravel()])
    corner = np.arange(grid.rows * (grid.columns + 1)).reshape(grid.rows, -1)[:, :-1].ravel()
    up = grid.columns + 1
    lower = np.column_stack([corner, corner + 1, corner + up + 1])
    upper = np.column_stack([corner, corner + up + 1, corner + up])
    triangles = np.stack([lower, upper], axis=1).reshape(-1, 3)
    count = grid.rows * grid.columns
    facets = Facets(points, triangles, 2 * np.arange(count + 1), np.arange(2 * count))
    return Ground(grid, None, facets, raster.known, raster.steep, raster.reach)


def test_triangles_of_a_plane_act_as_the_raster_does():
    ground = plane((-0.4, 0.1), size=30)
    begin = starts([[-10.0, 0.0, 6.0]], velocity=[1, 0, 0], spin=[0.3, 2.0, 0.1])
    method = Method(duration=1.5)
    raster = flown(site_on(ground, HARD), [box()], method, begin)
    mesh = flown(site_on(triangles_of(ground), HARD), [box()], method, begin)

    assert raster.counts[0, 0] > 20
    assert mesh.position[0] == pytest.approx(raster.position[0], abs=1e-8)


def test_rock_that_leaves_the_ground_and_one_that_flies_over_a_hole_have_left():
    begin = starts([[0.3, 0.2, 5.0]], velocity=[20.0, 0, 10.0])
    ground = plane(size=20)
    far = flown(site_on(ground, HARD), [ball()], Method(60.0), begin)
    heights = ground.heights.copy()
    heights[18:24, 30] = np.nan
    holed = ground_of(heights, ground.grid.x, ground.grid.y)
    near = flown(site_on(holed, HARD), [ball()], Method(60.0), begin)

    assert far.fate[0] == near.fate[0] == Fate.LEFT
    assert 20.0 <= far.position[0, 0] < 20.2
    assert 9.0 <= near.position[0, 0] < 9.2


def test_trajectory_ends_at_its_longest_time():
    end = flown(site_on(plane(), law(0.0)), [ball()], Method(2.0), starts([[0, 0, 0.5]], [1, 0, 0]))

    assert end.fate[0] == Fate.TIMEOUT
    assert 2.0 <= end.time[0] < 2.01


def test_contacts_beyond_the_room_are_counted():
    angle = 2 * np.pi * np.arange(40) / 40
    rim = np.column_stack([np.cos(angle), np.sin(angle), np.full(40, -0.1)])
    disc = Rock("disc", rim, 0.0, np.array([[0, 1]]), 1.0, np.ones(3), *box_skin((1, 1, 1)))
    end = flown(
        site_on(plane(), HARD), [disc], fixed_step(1e-3, 0.01), starts([[0, 0, 0.1 - 1e-6]])
    )

    assert end.counts[0, COUNTS.index("dropped")] >= 24


def test_a_simulation_refuses_a_rockfall_scene():
    scene = warpdem.load(SCENES / "rockfall_tschamut.toml")

    with pytest.raises(warpdem.WarpdemError, match=r"warpdem\.run"):
        warpdem.Simulation(scene)


def test_bundle_is_given_up_when_asked(bundle):
    site, rocks, method, begin, _ = bundle

    with pytest.raises(Stopped):
        flyer(site, rocks, method, passes=10).fly(begin, stop=lambda: True)
