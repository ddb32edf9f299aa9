"""Programs beside warpdem, one file each: whether it is installed, and one timed run of it."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from speed.problem import Problem


@dataclass(frozen=True)
class Timing:
    """One timed run.

    Attributes:
        wall: Seconds of the loop, as the program itself says.
        steps: Steps in it.
        bodies: Free bodies.
        cpu: Seconds of CPU time of the loop, where the program can tell.
        facts: Contacts and what else is known of the end.
    """

    wall: float
    steps: int
    bodies: int
    cpu: float | None = None
    facts: dict[str, Any] = field(default_factory=dict)

    @property
    def speed(self) -> float:
        """Body-steps per second of the wall clock."""
        return self.bodies * self.steps / self.wall

    @property
    def cpu_speed(self) -> float | None:
        """Body-steps per second of CPU time, of all threads together."""
        return self.bodies * self.steps / self.cpu if self.cpu else None


@dataclass(frozen=True)
class Run:
    """What to run: a problem, where its files go, on how many threads, for how many steps."""

    problem: Problem
    folder: Path
    threads: int
    warm: int
    steps: int


@dataclass(frozen=True)
class Peer:
    """A program to compare with.

    Attributes:
        name: As in tables.
        install: How to get it.
        missing: Why it cannot run here; None if it can.
        timed: One run.
    """

    name: str
    install: str
    missing: Callable[[], str | None]
    timed: Callable[[Run], Timing]


def without(program: str) -> str | None:
    """Why a command cannot run."""
    return None if shutil.which(program) else f"no command {program}"
