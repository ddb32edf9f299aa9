"""Class of ground and forest of each cell, from polygons and rasters; later entries win."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.input.decode import problem_at
from warpdem.rockfall.classes import classes_of
from warpdem.rockfall.cover import Outline, inside, read_outlines, values_under
from warpdem.rockfall.raster_files import SUFFIXES, raster_at
from warpdem.rockfall.site import Stand

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.errors import Problem
    from warpdem.input.scene import Scene
    from warpdem.input.scene_rockfall import Forest, GroundArea
    from warpdem.rockfall.site import Grid, GroundClass

NOWHERE = (
    "covers the centre of no cell of the terrain; is it in the terrain's reference system, and "
    "larger than a cell?"
)


def covered_classes(
    scene: Scene, grid: Grid, origin: FloatArray, problems: list[Problem]
) -> tuple[tuple[GroundClass, ...], IntArray]:
    """The classes that occur, and the number of that of each cell, shape [rows, columns].

    Args:
        scene: With a [terrain].
        grid: Of the ground.
        origin: Of the local coordinates, shape [3].
        problems: Takes what is wrong with the files.
    """
    assert scene.terrain is not None
    known = classes_of(scene.terrain_class)
    number = {name: k for k, name in enumerate(known)}
    class_of = np.full((grid.rows, grid.columns), number[scene.terrain.class_], np.int32)
    for index, area in enumerate(scene.ground):
        try:
            for name, cells in _parts(scene, area, grid, origin):
                class_of[cells] = number[_known(name, known)]
        except GeometryError as error:
            problems.append(problem_at(scene, ("ground", index), str(error)))
    used, compact = np.unique(class_of, return_inverse=True)
    names = list(known)
    classes = tuple(known[names[k]] for k in used)
    return classes, compact.reshape(class_of.shape).astype(np.int32)


def _known(name: str, known: dict[str, GroundClass]) -> str:
    if name not in known:
        listed = ", ".join(known)
        raise GeometryError(f'a polygon is of class "{name}", which is none of {listed}')
    return name


def _parts(
    scene: Scene, area: GroundArea, grid: Grid, origin: FloatArray
) -> Iterator[tuple[str, BoolArray]]:
    """Class names and the cells they hold in, in order.

    Raises:
        GeometryError: A file cannot be used, or covers no cell.
    """
    if area.classes is not None and area.file:
        values = values_under(raster_at(scene.directory / area.file), grid, origin)
        parts = [(name, values == float(key)) for key, name in area.classes.items()]
    elif area.field is not None and area.file:
        parts = [
            (_attribute(one, area.field, area.file), _cells(one.rings, grid, origin))
            for one in read_outlines(scene.directory / area.file)
        ]
    else:
        parts = [(area.class_ or "", _cells_of(scene, area, grid, origin))]
    _somewhere(np.any([cells for _, cells in parts], axis=0))
    yield from parts


def _somewhere(cells: BoolArray) -> BoolArray:
    if not cells.any():
        raise GeometryError(NOWHERE)
    return cells


def _attribute(area: Outline, field: str, file: str) -> str:
    if field not in area.attributes:
        listed = ", ".join(area.attributes) or "none"
        raise GeometryError(f'{file} has no attribute "{field}"; there are: {listed}')
    return str(area.attributes[field]).strip()


def _cells(rings: tuple[FloatArray, ...], grid: Grid, origin: FloatArray) -> BoolArray:
    return inside([ring - origin[:2] for ring in rings], grid)


def _cells_of(scene: Scene, area: GroundArea | Forest, grid: Grid, origin: FloatArray) -> BoolArray:
    """Cells in the polygon of an area, or in any of its file, or not zero in its raster."""
    if area.polygon is not None:
        return _cells((np.array(area.polygon, np.float64),), grid, origin)
    path = scene.directory / (area.file or "")
    if path.suffix.lower() in SUFFIXES:
        values = values_under(raster_at(path), grid, origin)
        return np.isfinite(values) & (values != 0.0)
    parts = [_cells(area.rings, grid, origin) for area in read_outlines(path)]
    return np.any(parts, axis=0)


def covered_stands(
    scene: Scene, grid: Grid, origin: FloatArray, problems: list[Problem]
) -> tuple[tuple[Stand, ...], IntArray | None]:
    """The kinds of forest that occur, and the number of that of each cell or -1.

    Args:
        scene: With any number of forests.
        grid: Of the ground.
        origin: Of the local coordinates, shape [3].
        problems: Takes what is wrong with the files.
    """
    if not scene.forest:
        return (), None
    kinds = [Stand(forest.coefficient, forest.height) for forest in scene.forest]
    stands = tuple(dict.fromkeys(kinds))
    stand_of = np.full((grid.rows, grid.columns), -1, np.int32)
    for index, forest in enumerate(scene.forest):
        try:
            cells = _somewhere(_cells_of(scene, forest, grid, origin))
            stand_of[cells] = stands.index(kinds[index])
        except GeometryError as error:
            problems.append(problem_at(scene, ("forest", index), str(error)))
    return stands, stand_of
