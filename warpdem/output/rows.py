"""Tables of numbers (.csv) that are written row by row and appear once they are whole."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from warpdem.output.durable import PART

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path
    from typing import TextIO

    from warpdem.arrays import FloatArray


@contextlib.contextmanager
def growing(path: Path, head: str) -> Iterator[TextIO]:
    """A text file open for rows below its head; it takes its place when the block ends well.

    Raises:
        OSError: The disk is full, or the folder cannot be written; no part is left behind.
    """
    part = path.with_name(path.name + PART)
    try:
        with part.open("w", encoding="utf-8", newline="\n") as file:
            file.write(f"{head}\n")
            yield file
        part.replace(path)
    except BaseException as fault:
        part.unlink(missing_ok=True)
        if isinstance(fault, OSError) and not fault.filename:  # a failed write knows no file
            raise OSError(fault.errno, fault.strerror, str(path)) from fault
        raise


def rows(form: str, columns: Sequence[Iterable[object]]) -> Iterator[str]:
    """Lines of a table, each made by a ``%`` form from one value of every column."""
    line = f"{form}\n"
    return (line % values for values in zip(*columns, strict=True))


def listed(table: FloatArray) -> list[list[float]]:
    """Columns of an array of rows."""
    return table.T.tolist()


def quoted(name: str) -> str:
    """A name as a CSV field (RFC 4180)."""
    if not {*name} & {*',"\r\n'}:
        return name
    return '"' + name.replace('"', '""') + '"'
