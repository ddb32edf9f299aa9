"""Rules on bodies at rest that may sleep."""

from __future__ import annotations

from math import hypot
from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, number, numbers, read

if TYPE_CHECKING:
    from collections.abc import Iterator

FALL = 0.1
"""Part of free fall that rest may hide: a body that accelerates less counts as at rest."""


def sleepers_stand_alone(scene: Any) -> Iterator[Fault]:
    """Neither bonds nor a periodic cell are looked at while bodies sleep."""
    sleep = read(read(scene, "run"), "sleep")
    if sleep is None:
        return
    if read(scene, "cell") is not None:
        yield Fault(("run", "sleep"), None, "not in a periodic cell: leave out [cell] or this")
    if entries(scene, "bond"):
        yield Fault(("run", "sleep"), None, "not with bonds: leave out [[bond]] or this")


def rest_is_no_fall(scene: Any) -> Iterator[Fault]:
    """What falls, or slides from rest, must be seen before it falls asleep."""
    sleep = read(read(scene, "run"), "sleep")
    speed, after = number(sleep, "speed"), number(sleep, "after")
    vector = numbers(read(scene, "gravity"), "vector", 3) or [0.0, 0.0, -9.81]
    fastest = 0.5 * FALL * hypot(*vector) * (after or 0.0)
    if speed and fastest and speed > fastest:
        rule = f"what begins to fall would sleep: at most {fastest:.3g} with this run.sleep.after"
        yield Fault(("run", "sleep", "speed"), speed, rule)


SLEEP_RULES = (sleepers_stand_alone, rest_is_no_fall)
