"""Worker processes of Dask, on this machine or on many, that fly chunks."""

from __future__ import annotations

import contextlib
import logging
import queue
import signal
import threading
from asyncio import CancelledError
from collections import Counter
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any, Self

from warpdem import __version__
from warpdem.errors import WarpdemError
from warpdem.rockfall.crew import TICK
from warpdem.running.interrupts import SIGNALS

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator, Sequence
    from types import TracebackType

    from warpdem.rockfall.chunks import Plan
    from warpdem.rockfall.flights import Starts
    from warpdem.rockfall.task import Prepared, Work

RETRIES = 2
"""How often a chunk is tried again whose worker failed."""

WAITING = 4
"""Chunks handed out for each worker: none waits for its next one, and memory stays small."""

PATIENCE = 1.0
"""How long to wait for workers to end before they are killed [s]."""

ANSWER = "10s"
"""How long to wait for a scheduler's answer."""

_own = threading.local()


def fly_chunk(work: Work, index: int, starts: Starts) -> bytes:
    """The file of one chunk; runs in a worker, which keeps its flyer for the next one.

    Raises:
        WarpdemError: The worker has another version of the program.
    """
    import distributed  # noqa: PLC0415 - the extra

    if work.program != __version__:
        raise WarpdemError(
            f"{distributed.get_worker().address}: this worker has warpdem {__version__}, "
            f"the run was started by {work.program}; install the same everywhere"
        )

    if getattr(_own, "fingerprint", None) != (work.fingerprint, work.device):
        _own.flyer = work.flyer()
        _own.fingerprint = (work.fingerprint, work.device)
    worker = distributed.get_worker()
    flights = _own.flyer.fly(starts, stop=lambda: worker.status != distributed.Status.running)
    return work.chunk(index, flights)


class Workers:
    """Dask's workers, used in a ``with`` statement."""

    def __init__(self, prepared: Prepared, scheduler: str | None, count: int) -> None:
        """Connect to a scheduler, or start ``count`` worker processes on this machine.

        Raises:
            WarpdemError: The extra is not installed, or the scheduler does not answer.
        """
        self._prepared = prepared
        self._client, self._cluster = _connected(scheduler, count)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        with contextlib.suppress(Exception):  # whatever is left ends with its processes
            self._client.close(timeout=PATIENCE)
        if self._cluster:
            with contextlib.suppress(Exception):
                self._cluster.close(timeout=PATIENCE)

    @property
    def count(self) -> int:
        """Of threads of workers there are now, at least one."""
        return max(1, sum(self._client.nthreads().values()))

    @property
    def about(self) -> dict[str, object]:
        """As of ``Crew``."""
        return {"workers": self.count, "scheduler": self._client.scheduler.address}

    def fly(self, plan: Plan, chunks: Sequence[int]) -> Generator[tuple[int, bytes] | None]:
        """As of ``Crew``."""
        work = self._shared()
        waiting, tries = list(reversed(chunks)), Counter[int]()
        running: dict[Any, int] = {}
        done: queue.SimpleQueue[Any] = queue.SimpleQueue()
        try:
            while waiting or running:
                while waiting and len(running) < WAITING * self.count:
                    future = self._submit(plan, waiting[-1], work)
                    running[future] = waiting.pop()
                    future.add_done_callback(done.put)
                future = _next(done)
                if future is None:
                    yield None
                    continue
                index = running.pop(future)
                data = _result(future, plan, index, lost=tries[index] < RETRIES)
                if data is None:
                    tries[index] += 1
                    waiting.append(index)
                    work = self._shared()
                    continue
                yield index, data
        finally:
            self._client.cancel(list(running))

    def _shared(self) -> Any:
        """The work on every worker.

        Raises:
            WarpdemError: There is no worker.
        """
        try:
            return self._client.scatter(self._prepared.work, broadcast=True)
        except TimeoutError as cause:
            raise WarpdemError(
                f"{self._client.scheduler.address}: this scheduler has no workers; start some "
                "with `dask worker ADDRESS`; --resume goes on"
            ) from cause

    def _submit(self, plan: Plan, index: int, work: Any) -> Any:
        starts = self._prepared.releases.starts(plan.ids(index))
        return self._client.submit(
            fly_chunk, work, index, starts, retries=RETRIES, pure=False, priority=-index
        )


def _next(done: queue.SimpleQueue[Any]) -> Any:
    """The next future that is done, None if it takes long."""
    try:
        return done.get(timeout=TICK)
    except queue.Empty:
        return None


def _connected(scheduler: str | None, count: int) -> tuple[Any, Any]:
    """A client, and the cluster it was made with, if any."""
    try:
        import distributed  # noqa: PLC0415 - the extra
        from dask import config  # noqa: PLC0415 - comes with it
    except ImportError as cause:
        raise WarpdemError(
            "--workers dask: needs the package distributed; pip install 'warpdem[dask]'"
        ) from cause
    if scheduler:
        try:
            return distributed.Client(scheduler, timeout=ANSWER), None
        except (OSError, ValueError, TypeError) as cause:
            raise WarpdemError(
                f"--scheduler {scheduler}: no scheduler answers there; start one with "
                "`dask scheduler` and give its address, such as tcp://host:8786"
            ) from cause
    allowed = {"distributed.scheduler.allowed-failures": RETRIES}
    with config.set(allowed), _signals_held():
        cluster = distributed.LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            dashboard_address="127.0.0.1:0",
            silence_logs=logging.ERROR,
        )
        return distributed.Client(cluster), cluster


@contextlib.contextmanager
def _signals_held() -> Iterator[None]:
    """Have signals wait, and new processes never see them: this one tells its workers to end."""
    resource_tracker.ensure_running()  # starting it later would let signals through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _result(future: Any, plan: Plan, index: int, *, lost: bool) -> bytes | None:
    """What a worker made of a chunk, None if it ended and took that, or the work, along.

    Args:
        future: Of the chunk.
        plan: How the ensemble is cut.
        index: Of the chunk.
        lost: It may be lost, and is tried again.

    Raises:
        WarpdemError: It failed each time.
    """
    try:
        return future.result()
    except WarpdemError:
        raise
    except (Exception, CancelledError) as cause:
        if lost and future.cancelled():
            return None
        ids = plan.ids(index)
        raise WarpdemError(
            f"chunk {index} (trajectories {ids[0]} to {ids[-1]}) failed {RETRIES + 1} times on "
            f"Dask's workers: {type(cause).__name__}: {cause}; --resume tries it again"
        ) from cause
