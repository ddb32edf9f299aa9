"""One quantity of a reference case: what the simulator gave, what the formula says, how far off."""

from typing import NamedTuple

import numpy as np


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
    def strain(self):
        """Error over gate."""
        if self.gate is None:
            return -1.0
        return np.inf if np.isnan(self.error) else self.error / self.gate

    @property
    def verdict(self):
        if self.gate is None:
            return "n/a"
        return "PASS" if self.error <= self.gate else "FAIL"


def compared(case, quantity, got, expected, *, gate, unit=None, note=""):
    """Row of the worst of some values; errors over ``unit``, by default each value's own size."""
    got, expected = np.broadcast_arrays(np.atleast_1d(got), np.atleast_1d(expected))
    scale = np.where(expected == 0.0, 1.0, np.abs(expected)) if unit is None else unit
    error = np.abs(got - expected) / scale
    at = int(np.argmax(np.where(np.isnan(error), np.inf, error)))
    return Row(case, quantity, float(got[at]), float(expected[at]), float(error[at]), gate, note)


def averaged(case, quantity, got, expected, *, gate, unit=1.0, note=""):
    """Row of one value measured at all phases of a step: mean, and root mean square error."""
    error = float(np.sqrt(np.mean(np.square(np.asarray(got) - expected)))) / unit
    return Row(case, quantity, float(np.mean(got)), expected, error, gate, note)


def order_row(case, order, *, least=1.8, of="order in dt"):
    """Row of a measured order of convergence; its error is what it lacks."""
    return Row(case, of, float(order), least, max(0.0, least - float(order)), 1e-12, "at least")
