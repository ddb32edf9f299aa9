"""Motion read from a table: linear or cubic between its rows, at rest outside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.column_file import read_columns

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
    table = read_columns(path, rows="two rows or more of numbers")
    names = table.names
    wrong = [name for name in names if name not in {"t", *AXES}]
    if "t" not in names or wrong or len({*names}) < len(names):
        raise GeometryError(
            f"{path}: the first line must name t and some of {', '.join(AXES)}; it has "
            f"{', '.join(names[:12])}"
        )
    if len(table.lines) < 2:
        raise GeometryError(f"{path}: needs two rows or more of numbers below the first line")
    time = table.numbers("t")
    if np.any(np.diff(time) <= 0.0):
        row = table.lines[int(np.flatnonzero(np.diff(time) <= 0.0)[0]) + 1]
        raise GeometryError(f"{path}:{row}: times must increase from row to row")
    value = np.zeros((len(time), len(AXES)))
    for column, name in enumerate(AXES):
        if name in names:
            value[:, column] = table.numbers(name)
    return MotionTable(time, value, clamped_slopes(time, value) if cubic else None)


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
