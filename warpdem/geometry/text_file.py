"""Texts of input files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpdem.errors import GeometryError

if TYPE_CHECKING:
    from pathlib import Path


def text_of(path: Path) -> str:
    """The text of a file in UTF-8, with or without a byte order mark.

    Raises:
        GeometryError: It cannot be read.
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "is no text"
        raise GeometryError(f"{path}: cannot be read: {reason}") from None
