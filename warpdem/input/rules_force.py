"""Rules on the forces on single bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, given, group_of, read, tables, text
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

ONCE = ("fluid", "numerical_damping", "velocity_barrier")


def forces(scene: Any) -> Iterator[Fault]:
    """A force says what it needs, once, and acts on groups there are."""
    first: dict[str, int] = {}
    for index, force in tables(scene, "force"):
        kind = text(force, "kind") or ""
        if kind in ONCE and first.setdefault(kind, index) != index:
            rule = f"force[{first[kind]}] is of this kind already: there can be one"
            yield Fault(("force", index, "kind"), kind, rule)
        if kind == "drag" and read(force, "coefficient") is not None:
            for key in ("viscosity", "cx"):
                if given(force, key):
                    rule = "coefficient stands for viscosity cx: leave one of the two out"
                    yield Fault(("force", index, key), read(force, key), rule)
        if kind == "fluid" and (file := text(force, "file")):
            yield from _file(index, force, file)
        if kind == "velocity_barrier":
            yield from _barrier(index, force)
        yield from _groups(scene, index, force)


def _file(index: int, force: Any, file: str) -> Iterator[Fault]:
    suffix = file.lower().rpartition(".")[2]
    if suffix not in {"vti", "npz"}:
        yield Fault(("force", index, "file"), file, "must be a .vti or .npz file")
    if suffix == "npz" and read(force, "array") is not None:
        rule = 'only a .vti has named arrays: a .npz holds "velocity"'
        yield Fault(("force", index, "array"), read(force, "array"), rule)


def _barrier(index: int, force: Any) -> Iterator[Fault]:
    limits = [key for key in ("velocity", "spin") if read(force, key) is not None]
    if not limits:
        yield Fault(("force", index, "velocity"), None, "missing: a barrier needs velocity or spin")
    for key in ("velocity", "spin"):
        name = f"{key}_exponent"
        if limits and key not in limits and given(force, name):
            yield Fault(("force", index, name), read(force, name), f"has no effect without {key}")


def _groups(scene: Any, index: int, force: Any) -> Iterator[Fault]:
    known = {text(group, "name") for _, group in tables(scene, "group")}
    known |= {group_of(entry) for kind in ("body", "fill") for _, entry in tables(scene, kind)}
    names = sorted(name for name in known if name)
    for place, name in enumerate(entries(force, "groups")):
        if isinstance(name, str) and name not in names:
            rule = f"no group, body or fill uses this name{did_you_mean(name, names)}"
            yield Fault(("force", index, "groups", place), name, rule)
