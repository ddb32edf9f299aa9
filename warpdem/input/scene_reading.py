"""Reading keys off a scene that may be a checked `Scene` or the raw tables of a faulty file.

What has the wrong type reads as absent, its own fault being reported elsewhere: so the rules that
tie keys together can be tried on both, and all of a file's problems come out together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from keyword import iskeyword
from math import isfinite
from typing import Any

Path = tuple[str | int, ...]


@dataclass(frozen=True)
class Fault:
    """A broken rule, the key it is broken by, and that key's value (None: not worth showing)."""

    path: Path
    value: Any
    rule: str


def attribute(key: str) -> str:
    """What a key is called in Python, where words such as ``class`` are taken."""
    return f"{key}_" if iskeyword(key) else key


def read(table: Any, key: str) -> Any:
    """The value of a key of a table or model; None when it has none."""
    return table.get(key) if isinstance(table, Mapping) else getattr(table, attribute(key), None)


def given(table: Any, key: str) -> bool:
    """Whether the key was written rather than left at its default."""
    if isinstance(table, Mapping):
        return key in table
    return attribute(key) in getattr(table, "model_fields_set", ())


def text(table: Any, key: str) -> str | None:
    """The value of a key if it is text."""
    value = read(table, key)
    return value if isinstance(value, str) else None


def _finite(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    try:
        return float(value) if isfinite(value) else None
    except OverflowError:
        return None


def number(table: Any, key: str) -> float | None:
    """The value of a key if it is a finite number."""
    return _finite(read(table, key))


def numbers(table: Any, key: str, count: int) -> list[float] | None:
    """The value of a key if it is a list of ``count`` finite numbers."""
    values = [number for value in entries(table, key) if (number := _finite(value)) is not None]
    return values if len(values) == count else None


def entries(table: Any, key: str) -> Sequence[Any]:
    """The value of a key if it is a list; a single table counts as a list of one."""
    value = read(table, key)
    if isinstance(value, Mapping):
        return [value]
    return value if isinstance(value, list | tuple) else ()


def tables(scene: Any, key: str) -> Iterator[tuple[int, Any]]:
    """Number and table of each entry of an array of tables."""
    for index, entry in enumerate(entries(scene, key)):
        if isinstance(entry, Mapping) or hasattr(entry, "model_fields_set"):
            yield index, entry


def group_of(entry: Any) -> str | None:
    """Group of a body or fill; None when it is unreadable."""
    value = read(entry, "group")
    return "default" if value is None else value if isinstance(value, str) else None
