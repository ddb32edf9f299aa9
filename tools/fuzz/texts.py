"""Mutations of texts and bytes: what a slip of the hand, a broken disk or an odd program leaves."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from random import Random

NUMBER = re.compile(rb"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
STRING = re.compile(rb'"[^"\n]*"')
KEY = re.compile(rb"(?m)^\s*(\w+)\s*=")
VALUES = [
    *(b"nan", b"-nan", b"inf", b"-inf", b"0", b"-0.0", b"-1", b"1", b"2", b"1e308", b"-1e308"),
    *(b"1e-308", b"5e-324", b"1e400", b"1e20", b"-1e9", b"1e-20", b"9223372036854775807"),
    *(b"-9223372036854775809", b"18446744073709551616", b"1" + b"0" * 400, b"0x7f", b"1_000"),
    *(b'""', b'"x"', b'"auto"', b"'nan'", b"true", b"false", b"[]", b"{}", b"[[]]", b"[1]"),
    *(b"[0, 0, 0]", b"[nan, 0, 0]", b"[[1, 2], [3, 4]]", b"1979-05-27T07:32:00Z", b"07:32:00"),
    *(b'"\\u0000"', b'"../../x"', b'"/"', b'"files"', b'"a\\nb"', b'"' + b"y" * 5000 + b'"'),
]
NOISE = [b"\x00", b"\xff", b"\xef\xbb\xbf", *(bytes([c]) for c in b"\r\n\"'[]{}=#")]


def mutate(text: bytes, random: Random, others: list[bytes]) -> bytes:
    """The text after one to four mutations."""
    for _ in range(random.choice([1, 1, 1, 2, 2, 3, 4])):
        text = random.choice(MUTATIONS)(text, random, others)
    return text


def another_value(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """A number becomes any value."""
    return _replace(text, NUMBER, random.choice(VALUES), random)


def another_size(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """A number becomes larger, smaller or negative."""
    spans = list(NUMBER.finditer(text))
    if not spans:
        return text
    found = random.choice(spans)
    factor = random.choice([-1.0, 10.0, 0.1, 1e3, 1e-3, 1e6, 1e-6, 1e9, 1e-12])
    number = repr(float(found[0]) * factor).encode()
    return text[: found.start()] + number + text[found.end() :]


def another_string(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """A string becomes another one of the text, or any value."""
    strings = STRING.findall(text)
    chosen = random.choice(strings) if strings and random.random() < 0.7 else random.choice(VALUES)
    return _replace(text, STRING, chosen, random)


def misspelt_key(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """A key loses, doubles or swaps a letter, or becomes another key."""
    spans = list(KEY.finditer(text))
    if not spans:
        return text
    found = random.choice(spans)
    key = found[1]
    k = random.randrange(len(key))
    forms = [key[:k] + key[k + 1 :], key[:k] + key[k : k + 1] + key[k:], random.choice(spans)[1]]
    forms.append(key[:k] + key[k : k + 2][::-1] + key[k + 2 :])
    return text[: found.start(1)] + random.choice(forms) + text[found.end(1) :]


def lines_moved(text: bytes, random: Random, others: list[bytes]) -> bytes:
    """Some lines are left out, doubled, moved, or come from another text."""
    lines = text.splitlines(keepends=True) or [b""]
    k, n = random.randrange(len(lines)), random.choice([1, 1, 1, 2, 4, 8])
    block = lines[k : k + n]
    foreign = random.choice(others).splitlines(keepends=True)
    at = random.randrange(len(foreign)) if foreign else 0
    rest = lines[:k] + lines[k + n :]
    where = random.randrange(len(rest) + 1)
    forms = [rest, lines[:k] + block + lines[k:], rest[:where] + block + rest[where:]]
    forms.append(lines[:k] + foreign[at : at + n] + lines[k:])
    return b"".join(random.choice(forms))


def table_doubled(text: bytes, random: Random, others: list[bytes]) -> bytes:
    """A table is doubled, left out, or comes from another text."""
    tables = _tables(text)
    k = random.randrange(len(tables))
    foreign = random.choice(_tables(random.choice(others)))
    forms = [[*tables, tables[k]], tables[:k] + tables[k + 1 :], [*tables, foreign]]
    return b"".join(random.choice(forms))


def bytes_changed(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """A few bytes are changed, put in or left out."""
    if not text:
        return text
    k = random.randrange(len(text))
    noise = random.choice([*NOISE, bytes([random.randrange(256)]), random.randbytes(4)])
    n = random.choice([0, 1, 1, 2, 8])
    return text[:k] + random.choice([noise, b""]) + text[k + n :]


def truncated(text: bytes, random: Random, _others: list[bytes]) -> bytes:
    """The end is missing, or the middle, or all."""
    k, n = sorted(random.randrange(len(text) + 1) for _ in range(2))
    return random.choice([text[:k], text[:k] + text[n:], b""])


MUTATIONS = [
    *([another_value] * 5 + [another_size] * 5 + [another_string] * 4 + [misspelt_key] * 2),
    *([lines_moved] * 2 + [table_doubled] * 2 + [bytes_changed] * 2 + [truncated]),
]


def _replace(text: bytes, what: re.Pattern[bytes], by: bytes, random: Random) -> bytes:
    spans = [found.span() for found in what.finditer(text)]
    if not spans:
        return text
    start, end = random.choice(spans)
    return text[:start] + by + text[end:]


def _tables(text: bytes) -> list[bytes]:
    return re.split(rb"(?m)^(?=\[)", text)
