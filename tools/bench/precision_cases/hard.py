"""Runs of the nonsmooth method with a fixed step, and cases that only it has."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from slopes import fixed_step, flyer

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
        begin = time.perf_counter()
        self._trajectories.fly(self._begin)
        return time.perf_counter() - begin
