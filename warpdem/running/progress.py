"""What a run tells of itself while it goes on: one line, renewed."""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from collections.abc import Callable

TERMINAL_PERIOD = 0.2
"""Least time between two renewals of a terminal's line [s]."""

LOG_PERIOD = 30.0
"""Time between two lines where there is no terminal [s]."""


@dataclass
class Progress:
    """Progress on a stream: a line renewed in place in a terminal, else one every half minute.

    Attributes:
        quiet: Say nothing.
        stream: Where to; default: standard error.
        clock: Wall clock [s].
    """

    quiet: bool = False
    stream: TextIO = field(default_factory=lambda: sys.stderr)
    clock: Callable[[], float] = time.monotonic

    def __post_init__(self) -> None:
        self._terminal = self.stream.isatty()
        self._period = TERMINAL_PERIOD if self._terminal else LOG_PERIOD
        self._due = self.clock() + (0.0 if self._terminal else LOG_PERIOD)
        self._pending = False

    def is_due(self) -> bool:
        """Whether it is time to renew the line."""
        return not self.quiet and self.clock() >= self._due

    def show(self, text: str) -> None:
        """Renew the line if it is time."""
        if self.is_due():
            self._due = self.clock() + self._period
            self._write(f"\r\x1b[K{text}" if self._terminal else f"{text}\n")
            self._pending = self._terminal

    def work(self, text: str) -> None:
        """Say what is being done before the first step; a terminal shows each one at once."""
        if self._terminal:
            self._due = self.clock()
        self.show(text)

    def tell(self, text: str) -> None:
        """Write a line that stays."""
        self.clear()
        self._write(f"{text}\n")

    def clear(self) -> None:
        """Wipe the renewed line off a terminal."""
        if self._pending:
            self._write("\r\x1b[K")
        self._pending = False

    def _write(self, text: str) -> None:
        if self.quiet:
            return
        try:
            self.stream.write(text)
            self.stream.flush()
        except (OSError, ValueError):  # nobody reads any more: the run goes on
            self.quiet = True


def duration(seconds: float) -> str:
    """Wall-clock time as a person says it, such as ``2 h 05 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
