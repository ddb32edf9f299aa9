"""Single keys of a scene set from the command line: ``--set contact.0.mu=0.3``."""

from __future__ import annotations

import re
import tomllib
from typing import TYPE_CHECKING, Any

from warpdem.input.legal import entry, field_at, fields, is_list, section_at
from warpdem.input.suggestions import did_you_mean
from warpdem.input.wording import key_text

if TYPE_CHECKING:
    from warpdem.input.scene_reading import Path


def apply(assignment: str, data: dict[str, Any]) -> tuple[dict[str, Any], Path]:
    """The raw scene with one key set, and the path of that key.

    Args:
        assignment: ``key.path=value``; entries of lists by number from 0 (``contact.0.mu`` or
            ``contact[0].mu``); a value that is not TOML is text.
        data: The raw tables of a scene.

    Raises:
        ValueError: There is no such key; the message lists those there are.
    """
    name, equals, value = assignment.partition("=")
    path = _path(name)
    if not equals or not path:
        raise ValueError("write it as key.path=value, such as contact.0.mu=0.3")
    return _with(data, (), path, _value(value.strip()), data), path


def _with(node: Any, done: Path, rest: Path, value: Any, data: dict[str, Any]) -> Any:
    """A copy of ``node``, which lies at ``done`` in ``data``, with the entry at ``rest`` set."""
    if not rest:
        return value
    part = rest[0]
    _must_exist(node, done, part, data)
    inner = _with(entry(node, part), (*done, part), rest[1:], value, data)
    if isinstance(node, list) and isinstance(part, int):
        return [*node[:part], inner, *node[part + 1 :]]
    return {**(node if isinstance(node, dict) else {}), part: inner}


def _path(name: str) -> Path:
    parts = re.sub(r"\[(\d+)\]", r".\1", name.strip()).split(".")
    # Nine digits: longer lists there are none, longer numbers Python may refuse to read.
    return tuple(int(p) if re.fullmatch(r"[0-9]{1,9}", p) else p for p in parts if p)


def _value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        # TOML knows 0.1 but not .1, which people write too.
        return float(text) if re.fullmatch(r"[+-]?(\d+\.|\.\d+)(e[+-]?\d+)?", text) else text
    return parsed["value"] if parsed.keys() == {"value"} else text


def _must_exist(node: Any, path: Path, part: str | int, data: dict[str, Any]) -> None:
    place = key_text(path) or "the scene"
    section = section_at(path, data)
    many = isinstance(node, list) or (node is None and is_list(field_at(path, data)))
    if many and not (isinstance(part, int) and part < len(node or ())):
        count = len(node or ())
        raise ValueError(
            f"{place} has {f'the entries 0 to {count - 1}' if count else 'no entries'}, not {part}"
        )
    if not many and not section and not isinstance(node, dict):
        raise ValueError(f"{place} is a value, it has no keys")
    legal = list(fields(section)) if section else list(node or ())
    if not many and part not in legal:
        hint = did_you_mean(str(part), legal)
        raise ValueError(f"{place} has no key {part}{hint or ';'} its keys are {', '.join(legal)}")
