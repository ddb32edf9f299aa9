"""What decides the trajectories of a scene, so that chunks of different ones are never mixed."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from warpdem import __version__
from warpdem.output.scene_keys import flat_scene

if TYPE_CHECKING:
    from warpdem.input.scene import Scene

FREE = ("title", "run.device", "ensemble.chunk", "terrain.crs")
"""Keys on which no trajectory depends."""

CELLS = "output.cellsize"
"""The key of the output on which chunks depend: the cells in which they count."""


def decisive(scene: Scene) -> dict[str, Any]:
    """The keys that decide the trajectories and their values, files by their contents too."""
    kept = {
        key: value
        for key, value in flat_scene(scene).items()
        if key not in FREE and (key == CELLS or not key.startswith("output."))
    }
    return {**kept, "version of warpdem": __version__}


def fingerprint(keys: dict[str, Any]) -> str:
    """One short text for all of the decisive keys."""
    return hashlib.sha256(json.dumps(keys, sort_keys=True).encode()).hexdigest()
