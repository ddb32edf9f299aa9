"""Rasters of what passes each cell."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.rockfall.tally import QUANTITIES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from warpdem.arrays import FloatArray
    from warpdem.rockfall.site import Grid, Site
    from warpdem.rockfall.tally import Tally

QUANTILES = {"median": 500, "q90": 900, "q95": 950, "q99": 990}
"""In thousandths, by the end of the rasters' names."""


def rasters(tally: Tally, site: Site) -> dict[str, NDArray[Any]]:
    """Rasters of the site's cells by name, row 0 in the south; shape [rows, columns] each.

    "passages" and "deposits" are whole numbers, int32, 0 where there are none. The others are
    float32, NaN where nothing passed: "reach_probability", the passages over all trajectories, and
    for each of ``QUANTITIES`` (energy [J], speed [m/s], jump [m], spin [rad/s]) "_mean", "_median",
    "_q90", "_q95", "_q99" and "_max" of the largest values of the trajectories through the cell.
    """
    return {name: spread(values, tally, site.results) for name, values in columns(tally)}


def columns(tally: Tally) -> Iterator[tuple[str, NDArray[Any]]]:
    """The rasters' names and values in the cells of the tally alone, shape [cell_count]."""
    yield "passages", tally.passages.astype(np.int32)
    yield "deposits", tally.deposits.astype(np.int32)
    reached = tally.passages / max(tally.trajectories, 1)
    yield "reach_probability", _shown(np.where(tally.passages > 0, reached, np.nan))
    mean, quantiles = tally.mean(), tally.quantiles([*QUANTILES.values()])
    passed = tally.passages > 0
    for number, quantity in enumerate(QUANTITIES):
        yield f"{quantity}_mean", _shown(mean[:, number])
        for ending, values in zip(QUANTILES, quantiles, strict=True):
            yield f"{quantity}_{ending}", _shown(values[:, number])
        yield f"{quantity}_max", np.where(passed, tally.largest[:, number], np.float32(np.nan))


def spread(values: NDArray[Any], tally: Tally, grid: Grid) -> NDArray[Any]:
    """A raster of the tally's cells: whole numbers over 0, others over NaN."""
    blank = 0 if values.dtype.kind == "i" else np.nan
    raster = np.full(grid.rows * grid.columns, blank, values.dtype)
    raster[tally.cell] = values
    return raster.reshape(grid.rows, grid.columns)


def _shown(values: FloatArray) -> NDArray[np.float32]:
    return values.astype(np.float32)
