"""The folder of a run: who may write to it, and which of its files are a run's own."""

from __future__ import annotations

import contextlib
import os
import re
from typing import TYPE_CHECKING

from warpdem.errors import OutputError, WarpdemError
from warpdem.output.durable import PART
from warpdem.output.writer import told

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

try:
    import fcntl
except ImportError:  # not a POSIX system: two runs in one folder go unnoticed
    fcntl = None

CHUNKS = "chunks"
"""Folder within a run's own."""

_PER_CELL = (
    r"passages|deposits|reach_probability|(energy|speed|jump|spin)_(mean|median|q90|q95|q99|max)"
)

OWN = re.compile(
    r"((bodies|contacts|cell)(_\d{6,}\.vtu|\.pvd)"
    r"|(trajectory|energy|drivers|cell|bonds|fragments)\.csv|summary\.json|checkpoint\.npz"
    r"|(deposits|barriers|barrier_statistics|trajectories)\.csv"
    r"|(trajectories|terrain|rocks)\.vtu|map\.png"
    rf"|{CHUNKS}/(chunk_\d{{6,}}\.npz|plan(_[0-9a-f]{{32}})?\.json|(shard_\d+_of_\d+|merge)\.lock)"
    rf"|({_PER_CELL})\.(asc|prj|tif))"
    rf"({re.escape(PART)})?"
)
"""Names of the files a run writes, from its folder on."""


class RunFolder:
    """A folder claimed by one run.

    Attributes:
        path: The folder.
    """

    def __init__(self, path: Path) -> None:
        self.path = path

    def __truediv__(self, name: str) -> Path:
        return self.path / name

    @property
    def checkpoint(self) -> Path:
        """The checkpoint's file."""
        return self.path / "checkpoint.npz"

    @property
    def summary(self) -> Path:
        """The summary's file."""
        return self.path / "summary.json"

    def own_files(self) -> list[Path]:
        """Files in the folder that a run wrote, parts of unfinished ones included."""
        return sorted(
            path
            for path in (*self.path.iterdir(), *(self.path / CHUNKS).glob("*"))
            if OWN.fullmatch(path.relative_to(self.path).as_posix()) and path.is_file()
        )

    def clear(self) -> None:
        """Remove what an earlier run wrote, and nothing else."""
        for path in self.own_files():
            path.unlink()
        with contextlib.suppress(OSError):  # absent, or others' files are in it
            (self.path / CHUNKS).rmdir()

    def clear_parts(self) -> None:
        """Remove files that were being written when a run was killed."""
        for path in self.own_files():
            if path.name.endswith(PART):
                path.unlink()


@contextlib.contextmanager
def claimed(path: Path, *, resume: bool, force: bool) -> Iterator[RunFolder]:
    """The folder of a run, made if need be, and locked against other runs.

    Args:
        path: The folder.
        resume: Go on with the run in it.
        force: Write a new run over the one in it.

    Raises:
        WarpdemError: It holds files and neither ``resume`` nor ``force`` is given, it is no
            folder, there is nothing to resume, or another run is writing to it.
        OutputError: It cannot be written.
    """
    if resume:
        if not RunFolder(path).checkpoint.is_file():
            raise WarpdemError(f"{path}: holds no checkpoint to resume from")
    else:
        refuse_occupied(path, force=force)
    with locked(path) as folder:
        yield folder


@contextlib.contextmanager
def locked(path: Path, *, shared: bool = False) -> Iterator[RunFolder]:
    """A folder, made if need be, that no other run claims meanwhile; removed if it stays empty.

    Args:
        path: The folder.
        shared: Others who say so too may claim it at the same time.

    Raises:
        WarpdemError: Another run is writing to it.
        OutputError: It cannot be written.
    """
    made = not path.exists()
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK | os.X_OK):
            raise PermissionError(13, "not writable", str(path))
        handle = os.open(path, os.O_RDONLY)
    except OSError as fault:
        raise OutputError(told(fault)) from fault
    try:
        if not lock(handle, shared=shared):
            raise WarpdemError(f"{path}: another run is writing to it")
        yield RunFolder(path)
    finally:
        os.close(handle)
        if made:
            with contextlib.suppress(OSError):  # what was written stays
                path.rmdir()


def refuse_occupied(path: Path, *, force: bool) -> None:
    """Hold that a new run may write to a folder.

    Raises:
        WarpdemError: It is a file, or holds files and ``force`` is not given.
    """
    if path.exists() and not path.is_dir():
        raise WarpdemError(f"{path}: is a file; results need a folder")
    if not force and path.is_dir() and any(path.iterdir()):
        way_out = "give another --out, --force to write over its results, or --resume"
        raise WarpdemError(f"{path}: already holds files; {way_out}")


def lock(handle: int, *, shared: bool = False) -> bool:
    """Lock an open file until it is closed; False if another process holds it."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(handle, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # a file system without locks
        return True
    return True
