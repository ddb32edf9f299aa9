"""Runs of the nonsmooth method with a fixed step, and cases that only it has."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from slopes import box, fixed_step, flyer, law, plane, site_on, starts

from precision_cases.case import Case, G, random

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from precision_cases.case import FloatArray


class Hard:
    """Rocks that fly for some time, again and again."""

    def __init__(
        self,
        site: Any,
        rock: Any,
        run: Mapping[str, Any],
        until: float,
        steps: int,
        begin: Any,
        measured: Callable[[Any], FloatArray],
        **more: Any,
    ) -> None:
        dt = until / steps
        keys = {"skip": "none", "tolerance": 1e-8} | more
        keys |= {key: value for key, value in run.items() if key != "method"}
        self._trajectories = flyer(site, [rock], fixed_step(dt, until - 0.5 * dt, **keys))
        self._begin = begin
        self.values = measured(self._trajectories.fly(begin))

    def again(self) -> float:
        """Seconds of another run."""
        begin = time.process_time()
        self._trajectories.fly(self._begin)
        return time.process_time() - begin


# --- slabs that stop on a slope of the terrain -------------------------------------------------
ANGLE, GRIP, LONG, COUNT = np.radians(25.0), 0.8, 6.0, 50
SPEEDS = random(51).uniform(3.0, 7.0, COUNT)
HEADINGS = random(52).uniform(-0.4, 0.4, COUNT)
"""Of the slabs' velocities, from the line of the steepest descent [rad]."""


def stop_ways() -> FloatArray:
    """Ways until they stop, by the equation of motion of a point on a slope [m], along and across.

    Friction opposes the velocity; weight pulls down the slope.
    """
    pull, grip = G * np.sin(ANGLE), GRIP * G * np.cos(ANGLE)
    found = []
    for speed, heading in zip(SPEEDS, HEADINGS, strict=True):
        # s = tan of half the angle from the downhill line; speed falls as it goes to zero
        found.append(_stopped(speed, heading, pull, grip))
    return np.array(found)


def _stopped(speed: float, heading: float, pull: float, grip: float) -> tuple[float, float]:
    """Where a sliding point stops: its equation, by the angle instead of the time.

    With p = grip/pull: v(a) = c / sin a tan(a/2)^p, dt = -v da/(pull sin a).
    """
    if heading == 0.0:
        return speed**2 / (2.0 * (grip - pull)), 0.0
    p, size = grip / pull, abs(heading)

    def pace(a: FloatArray) -> FloatArray:
        v = speed * np.sin(size) / np.sin(a)
        return v * (np.tan(0.5 * a) / np.tan(0.5 * size)) ** p

    # a = size x^4: the integrands are smooth at the end
    x, weight = np.polynomial.legendre.leggauss(60)
    x, weight = 0.5 * (x + 1.0), 0.5 * weight
    a, da = size * x**4, 4.0 * size * x**3 * weight
    part = pace(a) ** 2 / (pull * np.sin(a)) * da
    return float(np.sum(part * np.cos(a))), float(np.sign(heading) * np.sum(part * np.sin(a)))


def slabs(run: Mapping[str, Any], steps: int) -> Hard:
    """Slabs on a slope of triangles."""
    normal, down = np.array([np.sin(ANGLE), 0, np.cos(ANGLE)]), [np.cos(ANGLE), 0, -np.sin(ANGLE)]
    along, across = np.array(down), np.array([0.0, 1.0, 0.0])
    place = (0.05 - 1e-9) * normal + 4.0 * np.arange(COUNT)[:, None] * across
    ways = np.cos(HEADINGS)[:, None] * along + np.sin(HEADINGS)[:, None] * across
    turn = (np.cos(0.5 * ANGLE), 0.0, np.sin(0.5 * ANGLE), 0.0)
    begin = starts(place, velocity=SPEEDS[:, None] * ways, orientation=turn)
    site = site_on(plane((-np.tan(ANGLE), 0.0)), law(GRIP))

    def measured(end: Any) -> FloatArray:
        moved = end.position - place
        return np.column_stack([moved @ along, moved @ across])

    return Hard(site, box((1.0, 1.0, 0.1)), run, LONG, steps, begin, measured)


CASES = (
    Case(
        "rockfall_stop",
        f"{COUNT} slabs stop on a slope of a terrain; where [m], against their equation of motion",
        LONG,
        (300, 600, 1200, 2400, 4800),
        ("nonsmooth",),
        rigid=stop_ways,
        hard=slabs,
        hard_steps=(300, 600, 1200, 2400, 4800),
    ),
)
