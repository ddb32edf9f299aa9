"""Those who fly chunks: host threads, each with a flyer of its own."""

from __future__ import annotations

import queue
import threading
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from warpdem.rockfall.chunks import Plan
    from warpdem.rockfall.task import Flyer, Prepared

TICK = 0.1
"""Longest time between two looks at the clock and at signals [s]."""


class Crew(Protocol):
    """Flies chunks in any order."""

    @property
    def count(self) -> int:
        """How many chunks it flies at a time."""
        ...

    @property
    def about(self) -> dict[str, object]:
        """What it consists of, for the summary."""
        ...

    def fly(self, plan: Plan, chunks: Sequence[int]) -> Generator[tuple[int, bytes] | None]:
        """Fly chunks: each one's number and file as it is done, None every so often.

        Closing the iterator abandons what is in flight.

        Raises:
            WarpdemError: A trajectory went wrong.
        """
        ...


class Threads:
    """Host threads that take chunks from a queue; on CUDA there should be one."""

    def __init__(self, prepared: Prepared, count: int, progress: Callable[[str], object]) -> None:
        self._prepared = prepared
        progress("compiling kernels")
        first = prepared.work.flyer()
        self._flyers = [first, *(first.twin() for _ in range(count - 1))]
        self._lock = threading.Lock()

    @property
    def count(self) -> int:
        """As of ``Crew``."""
        return len(self._flyers)

    @property
    def about(self) -> dict[str, object]:
        """As of ``Crew``."""
        return {"threads": self.count}

    def fly(self, plan: Plan, chunks: Sequence[int]) -> Generator[tuple[int, bytes] | None]:
        """As of ``Crew``."""
        todo: queue.SimpleQueue[int] = queue.SimpleQueue()
        done: queue.SimpleQueue[tuple[int, bytes] | Exception] = queue.SimpleQueue()
        stop = threading.Event()
        for index in chunks:
            todo.put(index)
        threads = [
            threading.Thread(target=self._work, args=(flyer, plan, todo, done, stop))
            for flyer in self._flyers[: len(chunks)]
        ]
        for thread in threads:
            thread.start()
        try:
            yield from _each(done, len(chunks))
        finally:
            stop.set()
            for thread in threads:
                thread.join()

    def _work(
        self,
        flyer: Flyer,
        plan: Plan,
        todo: queue.SimpleQueue[int],
        done: queue.SimpleQueue[tuple[int, bytes] | Exception],
        stop: threading.Event,
    ) -> None:
        """Fly chunks until there are none left, one goes wrong, or it is time to stop."""
        try:
            while not stop.is_set():
                index = todo.get_nowait()
                with self._lock:
                    starts = self._prepared.releases.starts(plan.ids(index))
                flights = flyer.fly(starts, stop=stop.is_set)
                done.put((index, self._prepared.work.chunk(index, flights)))
        except queue.Empty:
            return
        except Exception as fault:  # noqa: BLE001 - raised again in the main thread
            if not stop.is_set():  # else it says that it stopped
                done.put(fault)


def _each(
    done: queue.SimpleQueue[tuple[int, bytes] | Exception], count: int
) -> Generator[tuple[int, bytes] | None]:
    """What comes from a queue until ``count`` chunks have come, None in between."""
    while count:
        try:
            item = done.get(timeout=TICK)
        except queue.Empty:
            yield None
            continue
        if isinstance(item, Exception):
            raise item
        count -= 1
        yield item
