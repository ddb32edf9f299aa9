"""One process's part of an ensemble: chunks flown, kept and made into results."""

from __future__ import annotations

import contextlib
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from warpdem import __version__
from warpdem.errors import OutputError
from warpdem.output import summary
from warpdem.output.ensemble_folder import held
from warpdem.output.writer import told
from warpdem.rockfall import finish
from warpdem.rockfall.account import account
from warpdem.running.failures import summarised
from warpdem.running.interrupts import SIGNALLED, Interrupted
from warpdem.running.progress import duration

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.input.scene import Scene
    from warpdem.output.folder import RunFolder
    from warpdem.rockfall.chunk_folder import ChunkFolder
    from warpdem.rockfall.crew import Crew
    from warpdem.rockfall.share import Shard
    from warpdem.rockfall.task import Prepared
    from warpdem.running.interrupts import Interrupts
    from warpdem.running.progress import Progress

GOES_ON = "finished chunks are good, --resume goes on from them"


@dataclass
class Campaign:
    """One process's part of an ensemble.

    Attributes:
        scene: What is simulated.
        prepared: The same, ready to fly.
        folder: Where results go.
        chunks: Where chunks go.
        progress: Where it tells of itself.
        interrupts: The signals that end it.
        shard: Its part; None: all.
    """

    scene: Scene
    prepared: Prepared
    folder: RunFolder
    chunks: ChunkFolder
    progress: Progress
    interrupts: Interrupts
    shard: Shard | None

    def __post_init__(self) -> None:
        self._began = time.monotonic()
        self._stored = 0
        self._about: dict[str, Any] = {}
        self._seconds = 0.0

    def run(self, crew: Crew | None, todo: Sequence[int]) -> int:
        """Fly what is to be flown, and write the results once no chunk is missing.

        Args:
            crew: Who flies; None when there is nothing to do.
            todo: The chunks to fly.

        Returns:
            Exit status: 0, or 130 and 143 when SIGINT or SIGTERM ended it.

        Raises:
            WarpdemError: A trajectory went wrong.
            OutputError: Chunks or results cannot be written.
        """
        with summarised(self.progress, self._summarise, lambda: GOES_ON):
            if crew:
                self._fly(crew, todo)
            if not self.interrupts.received and self.chunks.complete:
                return self._conclude()
        return self._leave()

    def _fly(self, crew: Crew, todo: Sequence[int]) -> None:
        """Fly chunks and keep each one, until none is left or a signal comes."""
        plan, self._about = self.chunks.plan, crew.about
        before = sum(plan.trajectories(index) for index in self._mine()) - sum(
            plan.trajectories(index) for index in todo
        )
        began = time.monotonic()
        with contextlib.closing(crew.fly(plan, todo)) as flights:
            for done in flights:
                if done:
                    self.chunks.store(*done)
                    self._stored += plan.trajectories(done[0])
                self._seconds = time.monotonic() - began
                if self.progress.is_due():
                    self.progress.show(self._line(before))
                if self.interrupts.received:
                    break

    def _mine(self) -> list[int]:
        """The chunks of this process's part."""
        every = range(len(self.chunks))
        return self.shard.of(every) if self.shard else list(every)

    def _line(self, before: int) -> str:
        """Where the flying stands."""
        whole = sum(self.chunks.plan.trajectories(index) for index in self._mine())
        done = before + self._stored
        rate = self._stored / max(self._seconds, 1e-9)
        left = duration((whole - done) / rate) if rate > 0.0 else "?"
        return (
            f"{done} of {whole} trajectories ({done / whole:.0%}), {rate:.3g} trajectories/s, "
            f"{left} left"
        )

    def _conclude(self) -> int:
        """Write the results, unless another shard is about to."""
        with self._merging() as mine:
            if not mine:
                self.progress.tell(f"{self._part('finished')}; another shard writes the results")
                return 0
            try:
                self._write()
            except Interrupted as stop:
                self.progress.tell(
                    f"stopped while results were being written; --resume writes them to "
                    f"{self.folder.path}"
                )
                return SIGNALLED + stop.number
        self.progress.tell(f"{self._part('finished')}; results in {self.folder.path}")
        return 0

    @contextlib.contextmanager
    def _merging(self) -> Iterator[bool]:
        """Whether the results are this process's to write; without shards they always are."""
        if not self.shard:
            yield True
            return
        with held(self.chunks.path / "merge.lock") as mine:
            yield mine

    def _write(self) -> None:
        self.progress.work("writing results")
        self.interrupts.patient = False
        try:
            finish.finish(self.folder, self.scene, self.prepared, self.chunks)
        except OSError as fault:
            raise OutputError(told(fault)) from fault
        finally:
            self.interrupts.patient = True
        self._summarise("finished")

    def _leave(self) -> int:
        """Say what is still to be done."""
        received = self.interrupts.received
        if not self.shard:
            self._summarise("interrupted")
        missing = len(self.chunks) - len(self.chunks.present())
        onward = (
            "--resume goes on"
            if received
            else f"{missing} chunks of other shards are missing, the last shard writes the results"
        )
        part = self._part("stopped" if received else "finished")
        self.progress.tell(f"{part} in {self.folder.path}; {onward}")
        return SIGNALLED + received if received else 0

    def _part(self, how: str) -> str:
        name = f"shard {self.shard} " if self.shard else ""
        return f"{name}{how}: {self._stored} trajectories flown"

    def _summarise(self, status: str, **more: str) -> None:
        """Write the summary; shards but the last one would write over each other's."""
        if self.shard and status != "finished":
            return
        try:
            summary.save(self.folder.summary, {"status": status, **more, **self._facts(status)})
        except OSError as fault:
            raise OutputError(told(fault)) from fault

    def _facts(self, status: str) -> dict[str, Any]:
        work, plan = self.prepared.work, self.chunks.plan
        there = self.chunks.present()
        whole = status == "finished"  # else nobody waits until all chunks are read
        return {
            "title": self.scene.title,
            "scene": str(self.scene.source or ""),
            "seed": self.scene.run.seed,
            "duration": self.scene.run.duration,
            "asked": plan.count,
            "trajectories": sum(plan.trajectories(index) for index in there),
            **(account(self.chunks) if whole else {}),
            "chunks": {
                "size": plan.size,
                "count": len(plan),
                "done": len(there),
            },
            "unverified_classes": [
                entry.name for entry in work.site.classes if entry.source == "unverified"
            ],
            "device": work.device,
            **self._about,
            "trajectories_this_session": self._stored,
            "trajectories_per_s": self._stored / max(self._seconds, 1e-9),
            "wall_seconds": time.monotonic() - self._began,
            "versions": summary.versions(__version__),
        }
