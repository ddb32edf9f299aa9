"""What decides the trajectories of a scene, so that chunks of different ones are never mixed."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from warpdem import __version__
from warpdem.output.checkpoint import digest, leaves

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.input.scene import Scene

FREE = ("title", "run.device", "ensemble.chunk", "terrain.crs")
"""Keys on which no trajectory depends."""

CELLS = "output.cellsize"
"""The key of the output on which chunks depend: the cells in which they count."""

COMPANIONS = {".shp": (".dbf", ".shx")}
"""Files that are read with one of a suffix, where there are any."""


def decisive(scene: Scene) -> dict[str, Any]:
    """The keys that decide the trajectories and their values, files by their contents too."""
    flat = {
        key: value
        for key, value in leaves(scene.model_dump(mode="json"))
        if key not in FREE and (key == CELLS or not key.startswith("output."))
    }
    for key, value in list(flat.items()):
        if key.rpartition(".")[2] == "file" and isinstance(value, str):
            flat |= _contents(key, scene.directory / value)
    return {**flat, "version of warpdem": __version__}


def fingerprint(keys: dict[str, Any]) -> str:
    """One short text for all of the decisive keys."""
    return hashlib.sha256(json.dumps(keys, sort_keys=True).encode()).hexdigest()


def changed(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """The keys that differ, sorted."""
    absent = object()
    return sorted(k for k in old.keys() | new.keys() if old.get(k, absent) != new.get(k, absent))


def _contents(key: str, path: Path) -> dict[str, str]:
    found = {f"{key} (contents)": digest(path)}
    for suffix in COMPANIONS.get(path.suffix.lower(), ()):
        if (companion := path.with_suffix(suffix)).exists():
            found[f"{key} (contents of {suffix})"] = digest(companion)
    return found
