import numpy as np
import pytest
from grids import waves, write_asc

from warpdem.errors import GeometryError
from warpdem.geometry.terrain import raster_of, read_raster
from warpdem.rockfall.heights import (
    corner_slope,
    height_at,
    origin_of,
    raster_ground,
    slopes_at,
)

EAST, NORTH = 2790123.375, 1180456.625


def ground_of(raster):
    return raster_ground(raster, origin_of(raster.x, raster.y, raster.heights))


def test_national_coordinates_lose_nothing():
    heights = waves(40, 30) + 0.123456789
    raster = raster_of(heights, EAST, NORTH, 0.5)
    origin = origin_of(raster.x, raster.y, raster.heights)
    ground = raster_ground(raster, origin)
    assert (origin == np.floor(origin)).all()
    assert (ground.grid.x, ground.grid.y) == (0.375, 0.625)
    x, y = 0.375 + 0.5 * np.arange(30), 0.625 + 0.5 * np.arange(40)
    local = height_at(ground, x[None, :], y[::-1, None])
    assert np.abs(local + origin[2] - heights).max() < 1e-9
    # the same ground laid at zero has the same heights everywhere
    near = raster_ground(raster_of(heights, 0.375, 0.625, 0.5), np.array([0.0, 0.0, origin[2]]))
    rng = np.random.default_rng(3)
    place = rng.uniform(1.0, 14.0, (1000, 2))
    far, here = (height_at(g, place[:, 0], place[:, 1]) for g in (ground, near))
    assert np.abs(far - here).max() < 1e-9
    assert (far == here).all()


def test_heights_are_those_of_the_nodes_and_their_mean_amid_a_cell():
    ground = ground_of(raster_of(np.array([[3.0, 5.0], [1.0, 7.0]]), 0.0, 0.0, 2.0))
    assert ground.grid.rows == ground.grid.columns == 1
    x, y = np.array([0.0, 2.0, 0.0, 2.0, 1.0]), np.array([0.0, 0.0, 2.0, 2.0, 1.0])
    assert (ground.height(x, y) == np.array([1.0, 7.0, 3.0, 5.0, 4.0]) - 1.0).all()


def test_there_is_no_height_beside_the_raster():
    ground = ground_of(raster_of(np.zeros((3, 3)), 0.0, 0.0, 1.0))
    assert np.isnan(ground.height(np.array([-1e-9, 2.001, 1.0]), np.array([1.0, 1.0, -0.1]))).all()


def test_heights_between_nodes_are_bilinear():
    x, y = np.meshgrid(np.arange(8.0), np.arange(6.0)[::-1])
    ground = ground_of(raster_of(2.0 * x - 3.0 * y + 0.25 * x * y + 50.0, 0.0, 0.0, 1.0))
    at = np.random.default_rng(1).uniform(0.0, 5.0, (200, 2))
    exact = 2.0 * at[:, 0] - 3.0 * at[:, 1] + 0.25 * at[:, 0] * at[:, 1] + 50.0
    base = np.floor((2.0 * x - 3.0 * y + 0.25 * x * y + 50.0).min())
    assert ground.height(at[:, 0], at[:, 1]) + base == pytest.approx(exact, abs=1e-12)


def test_nodes_lie_at_the_corner_or_in_the_centre_of_their_cell(tmp_path):
    file = tmp_path / "t.asc"
    write_asc(file, np.ones((3, 4)), x=100.0, y=200.0, cell=10.0)
    assert read_raster(file).x[0] == read_raster(file, "corner").x[0] == 100.0
    centred = read_raster(file, "centre")
    assert (centred.x[0], centred.y[-1], centred.y[0]) == (105.0, 205.0, 225.0)
    write_asc(file, np.ones((3, 4)), x=100.0, y=200.0, cell=10.0, corner="center")
    assert read_raster(file, "centre").x[0] == read_raster(file, "corner").x[0] == 100.0


def test_tabs_and_broken_lines_of_an_asc_are_read(tmp_path):
    file = tmp_path / "t.asc"
    file.write_text("NCOLS\t2\nNROWS\t2\nXLLCORNER\t0\nYLLCORNER\t0\nCELLSIZE\t1\n1 2 3\n4\n")
    assert read_raster(file).heights.tolist() == [[1.0, 2.0], [3.0, 4.0]]


@pytest.mark.parametrize(
    ("key", "value"),
    [("ncols", "2.5"), ("nrows", "-2"), ("ncols", "nan"), ("nrows", "inf"), ("cellsize", "inf")],
)
def test_a_header_of_impossible_numbers_is_refused(tmp_path, key, value):
    file = tmp_path / "t.asc"
    header = {"ncols": "2", "nrows": "2", "xllcorner": "0", "yllcorner": "0", "cellsize": "1"}
    lines = [f"{name} {number}" for name, number in (header | {key: value}).items()]
    file.write_text("\n".join([*lines, "1 2", "3 4"]))
    with pytest.raises(GeometryError, match=f"{key} must be"):
        read_raster(file)


def test_cells_beside_a_gap_are_unknown():
    heights = np.zeros((6, 6))
    heights[2, 3] = np.nan  # the fourth row from the south
    ground = ground_of(raster_of(heights, 0.0, 0.0, 1.0))
    gap = np.zeros((5, 5), bool)
    gap[2:4, 2:4] = True
    assert (ground.known == ~gap).all()
    assert (ground.steep == 0.0).all()


def test_a_raster_without_data_is_refused():
    with pytest.raises(GeometryError, match="nothing but nodata"):
        ground_of(raster_of(np.full((3, 3), np.nan), 0.0, 0.0, 1.0))
    sparse = np.full((3, 3), np.nan)
    sparse[0, 0] = sparse[2, 2] = 1.0
    with pytest.raises(GeometryError, match="four corners"):
        ground_of(raster_of(sparse, 0.0, 0.0, 1.0))


def test_a_patch_is_steepest_at_a_corner():
    heights = waves(6, 7, seed=5)
    slope = corner_slope(heights, 2.0)
    a, b = np.linspace(0.0, 1.0, 21)[:, None, None, None], np.linspace(0.0, 1.0, 21)[:, None, None]
    z00, z01, z10, z11 = heights[:-1, :-1], heights[:-1, 1:], heights[1:, :-1], heights[1:, 1:]
    along_x = (1 - b) * (z01 - z00) + b * (z11 - z10)
    along_y = (1 - a) * (z10 - z00) + a * (z11 - z01)
    sampled = np.hypot(along_x, along_y).max(axis=(0, 1)) / 2.0
    assert sampled == pytest.approx(slope, rel=1e-12)


def test_steep_bounds_every_rise_within_reach():
    heights = waves(40, 40, seed=2)
    heights[10:13, 20:24] = np.nan
    ground = ground_of(raster_of(heights, 0.0, 0.0, 1.0))
    rng = np.random.default_rng(4)
    start = rng.uniform(0.0, 39.0, (40_000, 2))
    angle, length = rng.uniform(0.0, 2.0 * np.pi, 40_000), rng.uniform(1e-3, ground.reach, 40_000)
    end = start + length[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    cell = ground.grid.index(start[:, 0], start[:, 1])
    rise = np.abs(ground.height(*end.T) - ground.height(*start.T))
    bounded = rise <= ground.steep.reshape(-1)[cell] * length + 1e-12
    # across a gap there is no ground whose slope could be known
    far = np.hypot(start[:, 0] - 21.5, start[:, 1] - 28.0) > 7.0
    assert (bounded | np.isnan(rise) | ~far).all()
    assert np.isfinite(rise[far]).mean() > 0.9


def test_slopes_are_those_of_the_patch_under_a_point():
    rng = np.random.default_rng(6)
    ground = ground_of(raster_of(waves(7, 9, seed=8), EAST, NORTH, 2.0))
    cell, inside = rng.integers(0, [8, 6], (500, 2)), rng.uniform(0.1, 0.9, (500, 2))
    x, y = (np.array([ground.grid.x, ground.grid.y]) + 2.0 * (cell + inside)).T
    step = 0.05  # a patch is linear along each axis
    along_x, along_y = slopes_at(ground, x, y)
    rise = ground.height(x + step, y) - ground.height(x - step, y)
    assert along_x == pytest.approx(rise / (2 * step), abs=1e-10)
    rise = ground.height(x, y + step) - ground.height(x, y - step)
    assert along_y == pytest.approx(rise / (2 * step), abs=1e-10)
    assert np.isnan(slopes_at(ground, np.array([-1.0]), np.array([1.0]))).all()
    steepest = ground.steep.reshape(-1)[ground.grid.index(x, y)]
    assert np.all(np.hypot(along_x, along_y) <= steepest * (1 + 1e-12))


def test_slopes_have_the_shape_of_the_points():
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0))
    ground = ground_of(raster_of(2.0 * x + 3.0 * y[::-1], 0.0, 0.0, 1.0))
    along_x, along_y = slopes_at(ground, x, y)
    assert (along_x == np.full(x.shape, 2.0)).all()
    assert (along_y == np.full(x.shape, 3.0)).all()
