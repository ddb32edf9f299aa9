"""Curves of run time against error: their order, and what an error costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

LEAST = 1e-13
"""Errors below are rounding."""
FLAT = 0.5
"""Where halving the step gains less than this power of it, something else errs."""


@dataclass(frozen=True)
class Curve:
    """One setting or program in one case.

    Attributes:
        case, name: Which.
        steps: Of each run, coarse to fine.
        seconds: Of its loop, the best of some.
        error: Infinite where it failed.
        note: What differs from the case.
    """

    case: str
    name: str
    steps: tuple[int, ...]
    seconds: tuple[float, ...]
    error: tuple[float, ...]
    note: str = ""

    @property
    def order(self) -> float:
        """In the step: slope over the falling part of the errors; NaN where there is none."""
        n, e = np.array(self.steps, float), np.array(self.error)
        good = np.isfinite(e) & (e > LEAST)
        n, e = n[good], e[good]
        if len(n) < 3:
            return float("nan")
        slopes = -np.diff(np.log(e)) / np.diff(np.log(n))
        falls = slopes > FLAT
        # the longest falling stretch
        best, start = slice(0, 0), 0
        for k in range(len(slopes) + 1):
            if k == len(slopes) or not falls[k]:
                if k - start > best.stop - best.start:
                    best = slice(start, k)
                start = k + 1
        if best.stop - best.start < 2:
            return float("nan")
        part = slice(best.start, best.stop + 1)
        return float(-np.polyfit(np.log(n[part]), np.log(e[part]), 1)[0])

    def cost(self, wanted: float) -> float:
        """Seconds at an error: log-log between the runs from which on errors are less; else NaN."""
        return self._at(wanted, self.seconds)

    def steps_at(self, wanted: float) -> float:
        """Steps at an error, in the same way."""
        return self._at(wanted, self.steps)

    def _at(self, wanted: float, costs: tuple[float, ...]) -> float:
        e, cost = np.array(self.error), np.array(costs, float)
        above = np.flatnonzero(~(e <= wanted))
        k = int(above[-1]) + 1 if len(above) else 0
        if k == len(e):
            return float("nan")
        if k == 0 or not np.isfinite(e[k - 1]):
            return float(cost[k])
        part = np.log(e[k - 1] / wanted) / np.log(e[k - 1] / max(e[k], 1e-300))
        return float(np.exp(np.log(cost[k - 1]) + part * np.log(cost[k] / cost[k - 1])))

    def error_at(self, seconds: float) -> float:
        """Least error of the runs that take no longer; infinite if none does."""
        within = [e for e, s in zip(self.error, self.seconds, strict=True) if s <= seconds]
        return min(within, default=float("inf"))

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        clean = [e if np.isfinite(e) else None for e in self.error]
        return {"case": self.case, "name": self.name, "note": self.note, "order": self.order} | {
            "steps": list(self.steps),
            "seconds": list(self.seconds),
            "error": clean,
        }
