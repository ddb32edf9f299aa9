"""Runs an ensemble of trajectories into a folder, from the folder's claim to the results."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from typing import TYPE_CHECKING

from warpdem.output.ensemble_folder import claimed
from warpdem.output.folder import CHUNKS
from warpdem.output.scene_keys import differing, refuse_differing
from warpdem.rockfall import task
from warpdem.rockfall.campaign import Campaign
from warpdem.rockfall.chunk_folder import (
    Agreement,
    ChunkFolder,
    agree,
    agreed,
)
from warpdem.rockfall.chunks import planned
from warpdem.rockfall.crew import Threads
from warpdem.rockfall.fingerprint import decisive, fingerprint
from warpdem.rockfall.share import Share
from warpdem.running.interrupts import Interrupts
from warpdem.running.progress import Progress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.input.scene import Scene
    from warpdem.rockfall.crew import Crew
    from warpdem.rockfall.task import Prepared

WHOLE = Share()
"""All of an ensemble, on threads of this process."""


def run_rockfall(
    scene: Scene,
    directory: str | Path,
    *,
    device: str | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    share: Share = WHOLE,
) -> int:
    """Fly the trajectories of a scene and write their results.

    An ensemble is kept in chunks, files that are whole or absent; a finished one is never flown
    again, so a run that was stopped, killed or out of disk goes on with ``resume`` as though it
    had never stopped. Shards may fill one folder at the same time, each with its own chunks;
    they go on with the chunks that are there without being told to. Whichever finds the last
    chunk there writes the results; ``resume`` without a shard flies what is missing and writes
    them, which gives the same bytes whenever it is done.

    Args:
        scene: What to simulate; ``run.method`` is "nonsmooth".
        directory: Folder of the results, made if need be.
        device: ``auto``, ``cpu``, ``cuda`` or ``cuda:N``; default: the scene's.
        threads: Host threads, or worker processes on this machine; default: all cores. Results
            do not depend on it.
        resume: Go on with the chunks in the folder.
        force: Replace the results in the folder. Files of other origin stay.
        quiet: Say nothing on standard error.
        share: Which chunks are flown, and on what.

    Returns:
        Exit status: 0, or 130 and 143 when SIGINT or SIGTERM ended it.

    Raises:
        WarpdemError: The folder, the scene or the device does not allow it.
        UnstableError: A trajectory blew up; chunks that were finished stay.
        OutputError: Results cannot be written; finished chunks are good.
        Interrupted: A signal came before the first trajectory; nothing was written.
    """
    progress, keys = Progress(quiet=quiet), decisive(scene)
    with (
        Interrupts() as signals,
        claimed(Path(directory), resume=resume, force=force, shard=share.shard) as folder,
        contextlib.ExitStack() as crews,
    ):
        path = folder / CHUNKS
        before = None if force else agreed(path)
        if before:
            refuse_differing(folder.path, differing(before.keys, keys))
        name = _device(device or scene.run.device)
        progress.work("reading the scene's files")
        prepared = task.prepared(scene, name, fingerprint(keys))
        crew = None
        if not before:  # what cannot fly leaves older results alone
            crew = crews.enter_context(_crew(prepared, share, threads, progress))
            signals.patient = True
            plan = planned(
                prepared.releases.count,
                scene.ensemble.chunk,
                crew.count * (share.shard.count if share.shard else 1),
                cuda=prepared.work.is_cuda,
            )
            if not share.shard:
                folder.clear()
            before = agree(path, Agreement(plan, keys))
            # another shard may have come first
            refuse_differing(folder.path, differing(before.keys, keys))
        elif not share.shard:
            folder.clear_parts()
        chunks = ChunkFolder(path, before)
        todo = chunks.missing(_mine(share, len(chunks)), progress.tell)
        if todo and not crew:
            crew = crews.enter_context(_crew(prepared, share, threads, progress))
        signals.patient = True
        campaign = Campaign(scene, prepared, folder, chunks, progress, signals, share.shard)
        return campaign.run(crew if todo else None, todo)


def _mine(share: Share, count: int) -> list[int]:
    """The chunks that are this process's."""
    every = range(count)
    return share.shard.of(every) if share.shard else list(every)


def _device(name: str) -> str:
    """The full name of a Warp device.

    Raises:
        WarpdemError: There is no such device.
    """
    from warpdem.devices import find_device  # noqa: PLC0415 - loads Warp

    return str(find_device(name))


@contextlib.contextmanager
def _crew(
    prepared: Prepared, share: Share, threads: int | None, progress: Progress
) -> Iterator[Crew]:
    """Those who fly: Dask's workers, one thread for a GPU, or a thread for each core."""
    count = threads or os.cpu_count() or 1
    if share.workers:
        from warpdem.rockfall.workers import Workers  # noqa: PLC0415 - only where they are wanted

        progress.work("starting workers")
        with Workers(prepared, share.scheduler, count) as workers:
            yield workers
    else:
        yield Threads(prepared, 1 if prepared.work.is_cuda else count, progress.work)
