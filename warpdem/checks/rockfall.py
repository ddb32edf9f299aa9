"""What a rockfall scene would compute, and what is doubtful about it, without computing it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.rockfall_doubts import gaps, in_trunks, large_rocks
from warpdem.checks.rockfall_report import (
    CELL_BYTES,
    RESULT_BYTES,
    SECONDS,
    TRAJECTORY_BYTES,
    ClassLine,
    RockfallReport,
)
from warpdem.errors import SceneError
from warpdem.rockfall.classes import UNVERIFIED
from warpdem.rockfall.finish import chosen_ids
from warpdem.rockfall.nearby import cells_near
from warpdem.rockfall.prepare import lacking_formats, method_of, site_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.errors import Problem
    from warpdem.input.scene import Scene
    from warpdem.rockfall.flights import Starts
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site

FIXED_SHARE = 0.6
"""Share of that which does not grow with the vertices (measured: .52 and .92 us a step with 8 and
24)."""

RASTERS = 27
"""Passages, deposits, reach; mean, median, q90, q95, q99, max of four quantities."""

FILE_BYTES = {"asc": 10, "tif": 4}
"""Of a cell in a file of results."""

SMOOTH_OUTPUT = ("contacts", "table", "checkpoint_every")
"""Files that are asked for and that rockfall has not; the same scene may be run smooth."""

SAMPLE = 10_000
"""Trajectories whose starts are looked at."""


def check_rockfall(scene: Scene) -> RockfallReport:
    """What a scene with run.method = "nonsmooth" would compute.

    Raises:
        SceneError: The terrain, what covers it or the rocks cannot be made, or bodies lie beside
            the terrain; carries all problems.
    """
    site = site_of(scene)
    rocks, count, starts, problems = _flights(scene, site)
    problems += lacking_formats(scene)
    cells = site.results.rows * site.results.columns
    ground = site.ground.grid
    size = ground.rows * ground.columns
    return RockfallReport(
        file=str(scene.source or "scene"),
        title=scene.title,
        site=site,
        classes=_class_lines(site),
        method=method_of(scene),
        rocks=rocks,
        count=count,
        chunk=scene.ensemble.chunk,
        memory=CELL_BYTES * size + RESULT_BYTES * cells + TRAJECTORY_BYTES * count,
        seconds=count * _seconds(rocks, starts),
        disk=RASTERS * cells * sum(FILE_BYTES[one] for one in scene.output.formats)
        if scene.output.rasters
        else 0,
        warnings=(
            *_warnings(scene, site),
            *gaps(site),
            *large_rocks(site, rocks),
            *(in_trunks(site, rocks, starts, releases=bool(scene.release)) if starts else ()),
            *_undrawn(scene, count),
        ),
        problems=tuple(problems),
    )


def _flights(
    scene: Scene, site: Site
) -> tuple[tuple[Rock, ...], int, Starts | None, list[Problem]]:
    """Rocks, number of trajectories and the first starts, or why there are none of these.

    Raises:
        SceneError: Rocks cannot be made, or bodies lie beside the terrain; carries all problems.
    """
    if not scene.release:
        from warpdem.rockfall.bodies import Bodies  # noqa: PLC0415 - builds shapes as `check` does

        bodies = Bodies(scene, site)
        return bodies.rocks, bodies.count, bodies.starts(np.arange(min(bodies.count, SAMPLE))), []
    from warpdem.rockfall.releases import Releases  # noqa: PLC0415 - only with releases
    from warpdem.rockfall.rocks import rocks_of  # noqa: PLC0415 - the same

    rocks, count = rocks_of(scene), scene.ensemble.count or 0
    try:
        releases = Releases(scene, site, rocks)
        count = releases.count
        return rocks, count, releases.starts(np.arange(min(count, SAMPLE))), []
    except SceneError as error:
        return rocks, count, None, list(error.problems)


def _seconds(rocks: Sequence[Rock], starts: Starts | None) -> float:
    """CPU time of one trajectory on the average [s]."""
    vertices = np.array([len(rock.vertices) for rock in rocks], float)
    share = np.bincount(starts.rock, minlength=len(rocks)) if starts else np.ones(len(rocks))
    mean = float(vertices @ share / max(share.sum(), 1))
    return SECONDS * (FIXED_SHARE + (1.0 - FIXED_SHARE) * mean / 8.0)


def _class_lines(site: Site) -> tuple[ClassLine, ...]:
    known = site.ground.known
    share = np.bincount(site.class_of[known], minlength=len(site.classes)) / max(known.sum(), 1)
    return tuple(ClassLine(one, float(s)) for one, s in zip(site.classes, share, strict=True))


def _warnings(scene: Scene, site: Site) -> Iterator[str]:
    file = scene.terrain.file if scene.terrain else ""
    if file.lower().endswith(".stl") and (step := np.spacing(np.float32(site.origin.max()))) > 1e-3:
        yield (
            f"{file}: an STL keeps coordinates like these to {step:.2g} m only; "
            "use an OBJ or PLY, or a raster"
        )
    for key in SMOOTH_OUTPUT:
        if getattr(scene.output, key):
            yield f'output.{key} has no effect with run.method = "nonsmooth"'
    names = [one.name for one in site.classes if one.source == UNVERIFIED]
    if names:
        yield (
            f"UNVERIFIED: nobody could confirm the published numbers of {', '.join(names)}; "
            "calibrate them, or give your own in [[terrain_class]]"
        )
    grid = site.ground.grid
    if site.results.cell < grid.cell:
        yield (
            f"output.cellsize = {site.results.cell:g} is finer than the terrain's {grid.cell:g} m: "
            "the results show no more than that"
        )
    for barrier in site.barriers:
        pieces = np.stack([barrier.line[:-1], barrier.line[1:]], axis=1)
        if not any(len(cells_near(grid, piece, 0.0)) for piece in pieces):
            yield f'barrier "{barrier.name}": no part of it lies on the terrain'


def _undrawn(scene: Scene, count: int) -> Iterator[str]:
    """Trajectories that are wanted as lines and that there are not."""
    wanted = scene.output.trajectories
    if not isinstance(wanted, int) and (beyond := set(wanted) - set(chosen_ids(wanted, count))):
        yield (
            f"output.trajectories: there is no trajectory {', '.join(map(str, sorted(beyond)))}; "
            f"they are numbered from 0 to {count - 1}"
        )
