"""How many host threads take the steps: as many as are fastest, by measured time.

The result does not depend on the number of threads, so time may decide it. Few bodies are done
sooner than threads have met; a machine with other work may have no second core to give.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from warpdem.stepper import BATCH, Stepper

if TYPE_CHECKING:
    from collections.abc import Sequence

# each crew works so often in a trial, in turn; its best time counts
ROUNDS = 3
# for so many seconds or more: threads may be slow to come together
LASTING = 0.02
# seconds until the next trial: twice as long after each, up to the second number
SOON, LATE = 0.5, 30.0
# a larger crew has to save so much of the time
WORTH = 0.97


class Crews:
    """Steppers of one and of more host threads over the same lists, of which the fastest works.

    Attributes:
        best: The number of threads that works now.
        spent: Best seconds a cycle of each number of threads in the last trial.
        done: Cycles that each number of threads has done.
    """

    def __init__(self, steppers: Sequence[Stepper]) -> None:
        self._steppers = {len(stepper): stepper for stepper in steppers}
        self.best = max(self._steppers)
        self.spent: dict[int, float] = {}
        self.done = dict.fromkeys(self._steppers, 0)
        self._trials: list[int] = []
        self._lasted, self._cycles = 0.0, 0
        self._pause = SOON
        self._again = 0.0

    def prepare(self) -> None:
        """Take up new lists."""
        for stepper in self._steppers.values():
            stepper.prepare()

    def close(self) -> None:
        """Let the host threads go."""
        for stepper in self._steppers.values():
            stepper.close()

    def cycles(self, count: int) -> None:
        """Run up to ``count`` cycles; fewer when the clock halts."""
        if len(self._steppers) > 1 and not self._trials and time.perf_counter() >= self._again:
            self._trials = list(self._steppers) * (ROUNDS + 1)
            self.spent = {}
        while count > 0 and self._trials:
            batch = min(count, BATCH)
            if not self._try(batch):
                return
            count -= batch
        self._run(self.best, count)

    def _run(self, size: int, count: int) -> bool:
        stepper = self._steppers[size]
        before = stepper.steps
        whole = stepper.cycles(count)
        self.done[size] += stepper.steps - before
        return whole

    def _try(self, count: int) -> bool:
        """Part of a batch of the next crew of a trial; False where the clock halts."""
        size = self._trials[0]
        before, begin = self.done[size], time.perf_counter()
        whole = self._run(size, count)
        self._lasted += time.perf_counter() - begin
        self._cycles += self.done[size] - before
        if self._lasted >= LASTING and self._cycles:
            self._note(size)
        return whole

    def _note(self, size: int) -> None:
        spent = self._lasted / self._cycles
        if len(self._trials) <= ROUNDS * len(self._steppers):
            # the first batch of each records its loop
            self.spent[size] = min(self.spent.get(size, spent), spent)
        self._lasted, self._cycles = 0.0, 0
        self._trials.pop(0)
        if not self._trials:
            self._choose()

    def _choose(self) -> None:
        best = min(self._steppers)
        for size in sorted(self._steppers):
            if self.spent[size] < WORTH * self.spent[best]:
                best = size
        self.best = best
        self._again = time.perf_counter() + self._pause
        self._pause = min(2.0 * self._pause, LATE)
