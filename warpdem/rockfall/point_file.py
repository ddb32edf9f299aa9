"""Clouds of points from texts: columns of x, y, z between blanks, commas or semicolons."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.text_file import text_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from warpdem.arrays import FloatArray


def read_points(path: Path) -> FloatArray:
    """The points of a file, in its unit, shape [point_count, 3].

    A first line of words, or of one whole number, is passed over; so are columns after the third.

    Raises:
        GeometryError: The file cannot be read, or a line has no three numbers; names it.
    """
    points = np.array([*_rows(path, text_of(path))], float).reshape(-1, 3)
    if not len(points):
        raise GeometryError(f"{path}: holds no points; needs a line x y z for each")
    return points


def _rows(path: Path, text: str) -> Iterator[list[float]]:
    first = True
    for number, line in enumerate(text.splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").replace(";", " ").split()
        if not words:
            continue
        row = _numbers(words[:3])
        if row is not None:
            yield row
        elif not (first and _is_head(words)):
            raise GeometryError(
                f"{path}:{number}: should begin with three finite numbers x y z, not "
                f"{line.strip()[:60]!r}"
            )
        first = False


def _is_head(words: list[str]) -> bool:
    """Whether a line is a number of points, or names columns."""
    return (len(words) == 1 and words[0].isdigit()) or _numbers(words[:1] * 3) is None


def _numbers(words: list[str]) -> list[float] | None:
    """Three finite numbers; None if they are not."""
    try:
        row = [float(word) for word in words]
    except ValueError:
        return None
    return row if len(row) == 3 and np.isfinite(row).all() else None
