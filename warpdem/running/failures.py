"""How a run that fails ends: its summary says so, and the error says how to go on."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Protocol

from warpdem.errors import OutputError, UnstableError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from warpdem.running.progress import Progress


class Summarise(Protocol):
    """Writes the summary of a run."""

    def __call__(self, status: str, **more: str) -> None:
        """Write it with what else is known."""
        ...


@contextlib.contextmanager
def summarised(
    progress: Progress, summarise: Summarise, way_on: Callable[[], str]
) -> Iterator[None]:
    """Have the summary tell of a failure of what is run within, and the line of progress end.

    Args:
        progress: Where the run tells of itself.
        summarise: Writes the summary.
        way_on: What to do when results cannot be written; empty if there is nothing.
    """
    try:
        yield
    except UnstableError as fault:
        summarise("unstable", error=str(fault))
        raise
    except OutputError as fault:
        with contextlib.suppress(OutputError):
            summarise("failed", error=str(fault))
        raise OutputError("; ".join(filter(None, (str(fault), way_on())))) from fault
    finally:
        progress.clear()
