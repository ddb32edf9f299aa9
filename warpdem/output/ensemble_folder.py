"""The folder of an ensemble: one run alone, or many shards at a time."""

from __future__ import annotations

import contextlib
import os
from typing import TYPE_CHECKING

from warpdem.errors import OutputError, WarpdemError
from warpdem.output.durable import PART
from warpdem.output.folder import CHUNKS, lock, locked, refuse_occupied
from warpdem.output.writer import told

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from warpdem.output.folder import RunFolder
    from warpdem.rockfall.share import Shard


@contextlib.contextmanager
def claimed(
    path: Path, *, resume: bool, force: bool, shard: Shard | None = None
) -> Iterator[RunFolder]:
    """The folder of an ensemble, made if need be, and locked against runs of another kind.

    A shard joins an ensemble that is there, whether or not it resumes.

    Args:
        path: The folder.
        resume: Go on with the ensemble in it.
        force: Write a new one over it.
        shard: The part that is flown; None: all.

    Raises:
        WarpdemError: It holds files and none of the three is given, it is no folder, there is
            nothing to resume, another run is writing to it, or a shard would remove the others'.
        OutputError: It cannot be written.
    """
    if shard and force:
        raise WarpdemError(
            f"{path}: --shard {shard} with --force would remove what other shards write; "
            "remove the old results first, or give another --out"
        )
    planned = (path / CHUNKS / "plan.json").is_file()
    if resume and not planned and not shard:
        raise WarpdemError(f"{path}: holds no chunks to resume from")
    if not (planned and (resume or shard)) and not _is_blank(path):
        refuse_occupied(path, force=force)
    with locked(path, shared=shard is not None) as folder:
        if not shard:
            yield folder
            return
        with _alone(folder, shard):
            yield folder


def _is_blank(path: Path) -> bool:
    """Whether nothing is in a folder but what a run leaves that ended before its first chunk."""
    if not path.is_dir() or {entry.name for entry in path.iterdir()} - {CHUNKS}:
        return False
    return all(entry.suffix in {".lock", PART} for entry in (path / CHUNKS).glob("*"))


@contextlib.contextmanager
def _alone(folder: RunFolder, shard: Shard) -> Iterator[None]:
    """Hold that nobody else flies the same chunks: not this shard, nor shards of another count."""
    chunks = folder / CHUNKS
    name = f"shard_{shard.number}_of_{shard.count}.lock"
    with held(chunks / name) as free:
        if not free:
            raise WarpdemError(f"{folder.path}: another run of --shard {shard} is writing to it")
        for other in chunks.glob("shard_*.lock"):
            if not other.name.endswith(f"_of_{shard.count}.lock") and not _is_free(other):
                raise WarpdemError(
                    f"{folder.path}: shards of another number than {shard.count} are writing to it"
                )
        yield


def _is_free(path: Path) -> bool:
    with held(path) as free:
        return free


@contextlib.contextmanager
def held(path: Path) -> Iterator[bool]:
    """A lock on a file, made if need be with its folder; False while another process holds it.

    Raises:
        OutputError: It cannot be made.
    """
    try:
        path.parent.mkdir(exist_ok=True)
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as fault:
        raise OutputError(told(fault)) from fault
    try:
        yield lock(handle)
    finally:
        os.close(handle)
