import sys

import numpy as np
import pytest
from grids import waves, write_asc

from warpdem.errors import GeometryError, WarpdemError
from warpdem.geometry.terrain import raster_of
from warpdem.rockfall.cover import inside, read_outlines, values_under
from warpdem.rockfall.raster_files import raster_at, value_at
from warpdem.rockfall.site import Grid

SQUARE = np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0]])
HOLE = np.array([[3.0, 3.0], [7.0, 3.0], [7.0, 7.0], [3.0, 7.0]])


def write_tif(path, heights, *, west=2790000.0, north=1180100.0, cell=2.0, **other):
    rasterio = pytest.importorskip("rasterio")
    place = rasterio.Affine(*other.pop("transform", (cell, 0.0, west, 0.0, -cell, north)))
    rows, columns = heights.shape
    profile = {"crs": "EPSG:2056", "nodata": -9999.0, "dtype": "float64", "count": 1, **other}
    with rasterio.open(
        path, "w", "GTiff", height=rows, width=columns, transform=place, **profile
    ) as file:
        for band in range(profile["count"]):
            file.write(np.where(np.isnan(heights), -9999.0, heights), band + 1)


def test_a_geotiff_keeps_heights_place_and_reference_system(tmp_path):
    heights = waves(5, 4)
    heights[1, 2] = np.nan
    write_tif(tmp_path / "t.tif", heights)
    raster = raster_at(tmp_path / "t.tif")
    assert raster.crs == "EPSG:2056"
    assert np.array_equal(raster.heights, heights, equal_nan=True)
    assert (raster.x[0], raster.y[0], raster.y[-1]) == (2790001.0, 1180099.0, 1180091.0)
    assert raster_at(tmp_path / "t.tif", "corner").x[0] == 2790000.0


def test_a_geotiff_and_an_asc_of_the_same_heights_are_the_same_raster(tmp_path):
    heights = waves(5, 4)
    write_tif(tmp_path / "t.tif", heights)
    write_asc(tmp_path / "t.asc", heights, x=2790000.0, y=1180090.0, cell=2.0)
    one, other = (raster_at(tmp_path / name) for name in ("t.tif", "t.asc"))
    assert all(np.array_equal(getattr(one, k), getattr(other, k)) for k in ("x", "y", "heights"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"transform": (2.0, 0.5, 0.0, 0.5, -2.0, 9.0)}, "rotated"),
        ({"transform": (2.0, 0.0, 0.0, 0.0, 2.0, 9.0)}, "mirrored"),
        ({"transform": (2.0, 0.0, 0.0, 0.0, -3.0, 9.0)}, "2 by 3, they must be square"),
        ({"count": 2}, "2 bands"),
        ({"crs": "EPSG:4326"}, "degrees"),
    ],
)
def test_a_geotiff_that_is_no_upright_square_grid_of_metres_is_refused(tmp_path, change, message):
    write_tif(tmp_path / "t.tif", waves(4, 4), **change)
    with pytest.raises(GeometryError, match=message):
        raster_at(tmp_path / "t.tif")


def test_what_is_no_geotiff_is_named(tmp_path):
    pytest.importorskip("rasterio")
    (tmp_path / "t.tif").write_text("nonsense")
    with pytest.raises(GeometryError, match="cannot be read as a GeoTIFF"):
        raster_at(tmp_path / "t.tif")


def test_infinite_heights_are_refused(tmp_path):
    heights = waves(3, 3)
    heights[1, 1] = np.inf
    write_asc(tmp_path / "t.asc", heights)
    with pytest.raises(GeometryError, match="infinite"):
        raster_at(tmp_path / "t.asc")


@pytest.mark.parametrize(
    ("module", "call"), [("rasterio", raster_at), ("shapefile", read_outlines)]
)
def test_a_missing_extra_says_how_to_install_it(monkeypatch, tmp_path, module, call):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(WarpdemError, match=r"pip install 'warpdem\[geo\]'"):
        call(tmp_path / "a.tif")


def test_a_value_is_that_of_the_cell_a_point_is_in():
    raster = raster_of(np.array([[1.0, 2.0], [3.0, 4.0]]), 5.0, 5.0, 10.0)
    x, y = np.array([0.1, 9.9, 10.1, 19.9, 20.1]), np.array([0.1, 10.1, 9.9, 19.9, 5.0])
    assert np.array_equal(value_at(raster, x, y), [3.0, 1.0, 4.0, 2.0, np.nan], equal_nan=True)


def test_values_under_cells_know_the_origin():
    raster = raster_of(np.array([[1.0, 2.0], [3.0, 4.0]]), 105.0, 205.0, 10.0)
    values = values_under(raster, Grid(1.0, 1.0, 5.0, 4, 3), np.array([100.0, 200.0, 0.0]))
    assert values.tolist() == [[3, 3, 4], [3, 3, 4], [1, 1, 2], [1, 1, 2]]


def slow_inside(rings, x, y):
    """Even-odd rule, point by point."""
    odd = False
    for ring in rings:
        for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            if (ay <= y) != (by <= y) and ax + (y - ay) / (by - ay) * (bx - ax) <= x:
                odd = not odd
    return odd


@pytest.mark.parametrize("seed", range(3))
def test_cells_in_polygons_are_those_of_the_even_odd_rule(seed):
    rng = np.random.default_rng(seed)
    rings = [rng.uniform(-3.0, 13.0, (n, 2)) for n in (3, 7, 12)]
    grid = Grid(0.5, -0.5, 0.37, 31, 25)
    found = inside(rings, grid)
    for row in range(grid.rows):
        for column in range(grid.columns):
            x, y = 0.5 + 0.37 * (column + 0.5), -0.5 + 0.37 * (row + 0.5)
            assert found[row, column] == slow_inside(rings, x, y)


def test_a_hole_is_outside_whichever_way_it_turns():
    grid = Grid(0.0, 0.0, 1.0, 10, 10)
    for hole in (HOLE, HOLE[::-1]):
        found = inside([SQUARE, hole], grid)
        assert found.sum() == 64 - 16
        assert not found[4, 4]
    assert inside([SQUARE], Grid(2.0, 2.0, 1.0, 3, 3)).all()
    assert not inside([SQUARE], Grid(9.0, 0.0, 1.0, 10, 10)).any()


def test_polygons_of_a_shapefile_keep_holes_parts_and_attributes(tmp_path):
    shapefile = pytest.importorskip("shapefile")
    with shapefile.Writer(str(tmp_path / "a.shp")) as file:
        file.field("CLASS", "C")
        file.poly([SQUARE[::-1].tolist(), HOLE.tolist()])
        file.record("soft")
        file.poly([(SQUARE[::-1] + 20.0).tolist()])
        file.record("hard")
    first, second = read_outlines(tmp_path / "a.shp")
    assert (first.attributes["CLASS"], second.attributes["CLASS"]) == ("soft", "hard")
    assert inside(first.rings, Grid(0.0, 0.0, 1.0, 10, 10)).sum() == 48
    assert inside(second.rings, Grid(20.0, 20.0, 1.0, 10, 10)).sum() == 64


def test_a_shapefile_without_polygons_is_refused(tmp_path):
    shapefile = pytest.importorskip("shapefile")
    with shapefile.Writer(str(tmp_path / "a.shp")) as file:
        file.field("CLASS", "C")
        file.point(1.0, 2.0)
        file.record("soft")
    with pytest.raises(GeometryError, match="holds no polygons"):
        read_outlines(tmp_path / "a.shp")
    (tmp_path / "b.shp").write_text("nonsense")
    with pytest.raises(GeometryError, match="cannot be read as a shapefile"):
        read_outlines(tmp_path / "b.shp")
