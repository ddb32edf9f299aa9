"""Tables of releases: a row a rock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.column_file import read_columns
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.geometry.column_file import ColumnFile
    from warpdem.input.scene_release import Columns


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of a table.

    Attributes:
        lines: Line of each row in the file, shape [row_count].
        position: x, y, z [m], z NaN without a column, shape [row_count, 3].
        velocity: [m/s], shape [row_count, 3]; None without columns.
        spin: [rad/s], shape [row_count, 3]; None without columns.
        rock: Number of the rock, shape [row_count]; None without a column.
    """

    lines: IntArray
    position: FloatArray
    velocity: FloatArray | None
    spin: FloatArray | None
    rock: IntArray | None


def read_rows(path: Path, columns: Columns, rocks: Sequence[str]) -> Rows:
    """The rows of a table of releases.

    Args:
        path: The file.
        columns: Names of its columns.
        rocks: Names that the column ``columns.rock`` may hold.

    Raises:
        GeometryError: The file cannot be read, lacks a column, or holds what is no number or rock;
            names the line.
    """
    table = read_columns(path, rows="a row for each rock")
    height = table.numbers(columns.z) if columns.z else np.full(len(table.lines), np.nan)
    plan = [table.numbers(columns.x), table.numbers(columns.y)]
    return Rows(
        lines=np.array(table.lines),
        position=np.column_stack([*plan, height]),
        velocity=table.vector((columns.vx, columns.vy, columns.vz)),
        spin=table.vector((columns.wx, columns.wy, columns.wz)),
        rock=_rocks(table, columns.rock, rocks) if columns.rock else None,
    )


def _rocks(table: ColumnFile, name: str, rocks: Sequence[str]) -> IntArray:
    """A column of names of rocks, as their numbers."""
    found = table.words(name)
    for line, word in zip(table.lines, found, strict=True):
        if word not in rocks:
            hint = did_you_mean(word, rocks) or f"; there are: {', '.join(rocks[:12])}"
            raise GeometryError(
                f"{table.path}:{line}: {name} = {word!r}: no [[rock]] has this name{hint}"
            )
    return np.array([rocks.index(word) for word in found])
