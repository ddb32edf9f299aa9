"""Which line of a TOML text each key stands on."""

from __future__ import annotations

import re
import tomllib
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.input.scene_reading import Path

TOKEN = re.compile(
    r"""
    (?P<text> \"{3} (?: \\. | (?!\"{3}) . )* \"{3,5} | '{3} (?: (?!'{3}) . )* '{3,5}
            | " (?: \\. | [^"\\\n] )* " | ' [^'\n]* ' )
    | (?P<comment> \# [^\n]* )
    | (?P<newline> \n )
    | (?P<mark> [][{}=,.] )
    | (?P<bare> [^][{}=,."'\#\s]+ )
    """,
    re.VERBOSE | re.DOTALL,
)


class Token(NamedTuple):
    """A word of the text, or what stands at its end."""

    kind: str
    text: str
    line: int


END = Token("end", "", 0)


def tokens(text: str) -> Iterator[Token]:
    """The words of a TOML text with their lines, comments left out."""
    line, seen = 1, 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", seen, match.start())
        seen = match.start()
        if match.lastgroup != "comment":
            yield Token(match.lastgroup or "", match[0], line)


class Scanner:
    """Walks over a text that is known to be TOML and notes where keys and entries begin."""

    def __init__(self, text: str) -> None:
        self.rest = tokens(text)
        self.token = next(self.rest, END)
        self.counts: dict[Path, int] = {}
        self.lines: dict[Path, int] = {}

    def scan(self) -> None:
        """Walk to the end."""
        table: Path = ()
        while self.token.kind != "end":
            if self.token.kind == "newline":
                self.advance()
            elif self.token.text == "[":
                table = self.header()
            else:
                self.assignment(table)

    def advance(self) -> Token:
        """The present token; go on to the next."""
        token, self.token = self.token, next(self.rest, END)
        return token

    def note(self, path: Path, line: int) -> None:
        """Every part of ``path`` not met before begins here."""
        for length in range(1, len(path) + 1):
            self.lines.setdefault(path[:length], line)

    def key(self) -> tuple[str, ...]:
        """A dotted key."""
        parts: list[str] = []
        while self.token.kind in {"bare", "text"} or self.token.text == ".":
            token = self.advance()
            if token.kind == "text":
                parts.append(tomllib.loads(f"{token.text} = 0").popitem()[0])
            elif token.text != ".":
                parts.append(token.text)
        return tuple(parts)

    def header(self) -> Path:
        """Path of the table whose header begins here."""
        line = self.advance().line
        array = self.token.text == "["
        if array:
            self.advance()
        *parents, last = self.key()
        path: Path = ()
        for part in parents:
            path = self.latest((*path, part))
        path = (*path, last)
        if array:
            self.counts[path] = self.counts.get(path, 0) + 1
        path = self.latest(path)
        self.note(path, line)
        while self.token.kind not in {"newline", "end"}:
            self.advance()
        return path

    def latest(self, path: Path) -> Path:
        """The last entry so far if ``path`` is an array of tables, else ``path``."""
        return (*path, self.counts[path] - 1) if path in self.counts else path

    def assignment(self, table: Path) -> None:
        """A key and its value."""
        line = self.token.line
        path = (*table, *self.key())
        self.note(path, line)
        if self.token.text == "=":
            self.advance()
            self.value(path)
        elif self.token.kind != "end":
            self.advance()

    def value(self, path: Path) -> None:
        """A value, with the keys and entries inside it."""
        opening = self.token.text
        if opening == "[":
            self.advance()
            self.entries(path)
        elif opening == "{":
            self.advance()
            self.inline_table(path)
        else:
            self.key_or_scalar()

    def key_or_scalar(self) -> None:
        """A value without parts; numbers come as words and full stops."""
        while self.token.kind in {"bare", "text"} or self.token.text == ".":
            self.advance()

    def entries(self, path: Path) -> None:
        """The entries of a list, up to its end."""
        index = 0
        while self.token.kind != "end" and self.token.text != "]":
            if self.token.text == ",":
                index += 1
                self.advance()
            elif self.token.kind == "newline" or self.token.text in {"}", "="}:
                self.advance()
            else:
                self.note((*path, index), self.token.line)
                self.value((*path, index))
        self.advance()

    def inline_table(self, path: Path) -> None:
        """The keys of a table in braces, up to its end."""
        while self.token.kind != "end" and self.token.text != "}":
            if self.token.kind in {"bare", "text"}:
                self.assignment(path)
            else:
                self.advance()
        self.advance()


def lines_of(text: str) -> dict[Path, int]:
    """Line of each key path of a TOML text, from 1; entries of lists are numbered from 0.

    Of what is no TOML after all the lines up to there are found.
    """
    scanner = Scanner(text)
    with suppress(ValueError, RecursionError):
        scanner.scan()
    return scanner.lines


def line_of(lines: Mapping[Path, int], path: Path) -> int | None:
    """The line of ``path``, or of the innermost table around it that the text has."""
    for length in range(len(path), 0, -1):
        if path[:length] in lines:
            return lines[path[:length]]
    return None
