"""When something is due that comes at a steady interval, and at the end."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf


@dataclass
class Schedule:
    """Multiples of an interval from 0 on, and the end.

    Attributes:
        interval: Between two of them [s].
        end: The last one [s]; a multiple within a billionth of the interval of it is the end.
        last: The one done last [s]; negative before the first.
    """

    interval: float
    end: float
    last: float = -1.0

    def due(self, now: float) -> float:
        """The next one after ``last`` and not before ``now``, infinite when the end is done [s]."""
        tolerance = 1e-9 * self.interval
        if self.last >= self.end - tolerance:
            return inf
        count = max(0, int(max(self.last, now) / self.interval))
        while count * self.interval <= self.last + tolerance or count * self.interval < now:
            count += 1
        due = count * self.interval
        return self.end if due >= self.end - tolerance else due

    @property
    def done(self) -> bool:
        """The end has come."""
        return self.due(0.0) == inf
