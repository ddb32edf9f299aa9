"""Ctrl-C and SIGTERM: taken note of, so that a step can be finished first."""

from __future__ import annotations

import signal
import threading
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from types import TracebackType

SIGNALS = (signal.SIGINT, signal.SIGTERM)

SIGNALLED = 128
"""Exit status of a program ended by a signal, less the signal's number."""


class Interrupted(KeyboardInterrupt):
    """A signal came while there was nothing yet worth finishing.

    Attributes:
        number: The signal.
    """

    def __init__(self, number: int = signal.SIGINT) -> None:
        self.number = number
        super().__init__(f"stopped by signal {number}")


class Interrupts:
    """Takes note of the first signal within a ``with`` statement; those after it do nothing more.

    Python delivers signals to the main thread only: in another one nothing is changed.

    Attributes:
        received: The signal, or None.
        patient: Whether a signal waits for whoever looks at ``received``; else it raises
            ``Interrupted`` where the program stands.
    """

    def __init__(self) -> None:
        self.received: int | None = None
        self.patient = False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._note) for number in SIGNALS}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _note(self, number: int, _frame: object) -> None:
        if self.received is None:
            self.received = number
            if not self.patient:
                raise Interrupted(number)
