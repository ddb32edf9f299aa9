"""The words of a text file, each with its line for messages."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from warpdem.errors import Problem, SceneError

if TYPE_CHECKING:
    from pathlib import Path

COMMENT = ("#", "!", "/")
"""What a keyword does not begin with: the rest of the line is a remark."""

LARGEST, SMALLEST = 1e30, 1e-30
"""Bounds of what scenes compute with."""


class Misread(Exception):  # noqa: N818 - it ends the reading of a keyword, not the program
    """A word is not what should stand there."""


@dataclass(frozen=True)
class Place:
    """Where something stands.

    Attributes:
        file: The file.
        line: Counted from 1.
    """

    file: Path
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"

    def problem(self, message: str) -> Problem:
        """A fault at this place."""
        return Problem(str(self), "", message)


class Words:
    """The words of a file, read one after the other as a C++ stream reads them."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._words = [
            (number, word)
            for number, line in enumerate(text.splitlines(), 1)
            for word in line.split()
        ]
        self._next = 0

    @property
    def place(self) -> Place:
        """Where the word read last stands."""
        if not self._words:
            return Place(self._path, 1)
        return Place(self._path, self._words[max(self._next - 1, 0)][0])

    def keyword(self) -> str:
        """The next word that is no remark; empty at the end of the file."""
        while self._next < len(self._words):
            word = self._words[self._next][1]
            self._next += 1
            if not word.startswith(COMMENT):
                return word
            self.skip_line()
        return ""

    def skip_line(self) -> None:
        """Go to the line after that of the word read last."""
        line = self.place.line
        while self._next < len(self._words) and self._words[self._next][0] <= line:
            self._next += 1

    def word(self, wanted: str) -> str:
        """The next word.

        Raises:
            Misread: There is none.
        """
        if self._next == len(self._words):
            raise Misread(f"the file ends where {wanted} should stand")
        self._next += 1
        return self._words[self._next - 1][1]

    def real(self, wanted: str) -> float:
        """The next word as a number.

        Raises:
            Misread: It is none, or not finite.
        """
        word = self.word(wanted)
        try:
            number = float(word)
        except ValueError:
            number = float("nan")
        if not isfinite(number):
            raise Misread(f"{wanted} should be a number, not {word!r}")
        if abs(number) > LARGEST:
            raise Misread(f"{wanted} = {word} is too large to compute with, beyond {LARGEST:g}")
        return number

    def integer(self, wanted: str) -> int:
        """The next word as a whole number.

        Raises:
            Misread: It is none.
        """
        word = self.word(wanted)
        try:
            return int(word)
        except ValueError:
            raise Misread(f"{wanted} should be a whole number, not {word!r}") from None

    def count(self, wanted: str) -> int:
        """The next word as a whole number from 0 on.

        Raises:
            Misread: It is none.
        """
        number = self.integer(wanted)
        if number < 0:
            raise Misread(f"{wanted} should be a whole number from 0, not {number}")
        return number

    def vector(self, wanted: str, length: int = 3) -> tuple[float, ...]:
        """The next words as numbers.

        Raises:
            Misread: One of them is none.
        """
        return tuple(self.real(wanted) for _ in range(length))


def words_of(path: Path) -> Words:
    """The words of a file.

    Raises:
        SceneError: It cannot be read.
    """
    try:
        return Words(path, path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        reason = f"cannot be read: {(error.strerror or str(error)).lower()}"
    except UnicodeDecodeError:
        reason = "is no text"
    raise SceneError(str(path), [Problem(str(path), "", reason)])
