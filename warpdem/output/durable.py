"""Files that are either whole or absent, whenever the power goes."""

from __future__ import annotations

import os
import uuid
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

PART = ".part"
"""Suffix of a file that is still being written."""


def sync(path: Path) -> None:
    """Have the disk hold what was written to a file, or the names within a folder."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def swap(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file beside its place and move it there: a reader sees the old one or the new one.

    Args:
        path: The file to make or to replace.
        write: Writes the file at the path it is given.

    Raises:
        OSError: The disk is full, or the folder cannot be written; no part is left behind.
    """
    part = path.with_name(path.name + PART)
    try:
        write(part)
        part.replace(path)
    except BaseException as fault:
        part.unlink(missing_ok=True)
        if isinstance(fault, OSError):  # a failed write does not know its file
            raise OSError(fault.errno, fault.strerror, str(path)) from fault
        raise


def replace(path: Path, write: Callable[[Path], object]) -> None:
    """Swap a file once the disk holds it whole: power may go, an older one stays until then.

    Args and errors as of :func:`swap`.
    """

    def write_through(part: Path) -> None:
        write(part)
        sync(part)

    swap(path, write_through)


def create(path: Path, data: bytes) -> bool:
    """Make a file, whole, unless there is one: of many processes that try, one does it.

    Returns:
        Whether this one did.

    Raises:
        OSError: The disk is full, or the folder cannot be written; no part is left behind.
    """
    part = path.with_name(f"{path.stem}_{uuid.uuid4().hex}{path.suffix}{PART}")
    try:
        part.write_bytes(data)
        sync(part)
        _link(part, path)
    except FileExistsError:
        return False
    except OSError as fault:
        raise OSError(fault.errno, fault.strerror, str(path)) from fault
    finally:
        part.unlink(missing_ok=True)
    return True


def _link(part: Path, path: Path) -> None:
    """Give a file its second name, which must be free."""
    try:
        os.link(part, path)
    except FileExistsError:
        raise
    except OSError:  # a file system without links: who comes second at the same instant wins
        if path.exists():
            raise FileExistsError(str(path)) from None
        part.replace(path)
