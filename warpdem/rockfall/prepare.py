"""From a scene to what rocks fall on and how they are stepped."""

from __future__ import annotations

from importlib.util import find_spec
from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError, SceneError
from warpdem.geometry.shapes import read_mesh
from warpdem.geometry.terrain import raster_of, read_raster
from warpdem.input.decode import problem_at
from warpdem.input.scene_shapes import TerrainShape
from warpdem.rockfall.covering import covered_classes, covered_stands
from warpdem.rockfall.facets import facet_ground
from warpdem.rockfall.flights import Method
from warpdem.rockfall.ground_contact import contact_class
from warpdem.rockfall.heights import origin_of, raster_ground
from warpdem.rockfall.raster_files import SUFFIXES, raster_at
from warpdem.rockfall.site import Grid, Site
from warpdem.rockfall.standing import barriers_of, trees_of

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.errors import Problem
    from warpdem.geometry.terrain import Raster
    from warpdem.input.scene import Body, Scene
    from warpdem.rockfall.site import Ground

LARGEST_STEP = 5e-3
"""Of dt = "auto" [s]; with the stride of 0.03 run-out does not change any more (KS .03)."""


def method_of(scene: Scene) -> Method:
    """How the trajectories of a scene are stepped."""
    run = scene.run
    x, y, z = scene.gravity.vector
    return Method(
        duration=run.duration,
        gravity=(x, y, z),
        dt=LARGEST_STEP if isinstance(run.dt, str) else run.dt,
        stride=run.stride,
        tolerance=run.tolerance,
        gyroscope=run.gyroscope,
        skip=run.skip,
        lift=run.lift,
    )


def site_of(scene: Scene) -> Site:
    """The ground of a scene and what stands on it, in local coordinates.

    Raises:
        SceneError: Files cannot be read or used; carries a problem for each.
        WarpdemError: An extra is not installed.
    """
    ground, origin, crs = _ground(scene)
    problems: list[Problem] = []
    own = scene.terrain is not None
    base = (contact_class(scene, problems),) if not own else ()
    cells = (ground.grid.rows, ground.grid.columns)
    classes, class_of = (
        covered_classes(scene, ground.grid, origin, problems)
        if own
        else (base, np.zeros(cells, np.int32))
    )
    stands, stand_of = covered_stands(scene, ground.grid, origin, problems)
    trees = trees_of(scene, ground, origin, problems)
    barriers = barriers_of(scene, origin)
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    results = results_grid(ground.grid, scene.output.cellsize)
    return Site(origin, crs, ground, classes, class_of, stands, stand_of, trees, barriers, results)


def results_grid(grid: Grid, cell: float | None) -> Grid:
    """Cells of the results: those of the ground, or others from the same lower-left corner.

    Args:
        grid: Of the ground.
        cell: Edge length of the others [m].
    """
    if cell is None:
        return grid
    columns, rows = (
        max(1, ceil(count * grid.cell / cell * (1.0 - 1e-12)))
        for count in (grid.columns, grid.rows)
    )
    return Grid(grid.x, grid.y, cell, rows, columns)


def _ground(scene: Scene) -> tuple[Ground, FloatArray, str]:
    """The ground, the local origin and the reference system."""
    path = ("terrain", "file") if scene.terrain else _body_file(scene)
    try:
        if scene.terrain and not scene.terrain.file.lower().endswith(SUFFIXES):
            points, faces = read_mesh(scene.directory / scene.terrain.file)
            origin = origin_of(points[:, 0], points[:, 1], points[:, 2])
            return facet_ground(points, faces, origin), origin, scene.terrain.crs or ""
        raster = _raster(scene)
        origin = origin_of(raster.x, raster.y, raster.heights)
        crs = (scene.terrain.crs if scene.terrain else None) or raster.crs
        return raster_ground(raster, origin), origin, crs
    except GeometryError as error:
        problem = problem_at(scene, path, str(error))
        raise SceneError(str(scene.source or "scene"), [problem]) from None


def _raster(scene: Scene) -> Raster:
    if scene.terrain:
        return raster_at(scene.directory / scene.terrain.file, scene.terrain.nodes)
    body, shape = terrain_body(scene)
    raster = read_raster(scene.directory / shape.file)
    x, y, z = body.position
    heights = raster.heights + z
    return raster_of(heights, float(raster.x[0]) + x, float(raster.y[-1]) + y, raster.cell)


def _body_file(scene: Scene) -> tuple[str | int, ...]:
    _, shape = terrain_body(scene)
    return ("shape", scene.shape.index(shape), "file")


def terrain_body(scene: Scene) -> tuple[Body, TerrainShape]:
    """The body of a scene without [terrain] that is its ground; the rules say there is one."""
    shapes = {shape.name: shape for shape in scene.shape if isinstance(shape, TerrainShape)}
    return next((body, shapes[body.shape]) for body in scene.body if body.shape in shapes)


def lacking_formats(scene: Scene) -> list[Problem]:
    """Formats of results that cannot be written here, or not in the scene's reference system."""
    if not scene.output.rasters or "tif" not in scene.output.formats:
        return []
    if not find_spec("rasterio"):
        rule = "\"tif\" needs rasterio: pip install 'warpdem[geo]', or leave it out"
        return [problem_at(scene, ("output", "formats"), rule)]
    crs = scene.terrain.crs if scene.terrain else None
    fault = _unknown_system(crs) if crs else ""
    return [problem_at(scene, ("terrain", "crs"), fault, value=crs)] if fault else []


def _unknown_system(crs: str) -> str:
    """Why a GeoTIFF cannot carry a reference system; empty when it can."""
    from rasterio.crs import CRS  # noqa: PLC0415 - an extra, and it loads GDAL

    try:
        CRS.from_user_input(crs)
    except ValueError as fault:  # of which rasterio's own are
        return (
            f'no known reference system, which "tif" of output.formats must carry ({fault}); give '
            'a code such as "EPSG:2056", or leave it or "tif" out'
        )
    return ""
