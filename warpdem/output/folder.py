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

OWN = re.compile(
    r"((bodies|contacts|cell)(_\d{6,}\.vtu|\.pvd)"
    r"|(trajectory|energy|drivers|cell|bonds|fragments)\.csv|summary\.json|checkpoint\.npz)"
    rf"({re.escape(PART)})?"
)
"""Names of the files a run writes."""


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
        return sorted(path for path in self.path.iterdir() if OWN.fullmatch(path.name))

    def clear(self) -> None:
        """Remove what an earlier run wrote, and nothing else."""
        for path in self.own_files():
            path.unlink()

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
    folder = RunFolder(path)
    _check(folder, resume=resume, force=force)
    made = not path.exists()
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK | os.X_OK):
            raise PermissionError(13, "not writable", str(path))
        handle = os.open(path, os.O_RDONLY)
    except OSError as fault:
        raise OutputError(told(fault)) from fault
    try:
        _lock(handle, path)
        yield folder
    finally:
        os.close(handle)
        if made and path.is_dir() and not any(path.iterdir()):
            path.rmdir()


def _check(folder: RunFolder, *, resume: bool, force: bool) -> None:
    path = folder.path
    if resume:
        if not folder.checkpoint.is_file():
            raise WarpdemError(f"{path}: holds no checkpoint to resume from")
        return
    if path.exists() and not path.is_dir():
        raise WarpdemError(f"{path}: is a file; results need a folder")
    if not force and path.is_dir() and any(path.iterdir()):
        way_out = "give another --out, --force to write over its results, or --resume"
        raise WarpdemError(f"{path}: already holds files; {way_out}")


def _lock(handle: int, path: Path) -> None:
    if fcntl is None:
        return
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise WarpdemError(f"{path}: another run is writing to it") from None
    except OSError:  # a file system without locks
        return
