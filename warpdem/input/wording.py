"""Faults of a scene in words: key path, value, rule."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from warpdem.input.legal import entry, field_at, fields, homes, section_at, sections
from warpdem.input.scene_reading import Fault, Path
from warpdem.input.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from pydantic import ValidationError

WIDTH = 60
"""Letters of a value that a message shows."""

BESIDE_WORDS = {
    "dt": " or a number",
    "skin": " or a number",
    "orientation": " or a unit quaternion w, x, y, z",
}
"""What else a key takes that takes certain words."""

BESIDE_NUMBERS = {
    "dt": ' or "auto"',
    "skin": ' or "auto"',
    "trajectories": " or a list of such",
}
"""What else a key takes that takes a number."""

FIXED = {"finite_number": "must be finite", "string_too_short": "must not be empty"}
"""Rules without numbers, by pydantic's name."""

REASONS: dict[str | int, str] = {
    "en2": ": no finite dashpot takes all energy out of a rebound; 1e-4 comes near"
}
"""Why a key cannot be zero."""


def key_text(path: Path) -> str:
    """A key path as people write it: ``contact[0].en2``."""
    return "".join(f"[{p}]" if isinstance(p, int) else f".{_key(p)}" for p in path).lstrip(".")


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", name) else shown(name)


def shown(value: Any) -> str:
    """A value much as TOML writes it, on one line and short."""
    text = _toml(value, 3)
    return text if len(text) <= WIDTH else f"{text[:WIDTH]}..."


def _toml(value: Any, depth: int) -> str:
    if isinstance(value, Mapping):
        pairs = list(value.items())[:WIDTH] if depth else []
        inside = [f"{_key(str(key))} = {_toml(part, depth - 1)}" for key, part in pairs]
        return "{" + (", ".join(inside) if depth or not value else "...") + "}"
    if isinstance(value, list | tuple):
        inside = [_toml(part, depth - 1) for part in value[:WIDTH]] if depth else []
        return "[" + (", ".join(inside) if depth or not value else "...") + "]"
    return _scalar(value)


def _scalar(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value[: WIDTH + 10], ensure_ascii=False)
    return str(value).lower() if isinstance(value, bool) else str(value)


def kind_of(value: Any) -> str:
    """What a value is, as a person would say."""
    names = {
        bool: "true or false",
        str: "text",
        int: "a whole number",
        float: "a number",
        dict: "a table",
        list: "a list",
        tuple: "a list",
    }
    return names.get(type(value), "a date or time" if hasattr(value, "isoformat") else "this")


def faults_of(error: ValidationError, data: Any) -> list[Fault]:
    """The faults of single keys that validating the raw ``data`` of a scene brought up."""
    details = [dict(detail) for detail in error.errors(include_url=False)]
    return [fault for detail in details if (fault := _fault(detail, data))]


def _fault(detail: dict[str, Any], data: Any) -> Fault | None:
    kind, value = detail["type"], detail["input"]
    path = path_of(detail, data)
    context = detail.get("ctx", {})
    if kind == "default_factory_not_called" or (
        # Entries that are wrong themselves are also missed from their list.
        kind == "too_short" and len(value) >= context["min_length"]
    ):
        return None
    if kind in {"missing", "union_tag_not_found"}:
        path = path if kind == "missing" else (*path, "kind")
        return Fault(path, None, _missing(path, data))
    if kind == "union_tag_invalid":
        path, value = (*path, "kind"), value["kind"]
        return Fault(path, value, _choice(value, context["expected_tags"]))
    if kind == "extra_forbidden":
        return Fault(path, None, _unknown(path, data))
    if isinstance(value, Mapping):
        value = None
    return Fault(path, value, _rule(kind, path, detail, data))


def path_of(detail: dict[str, Any], data: Any) -> Path:
    """Key path of a fault in the file: pydantic's, without the names of union members."""
    if detail["type"] == "scene":  # of the rules across keys, which know it
        return tuple(detail["loc"])
    path: Path = ()
    for place, part in enumerate(detail["loc"]):
        if place and isinstance(detail["loc"][place - 1], int) and part == entry(data, "kind"):
            continue  # a member of a union, even if a key is called so too
        last = place == len(detail["loc"]) - 1
        inner = entry(data, part)
        if inner is not None or isinstance(part, int) or (last and detail["type"] == "missing"):
            path, data = (*path, part), inner
    return path


def _missing(path: Path, data: Any) -> str:
    field = field_at(path, data)
    options = [
        str(one.model_fields["kind"].annotation)
        for one in sections(getattr(field_at(path[:-1], data), "annotation", None))
        if path[-1] == "kind" and "kind" in one.model_fields
    ]
    if options:
        names = re.findall(r"'(\w+)'", " ".join(options))
        return f"missing: one of {_quoted(names)}"
    description = field.description if field else None
    return f"missing: {_first_clause(description)}" if description else "missing"


def _first_clause(description: str) -> str:
    clause = re.split(r"[;.](?:\s|$)", " ".join(description.split()))[0]
    return clause[:1].lower() + clause[1:]


def _quoted(names: list[str]) -> str:
    return ", ".join(f'"{name}"' for name in names)


def _choice(value: Any, expected: str) -> str:
    names = re.findall(r"'([^']+)'", expected)
    if not names:
        return f"must be {expected}"
    hint = did_you_mean(value, names) if isinstance(value, str) else ""
    return f"must be {'one of ' if len(names) > 1 else ''}{_quoted(names)}{hint}"


def _unknown(path: Path, data: Any) -> str:
    section = section_at(path[:-1], data)
    legal = list(fields(section)) if section else []
    key = str(path[-1])
    if nearest(key, legal):
        return f"unknown key{did_you_mean(key, legal)}"
    if elsewhere := homes(key):
        return f"unknown key here; it belongs to {', '.join(elsewhere)}"
    return f"unknown key; legal here: {', '.join(legal)}"


def _rule(kind: str, path: Path, detail: dict[str, Any], data: Any) -> str:
    value, context = detail["input"], detail.get("ctx", {})
    key = str(path[-1]) if path else ""
    match kind:
        case "scene":
            rule = context["rule"]
        case "value_error":
            rule = str(context["error"])
        case "literal_error":
            rule = _choice(value, context["expected"]) + BESIDE_WORDS.get(key, "")
        case "greater_than" | "greater_than_equal" | "less_than" | "less_than_equal":
            rule = _bounds(path, context, data) + (REASONS.get(key, "") if value == 0 else "")
        case "too_short" | "too_long":
            rule = _length(path, context, data)
        case _:
            also = BESIDE_NUMBERS.get(key, "")
            rule = FIXED.get(kind) or f"{_wanted(kind, path, data)}{also}, not {_got(path, value)}"
    return rule


def _got(path: Path, value: Any) -> str:
    if len(path) == 1 and isinstance(value, Mapping):
        return f"[{path[0]}]"
    if len(path) == 1 and isinstance(value, list) and value and isinstance(value[0], Mapping):
        return f"[[{path[0]}]]"
    return kind_of(value)


def _wanted(kind: str, path: Path, data: Any) -> str:
    field = field_at(path, data)
    tables = list(sections(field.annotation)) if field and kind != "string_type" else []
    name = str(path[0]) if path else ""
    if kind == "tuple_type":
        return f"must be written as [[{name}]]" if tables and len(path) == 1 else "must be a list"
    if tables:
        keys = " with " + ", ".join(fields(tables[0])) if len(tables) == 1 else ""
        return f"must be written as [{name}]" if len(path) == 1 else f"must be a table{keys}"
    words = {
        "float_type": "must be a number",
        "int_type": "must be a whole number",
        "string_type": "must be text in quotes",
        "bool_type": "must be true or false",
    }
    return words.get(kind, "must be of another kind")


def _length(path: Path, context: dict[str, Any], data: Any) -> str:
    least, most = context.get("min_length"), context.get("max_length")
    field = field_at(path, data)
    both = [
        getattr(one, name, None)
        for name in ("min_length", "max_length")
        for one in (field.metadata if field and not isinstance(path[-1], int) else [])
    ]
    exact = len({*both} - {None}) == 1 and len(both) - both.count(None) == 2
    limit = f"{least or most}" if exact else f"at least {least}" if least else f"at most {most}"
    return f"must have {limit} entries, not {context.get('actual_length', 'more')}"


def _bounds(path: Path, context: dict[str, Any], data: Any) -> str:
    field = field_at(path, data)
    own = {
        name: getattr(one, name)
        for one in (field.metadata if field else [])
        for name in ("gt", "ge", "lt", "le")
        if getattr(one, name, None) is not None
    }
    if len(own) == 2:
        low = f"({own['gt']:.12g}" if "gt" in own else f"[{own['ge']:.12g}"
        high = f"{own['lt']:.12g})" if "lt" in own else f"{own['le']:.12g}]"
        return f"must lie in {low}, {high}"
    words = {"gt": "greater than", "ge": "at least", "lt": "less than", "le": "at most"}
    ((name, limit),) = context.items()
    return f"must be {words[name]} {limit:.12g}"
