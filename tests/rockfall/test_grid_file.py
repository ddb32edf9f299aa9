"""Grid files come back as they were."""

from dataclasses import replace

import numpy as np
import pytest
from fields import ORIGIN, site

from warpdem.errors import WarpdemError
from warpdem.geometry.terrain import read_raster
from warpdem.output.grid_file import write_asc, write_tif

HERE = site(cell=2.5, rows=4, columns=6)


def raster():
    values = np.random.default_rng(0).lognormal(3.0, 4.0, (4, 6)).astype(np.float32)
    values[1, 2] = np.nan
    values[3] = np.nan
    return values


def test_an_ascii_grid_returns_every_float32_from_north_to_south(tmp_path):
    write_asc(tmp_path / "a.asc", raster(), HERE)
    back = read_raster(tmp_path / "a.asc")
    np.testing.assert_array_equal(back.heights[::-1].astype(np.float32), raster())
    assert back.x[0] == ORIGIN[0]
    assert back.y[-1] == ORIGIN[1]
    assert [path.name for path in tmp_path.iterdir()] == ["a.asc"]


def test_a_geotiff_carries_values_place_and_reference_system(tmp_path):
    rasterio = pytest.importorskip("rasterio")
    write_tif(tmp_path / "a.tif", raster(), HERE)
    with rasterio.open(tmp_path / "a.tif") as file:
        back = file.read(1, masked=True).filled(np.nan)
        np.testing.assert_array_equal(back[::-1], raster())
        assert file.crs.to_epsg() == 2056
        assert tuple(file.bounds) == (ORIGIN[0], ORIGIN[1], ORIGIN[0] + 15.0, ORIGIN[1] + 10.0)
    write_tif(tmp_path / "n.tif", np.arange(24, dtype=np.int32).reshape(4, 6), HERE)
    with rasterio.open(tmp_path / "n.tif") as file:
        assert file.dtypes == ("int32",)


def test_an_unknown_reference_system_is_told(tmp_path):
    pytest.importorskip("rasterio")
    with pytest.raises(WarpdemError, match=r'terrain\.crs = "EPSG:1"'):
        write_tif(tmp_path / "a.tif", raster(), replace(HERE, crs="EPSG:1"))
