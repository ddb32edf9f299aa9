"""What a rockfall scene would compute, as numbers and as text."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.report import columns, listed, size_text
from warpdem.rockfall.classes import PARAMETERS, UNVERIFIED

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.errors import Problem
    from warpdem.rockfall.flights import Method
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import GroundClass, Site


CELL_BYTES = 42
"""Height, slope, class, forest of a cell of the ground, on the host and on the device."""

RESULT_BYTES = 1500
"""Counts of a cell that is passed: some 20 bins of each of four quantities, sums, rasters."""

TRAJECTORY_BYTES = 290
"""Start, end, counts and measures of a trajectory."""

SECONDS = 2e-3
"""CPU time of one trajectory of a rock of 8 vertices, rasters included: 2.3 ms on
scenes/rockfall_tschamut.toml, 5.9 ms on scenes/rockfall_valley.toml where 24 vertices lead to
expect 3.6 (each the mean of 300, on a busy machine)."""


@dataclass(frozen=True)
class ClassLine:
    """A class of ground that occurs.

    Attributes:
        ground: The class.
        share: Of the cells with data that are of it [-].
    """

    ground: GroundClass
    share: float


@dataclass(frozen=True, eq=False)
class RockfallReport:
    """What a rockfall scene would compute.

    Attributes:
        file: The scene file, or what stands for it.
        title: Of the scene.
        site: The ground and what stands on it.
        classes: Those that occur.
        method: How trajectories are stepped.
        rocks: Of the scene.
        count: Number of trajectories.
        chunk: Trajectories a chunk; None: chosen for the machine.
        memory: Estimated bytes.
        seconds: Estimated CPU time of all trajectories [s].
        disk: Estimated bytes of the rasters.
        warnings: What is allowed but should be known.
        problems: What the run would refuse.
    """

    file: str
    title: str
    site: Site
    classes: tuple[ClassLine, ...]
    method: Method
    rocks: tuple[Rock, ...]
    count: int
    chunk: int | None
    memory: int
    seconds: float
    disk: int
    warnings: tuple[str, ...]
    problems: tuple[Problem, ...]

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        yield f"{self.file}: {self.title}" if self.title else self.file
        yield from self._terrain()
        yield from columns(
            ("class", "source", "share", *PARAMETERS), [_class_row(line) for line in self.classes]
        )
        yield from self._standing()
        yield from columns(
            ("rock", "", "vertices", "mass [kg]", "radius [m]"),
            [
                (rock.name, "", len(rock.vertices), f"{rock.mass:.4g}", f"{rock.bound:.3g}")
                for rock in self.rocks
            ],
        )
        yield from listed(
            "notes", [f'rock "{rock.name}": {note}' for rock in self.rocks for note in rock.notes]
        )
        yield from self._work()
        for word in ("warnings", "problems"):
            yield from listed(word, getattr(self, word))

    def _terrain(self) -> Iterator[str]:
        ground = self.site.ground
        grid = ground.grid
        west, south, base = self.site.origin + np.array([grid.x, grid.y, 0.0])
        east, north = west + grid.cell * grid.columns, south + grid.cell * grid.rows
        kind = "raster" if ground.facets is None else f"{len(ground.facets.triangles)} triangles"
        yield (
            f"terrain {kind}, {grid.columns} x {grid.rows} cells of {grid.cell:g} m, "
            f"{100.0 * float(1.0 - ground.known.mean()):.3g} % without data"
        )
        yield f"        x {west:.3f} to {east:.3f}, y {south:.3f} to {north:.3f}"
        z = ground.heights if ground.facets is None else ground.facets.points[:, 2]
        assert z is not None
        yield (
            f"        z {base + np.nanmin(z):.3f} to {base + np.nanmax(z):.3f}, "
            f"slope at most {np.degrees(np.arctan(ground.steep.max())):.3g} degrees, "
            f"reference system {self.site.crs or 'unknown'}"
        )

    def _standing(self) -> Iterator[str]:
        site = self.site
        if site.stand_of is not None:
            share = 100.0 * float((site.stand_of >= 0).mean())
            drags = ", ".join(f"{one.drag:g} kg/s up to {one.height:g} m" for one in site.stands)
            yield f"forest  {share:.3g} % of the cells: {drags}"
        if site.trees is not None:
            beside = site.trees.left_out
            more = f"; {beside} of tables stand beside the terrain" if beside else ""
            yield f"trees   {len(site.trees.radius)}{more}"
        for barrier in site.barriers:
            height = f"{barrier.height:g} m high" if isfinite(barrier.height) else "a line"
            takes = f", takes {barrier.capacity:g} J" if barrier.capacity else ", only records"
            yield f"barrier {barrier.name}: {height}{takes}"

    def _work(self) -> Iterator[str]:
        method = self.method
        chunk = f"{-(-self.count // self.chunk)} chunks of {self.chunk}" if self.chunk else ""
        yield f"flights {self.count}, {chunk or 'chunks as suits the machine'}"
        yield (
            f"step    at most {method.dt:g} s"
            + (f" and {method.stride:g} of a rock's radius" if method.stride else "")
            + f", until rest or {method.duration:g} s"
        )
        yield (
            f"time    about {_duration(self.seconds)} of CPU within a factor of 2: "
            f"{1e3 * SECONDS:g} ms a flight of a rock with 8 vertices, a twentieth more for each "
            "other"
        )
        yield (
            f"memory  about {size_text(self.memory)}: {CELL_BYTES} B a cell of the ground, at most "
            f"{RESULT_BYTES} B a cell of the results, {TRAJECTORY_BYTES} B a flight"
        )
        results = self.site.results
        if self.disk:
            yield (
                f"output  rasters of {results.columns} x {results.rows} cells of "
                f"{results.cell:g} m, about {size_text(self.disk)}"
            )


def _class_row(line: ClassLine) -> tuple[str, ...]:
    source = "UNVERIFIED" if line.ground.source == UNVERIFIED else line.ground.source
    values = [f"{getattr(line.ground, key):g}" for key in PARAMETERS]
    return (line.ground.name, source, f"{100.0 * line.share:.3g} %", *values)


def _duration(seconds: float) -> str:
    if seconds < 120.0:
        return f"{seconds:.2g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 7200.0 else f"{seconds / 3600.0:.3g} h"
