"""Motion read from a table: linear or cubic between its rows, at rest outside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray

AXES = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True)
class MotionTable:
    """Displacements and rotation vectors at given times.

    Attributes:
        time: Increasing [s], shape [row_count].
        value: x, y, z [m], rx, ry, rz [rad], shape [row_count, 6].
        slope: At the rows of a cubic table, or nothing: [m/s], [rad/s], shape [row_count, 6].
    """

    time: FloatArray
    value: FloatArray
    slope: FloatArray | None

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Values and their derivatives, shapes [count, 6]."""
        knots = self.time
        k = np.clip(np.searchsorted(knots, time, side="right") - 1, 0, len(knots) - 2)
        h = (knots[k + 1] - knots[k])[:, None]
        s = np.clip((time - knots[k])[:, None] / h, 0.0, 1.0)
        outside = ((time < knots[0]) | (time >= knots[-1]))[:, None]
        rise = self.value[k + 1] - self.value[k]
        if self.slope is None:
            return self.value[k] + s * rise, np.where(outside, 0.0, rise / h)
        before, after = self.slope[k] * h, self.slope[k + 1] * h
        # Hermite: s0 + m0 s + (3 d - 2 m0 - m1) s^2 + (m0 + m1 - 2 d) s^3
        b, c = 3.0 * rise - 2.0 * before - after, before + after - 2.0 * rise
        value = self.value[k] + s * (before + s * (b + s * c))
        rate = (before + s * (2.0 * b + s * 3.0 * c)) / h
        return value, np.where(outside, 0.0, rate)


def read_table(path: Path, *, cubic: bool) -> MotionTable:
    """A table of motion from a CSV file with a header of t and some of x, y, z, rx, ry, rz.

    ``cubic``: the twice continuously differentiable spline that starts and ends at rest
    (clamped); else straight lines.

    Raises:
        GeometryError: The file is no such table.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise GeometryError(f"{path}: cannot be read: {error}") from None
    lines = [(k, line) for k, line in enumerate(text.splitlines(), 1) if line.strip()]
    names = [name.strip() for name in lines[0][1].split(",")] if lines else []
    wrong = [name for name in names if name not in {"t", *AXES}]
    if "t" not in names or wrong or len({*names}) < len(names):
        place = f"{path}:{lines[0][0]}" if lines else f"{path}"
        raise GeometryError(
            f"{place}: the first line must name t and some of {', '.join(AXES)}; it has "
            f"{', '.join(names[:12]) or 'nothing'}"
        )
    if len(lines) < 3:
        raise GeometryError(f"{path}: needs two rows or more of numbers below the first line")
    rows = np.array([_row(f"{path}:{k}", line, names) for k, line in lines[1:]])
    time = rows[:, names.index("t")]
    if np.any(np.diff(time) <= 0.0):
        row = lines[int(np.flatnonzero(np.diff(time) <= 0.0)[0]) + 2][0]
        raise GeometryError(f"{path}:{row}: times must increase from row to row")
    value = np.zeros((len(rows), len(AXES)))
    for column, name in enumerate(AXES):
        if name in names:
            value[:, column] = rows[:, names.index(name)]
    return MotionTable(time, value, clamped_slopes(time, value) if cubic else None)


def _row(place: str, line: str, names: list[str]) -> list[float]:
    """The numbers of a line, one for each name."""
    cells = line.split(",")
    if len(cells) != len(names):
        raise GeometryError(
            f"{place}: has {len(cells)} columns where the first line names {len(names)}: "
            f"{', '.join(names)}"
        )
    try:
        numbers = [float(cell) for cell in cells]
    except ValueError as error:
        raise GeometryError(f"{place}: not a row of numbers: {error}") from None
    if not np.all(np.isfinite(numbers)):
        raise GeometryError(f"{place}: its numbers must be finite")
    return numbers


def clamped_slopes(time: FloatArray, value: FloatArray) -> FloatArray:
    """Slopes at the knots of the C2 spline with zero slopes at both ends; as ``value``.

    Continuity of the second derivative is a tridiagonal system, solved by Thomas's algorithm.
    """
    h = np.diff(time)
    secant = np.diff(value, axis=0) / h[:, None]
    count = len(time)
    slope = np.zeros_like(value)
    upper = np.zeros(count)
    for k in range(1, count - 1):
        right = 3.0 * (secant[k - 1] / h[k - 1] + secant[k] / h[k])
        pivot = 2.0 / h[k - 1] + 2.0 / h[k] - upper[k - 1] / h[k - 1]
        upper[k] = 1.0 / h[k] / pivot
        slope[k] = (right - slope[k - 1] / h[k - 1]) / pivot
    for k in range(count - 2, 0, -1):
        slope[k] -= upper[k] * slope[k + 1]
    return slope
