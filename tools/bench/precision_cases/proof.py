"""What the curves have to show."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import isfinite, log
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from precision_cases.curves import Curve

ORDER, FASTER, FINER, WANTED = 1.8, 8.0, 100.0, 1e-3
WAY, CREEP = 1e-3, 1e-6
IMPACTS = ("normal_impact", "oblique_impact")
SINGLE = dict.fromkeys((*IMPACTS, "heavy_top"), "default")
"""Cases whose order is asked, and the setting meant."""
ROTATIONS = {"torque_free_top": "rockable", "heavy_top": "taylor"}
"""Cases of rotation, and which curve stands for Rockable's scheme."""


@dataclass(frozen=True)
class Proof:
    """A figure that is asked for, and what it is."""

    what: str
    value: float
    least: float

    @property
    def passes(self) -> bool:
        """Whether it is as large as asked."""
        return self.value >= self.least

    def __str__(self) -> str:
        word = "PASS" if self.passes else "FAIL"
        return f"{self.what:72s} {self.value:9.3g}  at least {self.least:g}  {word}"


def proofs(curves: Sequence[Curve]) -> Iterator[Proof]:
    """Of the cases that were run."""
    by = {(curve.case, curve.name): curve for curve in curves}
    for case, name in SINGLE.items():
        if (case, name) in by:
            yield Proof(f"{case}: order of the default", by[case, name].order, ORDER)
    for case in IMPACTS:
        if (case, "rockable") in by:
            ours, theirs = by[case, "default"], by[case, "rockable"]
            ratio = theirs.cost(WANTED) / ours.cost(WANTED)
            yield Proof(f'{case}: run time of "rockable" over ours at 1e-3', ratio, FASTER)
            ratio = theirs.steps_at(WANTED) / ours.steps_at(WANTED)
            yield Proof(f"{case}: its steps over ours at 1e-3", ratio, FASTER)
    if {("slope_slide", "default"), ("slope_stick", "default")} <= by.keys():
        slide, stick = (by[f"slope_{name}", "default"].error for name in ("slide", "stick"))
        both = sum(a <= WAY and b <= CREEP for a, b in zip(slide, stick, strict=True))
        yield Proof("slope: steps with a way within 1e-3 and a creep within 1e-6 m", both, 1)
    for case, other in ROTATIONS.items():
        if (case, other) in by:
            ours = by[case, "default"]
            yield Proof(
                f"{case}: its error over ours, equal cost", gain(ours, by[case, other]), FINER
            )


def gain(ours: Curve, theirs: Curve) -> float:
    """Least ratio of errors at equal run time, over their runs that did not fail.

    Our errors at these times are taken between our runs, log-log.
    """
    ratios = []
    for seconds, error in zip(theirs.seconds, theirs.error, strict=True):
        best = between(ours, seconds)
        if isfinite(error) and isfinite(best):
            ratios.append(error / best)
    return min(ratios, default=float("nan"))


def between(curve: Curve, seconds: float) -> float:
    """Error at a run time, log-log; infinite before the first run, the last one's after it."""
    runs = [(s, e) for s, e in zip(curve.seconds, curve.error, strict=True) if isfinite(e)]
    runs.sort()
    if not runs or seconds < runs[0][0]:
        return float("inf")
    for (a, first), (b, second) in pairwise(runs):
        if a <= seconds <= b:
            part = log(seconds / a) / log(b / a) if b > a else 0.0
            return first * (second / first) ** part
    return runs[-1][1]
