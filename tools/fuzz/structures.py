"""Mutations of the tables of a scene after the scene's own JSON schema: nearly valid ones."""

from __future__ import annotations

import copy
import functools
import json
import math
import tomllib
from typing import TYPE_CHECKING, Any

from warpdem.input.decode import schema_text

if TYPE_CHECKING:
    from random import Random

NUMBERS = [0.0, -1.0, 1.0, 0.5, 2.0, 10.0, 1e-3, 1e-9, 1e3, 1e9, 1e300, 1e-300, math.nan, math.inf]
INTEGERS = [0, 1, -1, 2, 3, 7, 100, 2**31, 2**63 - 1, -(2**63)]
WORDS = ["", "x", "default", "auto", "rock", "wall", "cube", "ball", "files/slope.asc", "0.1 * t"]
DEEP = 6


def mutate(text: str, random: Random) -> str:
    """The scene after one to three changes of its tables; the text itself where it is no TOML."""
    try:
        scene = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError):
        return text
    for _ in range(random.choice([1, 1, 2, 3])):
        random.choice(CHANGES)(scene, random)
    return "".join(f"{_key(key)} = {written(value)}\n" for key, value in scene.items())


def key_added(scene: dict[str, Any], random: Random) -> None:
    """A key that the schema knows for such a table, with a value it may have."""
    table = random.choice(_tables_of(scene))
    schema = _schema_of(table) if table is not scene else _schema()
    missing = [key for key in schema.get("properties", {}) if key not in table]
    if missing:
        key = random.choice(missing)
        table[key] = made(schema["properties"][key], random)


def value_made(scene: dict[str, Any], random: Random) -> None:
    """A value becomes another one that its key may have."""
    table = random.choice(_tables_of(scene))
    schema = _schema_of(table) if table is not scene else _schema()
    known = [key for key in table if key in schema.get("properties", {})]
    if known:
        key = random.choice(known)
        table[key] = made(schema["properties"][key], random)


def key_dropped(scene: dict[str, Any], random: Random) -> None:
    """A key is missing."""
    table = random.choice(_tables_of(scene))
    if table:
        del table[random.choice(list(table))]


def entry_doubled(scene: dict[str, Any], random: Random) -> None:
    """An entry of an array is doubled, left out, or wrapped in another array."""
    lists = [v for t in _tables_of(scene) for v in t.values() if isinstance(v, list) and v]
    if not lists:
        return
    chosen = random.choice(lists)
    k = random.randrange(len(chosen))
    form = random.randrange(3)
    if form == 0:
        chosen.append(copy.deepcopy(chosen[k]))
    elif form == 1:
        del chosen[k]
    else:
        chosen[k] = [chosen[k]]


def value_moved(scene: dict[str, Any], random: Random) -> None:
    """A value of one key goes to another."""
    tables = [table for table in _tables_of(scene) if table]
    here, there = random.choice(tables), random.choice(tables)
    value = here[random.choice(list(here))]
    if value is not there:
        there[random.choice(list(there))] = copy.deepcopy(value)


CHANGES = [key_added, key_added, value_made, value_made, value_made, key_dropped, entry_doubled]
CHANGES += [value_moved]


def made(schema: dict[str, Any], random: Random, deep: int = 0) -> Any:
    """A value after a schema; at the borders of what it allows, now and then beyond."""
    if "$ref" in schema:
        return made(_definitions()[schema["$ref"].rpartition("/")[2]], random, deep)
    for several in ("anyOf", "oneOf"):
        if several in schema:
            return made(random.choice(schema[several]), random, deep)
    kind = schema.get("type")
    if kind in {"object", "array"} and deep < DEEP:
        return (_table if kind == "object" else _array)(schema, random, deep)
    return random.choice(_plain(schema))


def _plain(schema: dict[str, Any]) -> list[Any]:
    """Values among which a number, a word or a boolean may be."""
    if "const" in schema:
        return [schema["const"]]
    if "enum" in schema:
        return schema["enum"]
    borders = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
    told = [schema[key] for key in borders if key in schema]
    wild = {"boolean": [True, False], "number": NUMBERS, "integer": INTEGERS}
    return [*told, *wild.get(schema.get("type", ""), WORDS)]


def _table(schema: dict[str, Any], random: Random, deep: int) -> dict[str, Any]:
    needed = schema.get("required", [])
    keys = [k for k in schema.get("properties", {}) if k in needed or random.random() < 0.3]
    return {key: made(schema["properties"][key], random, deep + 1) for key in keys}


def _array(schema: dict[str, Any], random: Random, deep: int) -> list[Any]:
    if "prefixItems" in schema:
        return [made(item, random, deep + 1) for item in schema["prefixItems"]]
    least = schema.get("minItems", 0)
    count = min(schema.get("maxItems", least + 3), least + random.randrange(4))
    return [made(schema.get("items", {}), random, deep + 1) for _ in range(count)]


@functools.cache
def _schema() -> dict[str, Any]:
    return json.loads(schema_text())


def _definitions() -> dict[str, Any]:
    return _schema()["$defs"]


def _schema_of(table: dict[str, Any]) -> dict[str, Any]:
    """The definition that a table fits best."""

    def fit(schema: dict[str, Any]) -> tuple[int, int]:
        properties = schema.get("properties", {})
        kind = properties.get("kind", {}).get("const")
        known = sum(key in properties for key in table)
        return (known + 10 * (kind is not None and kind == table.get("kind")), -len(properties))

    return max(_definitions().values(), key=fit)


def _tables_of(value: Any) -> list[dict[str, Any]]:
    found = [value] if isinstance(value, dict) else []
    parts = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return found + [table for part in parts for table in _tables_of(part)]


def written(value: Any) -> str:
    """TOML of a value, tables inline."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(k)} = {written(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(written, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, float):
        return repr(value)
    return str(value)


def _key(key: str) -> str:
    return key if key.isidentifier() and key.isascii() else json.dumps(key)
