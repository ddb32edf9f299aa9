"""Which keys the scene format has, and where."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import UnionType
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args, get_origin

from warpdem.input.scene import Scene
from warpdem.input.scene_values import Section

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

    from warpdem.input.scene_reading import Path


def sections(annotation: Any) -> Iterator[type[Section]]:
    """The kinds of table a field may hold."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    for part in get_args(annotation):
        yield from sections(part)


def fields(section: type[Section]) -> dict[str, FieldInfo]:
    """The fields of a kind of table by the keys of a file."""
    return {field.alias or name: field for name, field in section.model_fields.items()}


def section_of(annotation: Any, table: Any) -> type[Section] | None:
    """The kind of table that ``table`` is meant to be."""
    choice = list(sections(annotation))
    if len(choice) > 1:
        kind = table.get("kind") if isinstance(table, Mapping) else None
        choice = [one for one in choice if kind in get_args(one.model_fields["kind"].annotation)]
    return choice[0] if choice else None


def section_at(path: Path, data: Any) -> type[Section] | None:
    """The kind of table at ``path`` of raw data; None where there is none, or it is unknown."""
    section: type[Section] | None = Scene
    annotation: Any = Scene
    for part in path:
        data = entry(data, part)
        if isinstance(part, str):
            if section is None or part not in fields(section):
                return None
            annotation = fields(section)[part].annotation
        section = section_of(annotation, data)
    return section


def entry(data: Any, part: str | int) -> Any:
    """One entry of a table or list; None where it has none."""
    if isinstance(data, list | tuple) and isinstance(part, int):
        return data[part] if 0 <= part < len(data) else None
    return data.get(part) if isinstance(data, Mapping) else None


def field_at(path: Path, data: Any) -> FieldInfo | None:
    """The field that ``path``, or the list it is an entry of, belongs to."""
    while path and isinstance(path[-1], int):
        path = path[:-1]
    section = section_at(path[:-1], data) if path else None
    return fields(section).get(str(path[-1])) if section else None


def is_list(field: FieldInfo | None) -> bool:
    """Whether a field holds a list."""
    return field is not None and _holds_tuple(field.annotation)


def _holds_tuple(annotation: Any) -> bool:
    if get_origin(annotation) in {Annotated, Union, UnionType}:
        return any(_holds_tuple(part) for part in get_args(annotation))
    return get_origin(annotation) is tuple


def homes(key: str) -> list[str]:
    """The tables that have this key, as a file writes them."""
    found = []
    for name, field in Scene.model_fields.items():
        choice = list(sections(field.annotation))
        if any(key in fields(one) for one in choice):
            found.append(f"[[{name}]]" if is_list(field) else f"[{name}]")
    return found
