"""A scene's tables as TOML for people: sections, remarks, numbers with all their digits."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


def toml(tables: Mapping[str, Any], head: Sequence[str], remarks: Mapping[str, str]) -> str:
    """The text of a scene.

    Args:
        tables: Values, tables, and lists of tables by name, in the order in which they come out.
        head: Lines of the remark at the top.
        remarks: What is said above the first table of a name.
    """
    lines = [_remark(line) for line in head]
    flat = {key: value for key, value in tables.items() if not _is_section(value)}
    lines += ["", *(_entry(key, value) for key, value in flat.items())]
    for name, value in tables.items():
        if name not in flat:
            lines += _section(name, value, remarks.get(name, ""))
    return "\n".join(lines) + "\n"


def _is_section(value: Any) -> bool:
    return isinstance(value, Mapping) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)
    )


def _section(name: str, value: Any, remark: str) -> Iterator[str]:
    tables = value if isinstance(value, list) else [value]
    header = f"[[{name}]]" if isinstance(value, list) else f"[{name}]"
    for number, table in enumerate(tables):
        yield ""
        if remark and number == 0:
            yield _remark(remark)
        yield header
        yield from (_entry(key, part) for key, part in table.items())


def _remark(line: str) -> str:
    return ("# " + re.sub(r"[\x00-\x1f\x7f]", " ", line)).rstrip()


def _entry(key: str, value: Any) -> str:
    return f"{key} = {inline(value)}"


def inline(value: Any) -> str:
    """A value on one line; a float comes back to the last bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{" + ", ".join(_entry(key, part) for key, part in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(inline, value)) + "]"
    return repr(value)
