"""Rasters of heights or classes from files: ESRI ASCII grids and GeoTIFF."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from warpdem.errors import GeometryError, WarpdemError
from warpdem.geometry.terrain import Raster, raster_of, read_raster

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray

SUFFIXES = (".asc", ".tif", ".tiff")
_SQUARE = 1e-6  # of a pixel: how much its sides may differ, which programs write rounded


def raster_at(path: Path, nodes: Literal["centre", "corner"] = "centre") -> Raster:
    """The raster in a file, by its suffix.

    Args:
        path: An ESRI ASCII grid or a GeoTIFF.
        nodes: Where in its cell a value lies, in the centre or in the lower-left corner.

    Raises:
        GeometryError: The file cannot be read, or is no raster of square upright cells.
        WarpdemError: A GeoTIFF, and the extra ``geo`` is not installed.
    """
    raster = read_raster(path, nodes) if path.suffix.lower() == ".asc" else _geotiff(path, nodes)
    if np.isinf(raster.heights).any():
        raise GeometryError(f"{path}: holds infinite values; mark cells without data by nodata")
    return raster


def _rasterio() -> Any:
    try:
        import rasterio  # noqa: PLC0415 - of the extra geo
    except ImportError:
        raise WarpdemError(
            "a GeoTIFF needs rasterio: pip install 'warpdem[geo]', or write an ESRI ASCII grid"
        ) from None
    return rasterio


def _geotiff(path: Path, nodes: str) -> Raster:
    rasterio = _rasterio()
    try:
        with rasterio.open(path) as file:
            west, south, cell = _placed(path, file)
            heights = np.ma.filled(file.read(1, masked=True).astype(np.float64), np.nan)
            crs = file.crs.to_string() if file.crs else ""
    except rasterio.errors.RasterioError as error:
        raise GeometryError(f"{path}: cannot be read as a GeoTIFF: {error}") from None
    half = 0.5 * cell if nodes == "centre" else 0.0
    return raster_of(heights, west + half, south + half, cell, crs=crs)


def _placed(path: Path, file: Any) -> tuple[float, float, float]:
    """Lower-left corner and cell size of an open GeoTIFF."""
    place = file.transform
    if file.count != 1:
        raise GeometryError(f"{path}: has {file.count} bands; the heights must be the only one")
    if place.b or place.d or place.a <= 0.0 or place.e >= 0.0:
        raise GeometryError(
            f"{path}: is rotated or mirrored; warp it to rows from north to south (gdalwarp)"
        )
    if abs(place.a + place.e) > _SQUARE * place.a:
        raise GeometryError(
            f"{path}: pixels are {place.a:g} by {-place.e:g}, they must be square (gdalwarp -tr)"
        )
    if file.crs and file.crs.is_geographic:
        raise GeometryError(
            f"{path}: is in degrees ({file.crs.to_string()}); warp it to metres (gdalwarp -t_srs)"
        )
    if min(file.height, file.width) < 2:
        raise GeometryError(f"{path}: needs two rows of two pixels at least")
    return place.c, place.f + place.e * file.height, place.a


def value_at(raster: Raster, x: FloatArray, y: FloatArray) -> FloatArray:
    """Value of the cell of a raster (values in the centres) under each point, NaN outside.

    Args:
        raster: Whose nodes are the centres of its cells.
        x: In the coordinates of the raster [m], any shape.
        y: The others.
    """
    rows, columns = raster.heights.shape
    column = np.floor((x - raster.x[0]) / raster.cell + 0.5)
    row = np.floor((raster.y[0] - y) / raster.cell + 0.5)
    inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    # numbers of cells far outside need not be whole numbers of the machine
    place = (np.where(inside, number, 0.0).astype(np.int64) for number in (row, column))
    value = raster.heights[tuple(place)]
    return np.where(inside, value, np.nan)
