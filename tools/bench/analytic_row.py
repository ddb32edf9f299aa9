"""One quantity of a reference case: what the simulator gave, what the formula says, how far off."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class Row(NamedTuple):
    """A line of the table.

    Attributes:
        case: Of the reference, or the family where it concerns all.
        quantity: Key of the reference, or what else was measured.
        got, expected: The values; of several, the one farthest off.
        error: In the unit in which the gate is meant.
        gate: Largest error allowed; None where the formula is not the smooth method's.
        note: Why, if anything is to be said.
    """

    case: str
    quantity: str
    got: float
    expected: float
    error: float
    gate: float | None
    note: str = ""

    @property
    def strain(self) -> float:
        """Error over gate."""
        if self.gate is None:
            return -1.0
        if self.verdict == "FAIL":
            return np.inf
        return self.error / self.gate if self.gate else 0.0

    @property
    def verdict(self) -> str:
        """PASS, FAIL, or n/a without a gate."""
        if self.gate is None:
            return "n/a"
        return "PASS" if self.error <= self.gate else "FAIL"


def compared(
    case: str,
    quantity: str,
    got: ArrayLike,
    expected: ArrayLike,
    *,
    gate: float | None,
    unit: float | None = None,
    note: str = "",
) -> Row:
    """Row of the worst of some values; errors over ``unit``, by default each value's own size."""
    got, expected = np.broadcast_arrays(np.atleast_1d(got), np.atleast_1d(expected))
    scale = np.where(expected == 0.0, 1.0, np.abs(expected)) if unit is None else unit
    error = np.abs(got - expected) / scale
    at = int(np.argmax(np.where(np.isnan(error), np.inf, error)))
    return Row(case, quantity, float(got[at]), float(expected[at]), float(error[at]), gate, note)


def averaged(
    case: str,
    quantity: str,
    got: ArrayLike,
    expected: float,
    *,
    gate: float,
    unit: float = 1.0,
    note: str = "",
) -> Row:
    """Row of one value measured at all phases of a step: mean, and root mean square error."""
    error = float(np.sqrt(np.mean(np.square(np.asarray(got) - expected)))) / unit
    return Row(case, quantity, float(np.mean(got)), expected, error, gate, note)


def order_row(case: str, order: float, *, least: float = 1.8, of: str = "order in dt") -> Row:
    """Row of a measured order of convergence; its error is what it lacks."""
    lacking = max(0.0, least - float(order))
    return Row(case, of, float(order), least, lacking, 1e-12, f"at least {least:g}")


def fact(case: str, quantity: str, *, true: bool, note: str = "") -> Row:
    """Row of what is so or not."""
    return Row(case, quantity, float(true), 1.0, float(not true), 0.0, note)
