"""Tables of releases: a row a rock."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
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
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise GeometryError(f"{path}: cannot be read: {reason}") from None
    lines = [(k, line) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
    if len(lines) < 2:
        raise GeometryError(f"{path}: needs a line of names and a row for each rock below it")
    mark = max(",;\t", key=lines[0][1].count)
    cells = [
        [cell.strip() for cell in row]
        for row in csv.reader([line for _, line in lines], delimiter=mark)
    ]
    table = _Table(path, cells[0], cells[1:], [k for k, _ in lines[1:]])
    height = table.numbers(columns.z) if columns.z else np.full(len(cells) - 1, np.nan)
    plan = [table.numbers(columns.x), table.numbers(columns.y)]
    return Rows(
        lines=np.array(table.lines),
        position=np.column_stack([*plan, height]),
        velocity=table.vector((columns.vx, columns.vy, columns.vz)),
        spin=table.vector((columns.wx, columns.wy, columns.wz)),
        rock=table.choices(columns.rock, rocks) if columns.rock else None,
    )


@dataclass(frozen=True)
class _Table:
    path: Path
    names: list[str]
    cells: list[list[str]]
    lines: list[int]

    def column(self, name: str) -> list[tuple[int, str]]:
        """Line and content of the cells of a column."""
        if name not in self.names:
            raise GeometryError(
                f"{self.path}: has no column {name!r}; it has {', '.join(self.names[:24])}"
                + did_you_mean(name, self.names)
            )
        place = self.names.index(name)
        short = [k for k, row in zip(self.lines, self.cells, strict=True) if len(row) <= place]
        if short:
            raise GeometryError(f"{self.path}:{short[0]}: the row ends before its {name!r}")
        return [(k, row[place]) for k, row in zip(self.lines, self.cells, strict=True)]

    def numbers(self, name: str) -> FloatArray:
        """A column of numbers, shape [row_count]."""
        return np.array([self._number(name, *cell) for cell in self.column(name)])

    def _number(self, name: str, line: int, word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not isfinite(value):
            raise GeometryError(f"{self.path}:{line}: {name} = {word!r}: must be a finite number")
        return value

    def vector(self, names: Sequence[str | None]) -> FloatArray | None:
        """Three columns, shape [row_count, 3]; None when they are not named."""
        known = [self.numbers(name) for name in names if name]
        return np.column_stack(known) if len(known) == len(names) else None

    def choices(self, name: str, legal: Sequence[str]) -> IntArray:
        """A column of names, as their places in ``legal``, shape [row_count]."""
        found = self.column(name)
        for line, word in found:
            if word not in legal:
                hint = did_you_mean(word, legal) or f"; there are: {', '.join(legal[:12])}"
                raise GeometryError(
                    f"{self.path}:{line}: {name} = {word!r}: no [[rock]] has this name{hint}"
                )
        return np.array([legal.index(word) for _, word in found])
