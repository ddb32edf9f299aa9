"""Tables from texts: a line of names, then rows, between commas, semicolons or tabs."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.text_file import text_of
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray

_SHOWN = 24  # names that a message lists at most


@dataclass(frozen=True)
class ColumnFile:
    """The rows of a file below its line of names; blank lines are left out.

    Attributes:
        path: The file.
        names: Of the columns.
        cells: Words of each row, as many as there are names.
        lines: Line of each row in the file.
    """

    path: Path
    names: list[str]
    cells: list[list[str]]
    lines: list[int]

    def words(self, name: str) -> list[str]:
        """A column.

        Raises:
            GeometryError: There is none of this name.
        """
        if name not in self.names:
            raise GeometryError(
                f"{self.path}: has no column {name!r}; it has {', '.join(self.names[:_SHOWN])}"
                + did_you_mean(name, self.names)
            )
        place = self.names.index(name)
        return [row[place] for row in self.cells]

    def numbers(self, name: str) -> FloatArray:
        """A column of numbers, shape [row_count].

        Raises:
            GeometryError: There is no such column, or something else is in it; names the line.
        """
        cells = zip(self.lines, self.words(name), strict=True)
        return np.array([self._number(name, line, word) for line, word in cells])

    def _number(self, name: str, line: int, word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = np.nan
        if not isfinite(value):
            raise GeometryError(f"{self.path}:{line}: {name} = {word!r}: must be a finite number")
        return value

    def vector(self, names: Sequence[str | None]) -> FloatArray | None:
        """Columns side by side, shape [row_count, name_count]; None unless all are named.

        Raises:
            GeometryError: As of ``numbers``.
        """
        known = [self.numbers(name) for name in names if name]
        return np.column_stack(known) if len(known) == len(names) else None


def read_columns(path: Path, *, rows: str) -> ColumnFile:
    """A table whose first line names its columns.

    Args:
        path: The file.
        rows: What it must hold below that line, in words.

    Raises:
        GeometryError: The file cannot be read, holds no row, or one does not fit the names.
    """
    lines = [(k, line) for k, line in enumerate(text_of(path).splitlines(), 1) if line.strip()]
    if len(lines) < 2:
        raise GeometryError(f"{path}: needs a line of names and {rows} below it")
    mark = max(",;\t", key=lines[0][1].count)
    try:
        found = [
            [cell.strip() for cell in row]
            for row in csv.reader([line for _, line in lines], delimiter=mark, strict=True)
        ]
    except csv.Error as error:
        raise GeometryError(f"{path}: cannot be read as a table: {error}") from None
    if len(found) != len(lines):
        raise GeometryError(f"{path}: cannot be read as a table: a quotation goes over many lines")
    names, numbers = found[0], [k for k, _ in lines[1:]]
    cells = [_fitted(f"{path}:{k}", row, names) for k, row in zip(numbers, found[1:], strict=True)]
    return ColumnFile(path, names, cells, numbers)


def _fitted(place: str, row: list[str], names: list[str]) -> list[str]:
    """The words of a row, one for each name; empty ones may follow."""
    if len(row) < len(names) or any(row[len(names) :]):
        raise GeometryError(
            f"{place}: has {len(row)} columns where the first line names {len(names)}: "
            f"{', '.join(names[:_SHOWN])}"
        )
    return row[: len(names)]
