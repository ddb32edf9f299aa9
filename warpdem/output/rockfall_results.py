"""All files of the results of rockfall, from the chunks of an ensemble."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.output.deposits import (
    CROSSING_COLUMNS,
    DEPOSIT_COLUMNS,
    STATISTICS_COLUMNS,
    crossing_rows,
    deposit_rows,
    statistics_rows,
)
from warpdem.output.durable import swap
from warpdem.output.flight_lines import TRACE_COLUMNS, flight_lines, trace_rows
from warpdem.output.grid_file import WRITERS
from warpdem.output.ground_surface import ground_surface, rock_skins
from warpdem.output.quick_map import DOTS, write_map
from warpdem.output.rows import growing
from warpdem.rockfall.flights import Fate
from warpdem.rockfall.hazard import columns, spread
from warpdem.rockfall.passages import Passages

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.arrays import FloatArray
    from warpdem.rockfall.flights import Flights
    from warpdem.rockfall.passages import Passage
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.tally import Tally
    from warpdem.rockfall.trace import Trace


@dataclass(frozen=True)
class Wanted:
    """Which results are written.

    Attributes:
        title: Of the scene.
        formats: Of the rasters, "asc" and "tif"; none: no rasters.
        quick_map: Whether the map is drawn.
        compression: Of VTU files, as `vtu.write` knows it.
    """

    title: str
    formats: tuple[str, ...] = ("asc",)
    quick_map: bool = True
    compression: str = "zlib"


def write_results(
    folder: Path,
    wanted: Wanted,
    site: Site,
    rocks: Sequence[Rock],
    *,
    chunks: Iterable[Flights],
    tally: Tally,
    traces: Sequence[Trace],
) -> list[Passage]:
    """Write every file of the results; each is whole or absent.

    Args:
        folder: Where; it exists.
        wanted: Which.
        site: What rocks fell on.
        rocks: By their numbers.
        chunks: All trajectories in the order of their ids, read once and not kept (their visits
            are not looked at).
        tally: Of all of them.
        traces: The chosen ones.

    Returns:
        What crossed each barrier.

    Raises:
        OSError: The disk is full, or the folder cannot be written.
        WarpdemError: A GeoTIFF is wanted and rasterio is missing, or the reference system unknown.
    """
    passages, deposits = _tables(folder, site, rocks, chunks)
    crossed = passages.statistics(site.barriers, tally.trajectories)
    if site.barriers:
        with growing(folder / "barrier_statistics.csv", STATISTICS_COLUMNS) as file:
            file.writelines(statistics_rows(crossed))
    for name, values in columns(tally) if wanted.formats else ():
        raster = spread(values, tally, site.results)
        for suffix in wanted.formats:
            WRITERS[suffix](folder / f"{name}.{suffix}", raster, site)
    _write_traces(folder, wanted, site, rocks, traces)
    _write_grid(folder / "terrain.vtu", ground_surface(site), wanted)
    if wanted.quick_map:
        write_map(
            folder / "map.png", site, tally, title=wanted.title, traces=traces, deposits=deposits
        )
    return crossed


def _tables(
    folder: Path, site: Site, rocks: Sequence[Rock], chunks: Iterable[Flights]
) -> tuple[Passages, FloatArray]:
    """Write deposits.csv and, with barriers, barriers.csv; the crossings and the first deposits."""
    passages = Passages()
    drawn: list[FloatArray] = [np.zeros((0, 2))]
    with contextlib.ExitStack() as files:
        ends = files.enter_context(growing(folder / "deposits.csv", DEPOSIT_COLUMNS))
        crossed = (
            files.enter_context(growing(folder / "barriers.csv", CROSSING_COLUMNS))
            if site.barriers
            else None
        )
        for flights in chunks:
            ends.writelines(deposit_rows(flights, site, rocks))
            if crossed is not None:
                crossed.writelines(crossing_rows(flights, site))
                passages.add(flights.crossings)
            if sum(map(len, drawn)) <= DOTS:
                stopped = np.isin(flights.fate, (Fate.REST, Fate.CAUGHT))
                drawn.append(flights.position[stopped, :2])
    return passages, np.concatenate(drawn)


def _write_traces(
    folder: Path, wanted: Wanted, site: Site, rocks: Sequence[Rock], traces: Sequence[Trace]
) -> None:
    if not traces:
        return
    with growing(folder / "trajectories.csv", TRACE_COLUMNS) as file:
        for trace in traces:
            file.writelines(trace_rows(trace, site, rocks))
    _write_grid(folder / "trajectories.vtu", flight_lines(traces, site, rocks), wanted)
    _write_grid(folder / "rocks.vtu", rock_skins(traces, site, rocks), wanted)


def _write_grid(path: Path, grid: vtkUnstructuredGrid, wanted: Wanted) -> None:
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK, which few runs need

    swap(path, lambda part: vtu.write(part, grid, wanted.compression))
