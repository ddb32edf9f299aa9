"""The scene of a run key by key, to see whether another one would go on with it."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from warpdem.errors import WarpdemError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from warpdem.input.scene import Scene

NAMED = 5
"""Changed keys an error names; the others it counts."""

COMPANIONS = {".shp": (".dbf", ".shx")}
"""Files that are read with one of a suffix, where there are any."""


def flat_scene(scene: Scene) -> dict[str, Any]:
    """Key paths such as ``contact[0].mu`` and their values; files by their contents too."""
    flat = dict(_leaves(scene.model_dump(mode="json")))
    for key, value in list(flat.items()):
        if key.rpartition(".")[2] == "file" and isinstance(value, str):
            flat |= _contents(key, scene.directory / value)
    return flat


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Key paths of nested tables, and their values."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for index, item in enumerate(value):
            yield from _leaves(item, f"{path}[{index}]")
    else:
        yield path, value


def _contents(key: str, path: Path) -> dict[str, str]:
    found = {f"{key} (contents)": _digest(path)}
    for suffix in COMPANIONS.get(path.suffix.lower(), ()):
        if (companion := path.with_suffix(suffix)).exists():
            found[f"{key} (contents of {suffix})"] = _digest(companion)
    return found


def _digest(path: Path) -> str:
    """What stands for the contents of a file: their hash, or why it cannot be read."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as fault:
        return str(fault.strerror)


def differing(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """The keys that differ, sorted."""
    absent = object()
    return sorted(k for k in old.keys() | new.keys() if old.get(k, absent) != new.get(k, absent))


def refuse_differing(path: Path, keys: Sequence[str]) -> None:
    """Hold that no key differs between a scene and the results in a folder.

    Raises:
        WarpdemError: Some do; the message names the first ``NAMED``.
    """
    if keys:
        more = f" and {len(keys) - NAMED} more" if len(keys) > NAMED else ""
        raise WarpdemError(
            f"{path}: cannot go on, the scene differs from the one that was run in "
            f"{', '.join(keys[:NAMED])}{more}; give another --out, or --force to start again"
        )
