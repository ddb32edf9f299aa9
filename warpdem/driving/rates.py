"""How fast drivers move: what that asks of the time step."""

from __future__ import annotations

from math import inf, pi
from typing import TYPE_CHECKING

import numpy as np

from warpdem.driving.curve import Formulas, Wave
from warpdem.driving.table import AXES, MotionTable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.driving.plan import Imposed, Plan

STEPS_A_PERIOD = 100
"""Steps in the shortest period of a driver, at least."""

SAMPLES = 4096
"""Of an expression over a run, to find how fast it changes and whether it can be computed."""

LARGEST = 1e30
"""Displacement, angle or velocity that can be computed with, as for the numbers of a scene."""


def period_limit(plan: Plan, duration: float) -> float:
    """Longest step that resolves all drivers [s]: a hundredth of a period, a row of a table."""
    return min((_limit(driver, duration) for driver in plan.imposed), default=inf)


def flaws(driver: Imposed, duration: float) -> Iterator[tuple[str, str]]:
    """Axes of an expression that cannot be computed within a run, and where; by samples."""
    if not isinstance(driver.curve, Formulas):
        return
    end = min(duration, driver.stop or inf)
    time = np.linspace(driver.start, max(end, driver.start), SAMPLES)
    value, rate = driver.curve.at(time)
    if end <= driver.start:  # its place at the start is all that it gives
        rate = np.zeros_like(rate)
    parts = np.stack([value, rate])
    legal = np.abs(parts) <= LARGEST  # false for NaN
    for column in np.flatnonzero(~legal.all(axis=(0, 1))):
        first = int(np.argmin(legal[:, :, column].all(axis=0)))
        part = int(np.argmin(legal[:, first, column]))
        rule = (
            f"its {('value', 'velocity')[part]} is {parts[part, first, column]:.3g} at "
            f"t = {time[first]:.6g} s: must be finite, and at most {LARGEST:g}, from start to stop "
            f"or run.duration"
        )
        yield AXES[column], rule


def _limit(driver: Imposed, duration: float) -> float:
    curve = driver.curve
    if isinstance(curve, Wave):
        return 1.0 / (STEPS_A_PERIOD * curve.driver.frequency)
    if isinstance(curve, MotionTable):
        return float(np.diff(curve.time).min())
    if not isinstance(curve, Formulas):
        return inf
    end = min(duration, driver.stop or inf)
    if end <= driver.start:
        return inf
    time = np.linspace(driver.start, end, SAMPLES)
    rate = curve.at(time)[1]
    largest = np.abs(rate).max(axis=0)
    change = np.abs(np.diff(rate, axis=0)).max(axis=0) / (time[1] - time[0])
    moves = (largest > 0.0) & np.isfinite(largest) & np.isfinite(change)
    angular = float((change[moves] / largest[moves]).max(initial=0.0))
    return 2.0 * pi / (STEPS_A_PERIOD * angular) if angular > 0.0 else inf
