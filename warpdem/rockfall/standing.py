"""Trees and barriers of a scene in local coordinates."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.column_file import read_columns
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
    table = read_columns(path, rows="a row for each tree")
    columns = [table.numbers(name) for name in COLUMNS]
    for name, values in zip(COLUMNS[2:], columns[2:], strict=True):
        if (wrong := np.flatnonzero(values <= 0.0)).size:
            line, value = table.lines[wrong[0]], values[wrong[0]]
            raise GeometryError(f"{path}:{line}: {name} = {value:g}: must be positive")
    return np.column_stack(columns)


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
