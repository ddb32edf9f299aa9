"""Paired runs: all programs in turn, then all again, so that a busy machine slows them alike."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from speed.peers import Timing


def alternating(
    runs: Mapping[str, Callable[[], Timing]], repeats: int
) -> dict[str, tuple[Timing, ...]]:
    """Timings of each program, in order of the rounds; every other round runs backwards."""
    found: dict[str, list[Timing]] = {name: [] for name in runs}
    for turn in range(repeats):
        for name in list(runs)[:: -1 if turn % 2 else 1]:
            found[name].append(runs[name]())
    return {name: tuple(each) for name, each in found.items()}


def middle(timings: Sequence[Timing]) -> Timing:
    """The run of the median speed; the slower one of two."""
    return sorted(timings, key=lambda one: one.speed)[(len(timings) - 1) // 2]


def paired_ratio(ours: Sequence[Timing], theirs: Sequence[Timing]) -> float:
    """Median over the rounds of our speed over theirs, by the wall clock."""
    return median(a.speed / b.speed for a, b in zip(ours, theirs, strict=True))


def paired_cpu_ratio(ours: Sequence[Timing], theirs: Sequence[Timing]) -> float | None:
    """The same by CPU time; None where a program does not tell."""
    pairs = [(a.cpu_speed, b.cpu_speed) for a, b in zip(ours, theirs, strict=True)]
    known = [a / b for a, b in pairs if a and b]
    return median(known) if known else None


def cpu_speed(timings: Sequence[Timing]) -> float | None:
    """Median of the body-steps per second of CPU time; None where a program does not tell."""
    known = [one.cpu_speed for one in timings if one.cpu_speed]
    return median(known) if known else None
