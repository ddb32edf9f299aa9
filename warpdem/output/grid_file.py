"""Rasters as ESRI ASCII grids (.asc) and GeoTIFF (.tif), in national coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import WarpdemError
from warpdem.output.durable import swap

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from warpdem.rockfall.site import Site

NODATA = -9999
"""Stands for NaN."""


def write_asc(path: Path, raster: NDArray[np.generic], site: Site) -> None:
    """Write an ESRI ASCII grid; a float32 comes back as it was.

    Args:
        path: The file, replaced once the new one is whole.
        raster: Values of the cells of the site's results, row 0 in the south, NaN without data.
        site: Tells where the cells lie.

    Raises:
        OSError: The disk is full, or the folder cannot be written.
    """
    west, south, _ = _corner(site)
    head = (
        f"ncols {site.results.columns}\nnrows {site.results.rows}\nxllcorner {west!r}\n"
        f"yllcorner {south!r}\ncellsize {site.results.cell!r}\nNODATA_value {NODATA}\n"
    )

    def write(part: Path) -> None:
        with part.open("w", encoding="ascii", newline="\n") as file:
            file.write(head)
            file.writelines(_line(row) for row in raster[::-1])

    swap(path, write)


def write_tif(path: Path, raster: NDArray[np.generic], site: Site) -> None:
    """Write a GeoTIFF of one band, float32 or int32, that carries the site's reference system.

    Args and OSError as of :func:`write_asc`.

    Raises:
        WarpdemError: rasterio is not installed, or does not know the reference system.
    """
    content = _tif(raster, site)
    swap(path, lambda part: part.write_bytes(content))


WRITERS = {"asc": write_asc, "tif": write_tif}
"""By the suffix of the file."""


def _corner(site: Site) -> tuple[float, float, float]:
    """West, south and north of the cells of results, national [m]."""
    grid = site.results
    south = float(site.origin[1]) + grid.y
    return float(site.origin[0]) + grid.x, south, south + grid.rows * grid.cell


def _line(row: NDArray[np.generic]) -> str:
    """Values of a row, from the west; nine digits return every float32."""
    blank = np.isnan(row)
    if blank.all():  # most rows of most sites
        return f"{NODATA} " * (len(row) - 1) + f"{NODATA}\n"
    kept = np.where(blank, NODATA, row).tolist()
    return " ".join(["%.9g"] * len(kept)) % tuple(kept) + "\n"


def _tif(raster: NDArray[np.generic], site: Site) -> bytes:
    """The file's bytes, made in memory: GDAL may keep silent about a full disk."""
    try:
        import rasterio  # noqa: PLC0415 - an extra, and it loads GDAL
        from rasterio.errors import CRSError  # noqa: PLC0415 - the same
        from rasterio.io import MemoryFile  # noqa: PLC0415 - the same
    except ImportError:
        raise WarpdemError("GeoTIFF needs rasterio: pip install 'warpdem[geo]'") from None
    west, _, north = _corner(site)
    cell = site.results.cell
    whole = raster.dtype.kind == "i"
    values = raster if whole else np.where(np.isnan(raster), NODATA, raster)
    try:
        with MemoryFile() as memory:
            with memory.open(
                driver="GTiff",
                count=1,
                height=raster.shape[0],
                width=raster.shape[1],
                dtype="int32" if whole else "float32",
                crs=site.crs or None,
                transform=rasterio.Affine(cell, 0.0, west, 0.0, -cell, north),
                nodata=NODATA,
                compress="deflate",
            ) as file:
                file.write(values[::-1].astype("int32" if whole else "float32"), 1)
            return memory.read()
    except CRSError as fault:
        raise WarpdemError(
            f'terrain.crs = "{site.crs}": not a known reference system ({fault}); give a code such '
            'as "EPSG:2056"'
        ) from None
