"""Nearest legal names for what was misspelt or is called otherwise elsewhere."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

SYNONYMS = {
    "angular_velocity": "spin",
    "angvel": "spin",
    "attraction": "fc",
    "center": "position",
    "centre": "position",
    "checkpoint": "checkpoint_every",
    "cohesion": "fc",
    "dimensions": "size",
    "driven": "fixed",
    "end": "duration",
    "end_time": "duration",
    "factor": "scale",
    "filename": "file",
    "friction": "mu",
    "g": "vector",
    "homothety": "scale",
    "id": "name",
    "inertia": "inertia_over_mass",
    "interval": "every",
    "length": "size",
    "lengths": "size",
    "mass": "density",
    "material": "group",
    "minkowski_radius": "rounding",
    "n": "count",
    "normal_stiffness": "kn",
    "number": "count",
    "omega": "spin",
    "path": "file",
    "points": "vertices",
    "pos": "position",
    "q": "orientation",
    "quaternion": "orientation",
    "r": "radius",
    "radius": "rounding",
    "restitution": "en2",
    "rho": "density",
    "rolling_friction": "mur",
    "rolling_stiffness": "kr",
    "rotation": "orientation",
    "static": "fixed",
    "std": "sd",
    "stiffness": "kn",
    "t_end": "duration",
    "tangential_stiffness": "kt",
    "time": "duration",
    "time_step": "dt",
    "timestep": "dt",
    "type": "kind",
    "vel": "velocity",
    "w": "spin",
}
"""What other programs and people call a key of the scene."""


def nearest(word: str, legal: Iterable[str]) -> str | None:
    """The legal name most likely meant by ``word``, if any comes near."""
    names = {name: name for name in legal}
    others = {other: name for other, name in SYNONYMS.items() if name in names}
    known = others | names
    folded = word.strip().lower().replace("-", "_").replace(" ", "_")
    # Beyond 60 letters nothing legal is near, and difflib takes quadratic time.
    close = get_close_matches(folded[:60], known, n=1, cutoff=0.7)
    return known[close[0]] if close else None


def did_you_mean(word: str, legal: Iterable[str]) -> str:
    """The end of a message: ``; did you mean "x"?``, or nothing."""
    name = nearest(word, legal)
    return f'; did you mean "{name}"?' if name and name != word else ""
