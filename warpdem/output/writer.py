"""A thread that writes while the simulation goes on."""

from __future__ import annotations

import queue
import threading
from typing import TYPE_CHECKING, Self

from warpdem.errors import OutputError

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

QUEUED = 4
"""Jobs that may wait; the simulation pauses rather than fill the memory with frames."""


class Writer:
    """Runs jobs in order on one thread; used in a ``with`` statement, which ends the thread.

    After a job has failed the later ones are dropped, and every call raises its fault.
    """

    def __init__(self) -> None:
        self._jobs: queue.Queue[Callable[[], object] | None] = queue.Queue(QUEUED)
        self._fault: Exception | None = None
        self._thread = threading.Thread(target=self._work, name="writer", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Finish the jobs that wait; a fault is raised unless another error is on its way."""
        self._jobs.put(None)
        self._thread.join()
        if error is None:
            self._raise_fault()

    def put(self, job: Callable[[], object]) -> None:
        """Have a job done after those before it.

        Raises:
            OutputError: An earlier job failed.
        """
        self._raise_fault()
        self._jobs.put(job)

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                if self._fault is None:
                    job()
            except Exception as fault:  # noqa: BLE001 - raised again in the main thread
                self._fault = fault

    def _raise_fault(self) -> None:
        if isinstance(self._fault, OSError):
            raise OutputError(told(self._fault)) from self._fault
        if self._fault is not None:
            raise self._fault


def told(fault: OSError) -> str:
    """One line for a fault of the system: the file, and what the system says of it."""
    return f"{fault.filename}: {fault.strerror}" if fault.filename else str(fault.strerror or fault)
