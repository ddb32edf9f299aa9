"""Trees and barriers of a scene in local coordinates."""

from __future__ import annotations

import csv
from math import inf, isfinite
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.input.decode import problem_at
from warpdem.rockfall.site import Barrier, Trees

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray
    from warpdem.errors import Problem
    from warpdem.input.scene import Scene
    from warpdem.input.scene_rockfall import Tree
    from warpdem.rockfall.site import Ground

COLUMNS = ("x", "y", "diameter", "height")
"""Of a table of trees [m]."""

OUTSIDE = "stands where the terrain has no height; is it in the terrain's reference system?"


def trees_of(
    scene: Scene, ground: Ground, origin: FloatArray, problems: list[Problem]
) -> Trees | None:
    """The trees of a scene; those of a table that stand beside the terrain are left out.

    Args:
        scene: With any number of trees.
        ground: They stand on.
        origin: Of the local coordinates, shape [3].
        problems: Takes what is wrong with them.
    """
    parts: list[FloatArray] = []
    left_out = 0
    for index, tree in enumerate(scene.tree):
        try:
            rows, beside = _rows(scene, tree, ground, origin)
        except GeometryError as error:
            problems.append(problem_at(scene, ("tree", index), str(error)))
        else:
            parts.append(rows)
            left_out += beside
    if not parts:
        return None
    rows = np.concatenate(parts)
    return Trees(rows[:, :2].copy(), 0.5 * rows[:, 2], rows[:, 3], rows[:, 4], left_out)


def _rows(scene: Scene, tree: Tree, ground: Ground, origin: FloatArray) -> tuple[FloatArray, int]:
    """Local x, y, diameter, local top and friction of trees, shape [tree_count, 5].

    And the number of those that stand on no ground.
    """
    if tree.file:
        table = read_trees(scene.directory / tree.file)
    else:
        table = np.array([[*(tree.position or ()), tree.diameter, tree.height]], np.float64)
    place = table[:, :2] - origin[:2]
    foot = ground.height(place[:, 0], place[:, 1])
    stands = np.isfinite(foot)
    if not stands.any():
        raise GeometryError(OUTSIDE if not tree.file else f"every tree of {tree.file} {OUTSIDE}")
    top, friction = foot + table[:, 3], np.full(len(table), tree.mu)
    rows = np.column_stack([place, table[:, 2], top, friction])
    return rows[stands], int((~stands).sum())


def read_trees(path: Path) -> FloatArray:
    """Columns x, y, diameter, height of a table [m], shape [tree_count, 4].

    Raises:
        GeometryError: The table cannot be read, lacks a column, or a value makes no sense.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.DictReader(file, skipinitialspace=True)
            if missing := [name for name in COLUMNS if name not in (rows.fieldnames or ())]:
                raise GeometryError(
                    f"{path}: lacks the column {missing[0]}; a table of trees begins with the line "
                    f"{','.join(COLUMNS)}"
                )
            values = [_values(path, rows.line_num, row) for row in rows]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise GeometryError(f"{path}: cannot be read as a table: {error}") from None
    if not values:
        raise GeometryError(f"{path}: holds no trees")
    return np.array(values, np.float64)


def _values(path: Path, line: int, row: dict[str, str]) -> list[float]:
    try:
        values = [float(row[name] or "") for name in COLUMNS]
    except (TypeError, ValueError):
        raise GeometryError(f"{path}:{line}: {', '.join(COLUMNS)} must be numbers") from None
    if not all(map(isfinite, values)) or values[2] <= 0.0 or values[3] <= 0.0:
        raise GeometryError(f"{path}:{line}: diameter and height must be positive, all finite")
    return values


def barriers_of(scene: Scene, origin: FloatArray) -> tuple[Barrier, ...]:
    """The barriers of a scene, in its order; ``origin`` of the local coordinates, shape [3]."""
    return tuple(
        Barrier(
            one.name,
            np.array(one.line, np.float64) - origin[:2],
            inf if one.height is None else one.height,
            one.capacity or 0.0,
        )
        for one in scene.barrier
    )
