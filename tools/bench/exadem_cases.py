"""Runs of exaDEM's kernels: their decks, their rows, and the scenes made of them."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.geometry.shp import read_shp
from warpdem.input.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray

FOLDER = Path(__file__).resolve().parents[2].parent / "shared" / "reference" / "exadem"
COLUMNS = ("step", "id", "x", "y", "z", "qw", "qx", "qy", "qz", "kinetic", "ncontacts")
LAW = {
    "damping": "contact",
    "restitution": "bilateral",
    "friction_cap": "elastic",
    "friction_frame": "fixed",
}
"""What is exaDEM's law rather than its numerics."""
COUNTS = {"density": 1, "dt": 1, "steps": 1, "every": 1, "drag": 1, "rcut_inc": 1, "g": 3}
"""Keywords of a deck that are followed by numbers, and by how many."""
IGNORED = ("all", "always", "rcut_inc", "shape", "every")
"""How neighbours are listed and where rows are kept: no physics."""


@dataclass
class Deck:
    """A deck, read.

    Attributes:
        path: The file.
        numbers: Single keywords with their numbers.
        laws: Parameters kn kt kr mu damp fc dncut by keyword, cp or cpd.
        surfaces: Offset and normal of each plane.
        particles: Rows of type, homothety and state.
        cohesive: Whether fc and dncut act.
    """

    path: Path
    numbers: dict[str, list[float]] = field(default_factory=dict)
    laws: dict[str, list[float]] = field(default_factory=dict)
    surfaces: list[list[float]] = field(default_factory=list)
    particles: list[list[float]] = field(default_factory=list)
    cohesive: bool = False

    @property
    def name(self) -> str:
        """Of its file."""
        return self.path.stem

    @property
    def dt(self) -> float:
        """Time step [s]."""
        return self.numbers["dt"][0]

    @property
    def duration(self) -> float:
        """Simulated time [s]."""
        return self.numbers["steps"][0] * self.dt

    def rows(self) -> FloatArray:
        """Rows of `COLUMNS` of its run, shape [row_count, 11]."""
        table = np.genfromtxt(self.path.with_suffix(".csv"), delimiter=",", names=True)
        return np.stack([table[name] for name in COLUMNS], axis=1)


def read_deck(path: Path) -> Deck:
    """The content of a deck.

    Raises:
        ValueError: A keyword is unknown.
    """
    deck = Deck(path)
    for line in path.read_text().splitlines():
        key, *words = line.split() or [""]
        match key:
            case "cp" | "cpd":
                deck.laws[key] = [float(word) for word in words]
            case "surface":
                deck.surfaces.append([float(word) for word in words])
            case "particle":
                deck.particles.append([float(word) for word in words])
            case "cohesive":
                deck.cohesive = True
            case _ if key in COUNTS:
                deck.numbers[key] = [float(word) for word in words]
            case _ if key and key not in IGNORED:
                raise ValueError(f"{path}: unknown keyword {key!r}")
    return deck


def equal(deck: Deck, parts: int = 1) -> Scene:
    """The scene that does what exaDEM's kernels do, at dt / parts."""
    return _scene(deck, {"dt": deck.dt / parts, "compat": "exadem"})


def accurate(deck: Deck, parts: int = 1) -> Scene:
    """The scene of the default numerics with exaDEM's law, at dt / parts."""
    return _scene(deck, {"dt": deck.dt / parts, **LAW})


def _scene(deck: Deck, run: dict[str, Any]) -> Scene:
    names = list(read_shp(deck.path.with_name("shapes.shp")))
    used = sorted({int(particle[0]) for particle in deck.particles})
    shapes = [{"kind": "shp", "name": names[k], "file": "shapes.shp"} for k in used]
    planes = [{"kind": "plane", "name": "plane"}] if deck.surfaces else []
    drag = deck.numbers.get("drag")
    forces = [{"kind": "drag", "coefficient": drag[0]}] if drag else []
    scene = Scene.model_validate(
        {
            "run": {"duration": deck.duration, **run},
            "gravity": {"vector": deck.numbers["g"]},
            "shape": shapes + planes,
            "group": [{"name": "grain", "density": deck.numbers["density"][0]}],
            "contact": _contacts(deck),
            **({"force": forces} if forces else {}),
            "body": [_particle(row, names) for row in deck.particles]
            + [_plane(row) for row in deck.surfaces],
            "output": {"energy": False},
        }
    )
    return scene.located(deck.path.with_suffix(".toml"))


def _particle(row: Sequence[float], names: list[str]) -> dict[str, Any]:
    turn = np.array(row[8:12])
    return {
        "shape": names[int(row[0])],
        "group": "grain",
        "scale": row[1],
        "position": list(row[2:5]),
        "velocity": list(row[5:8]),
        "orientation": turn / np.linalg.norm(turn),
        "spin": list(row[12:15]),
    }


def _plane(row: Sequence[float]) -> dict[str, Any]:
    offset, normal = row[0], np.array(row[1:4])
    x, y, z = normal / np.linalg.norm(normal)
    turn = np.array([1.0 + z, -y, x, 0.0]) if z > -1.0 else np.array([0.0, 1.0, 0.0, 0.0])
    return {
        "shape": "plane",
        "group": "wall",
        "fixed": True,
        "position": offset * normal,
        "orientation": turn / np.linalg.norm(turn),
    }


def _contacts(deck: Deck) -> list[dict[str, Any]]:
    pairs = {"cp": ["grain", "grain"], "cpd": ["grain", "wall"]}
    made = []
    for key, groups in pairs.items():
        kn, kt, _, mu, damping, fc, dncut = deck.laws[key]  # kr is dead code there
        if key == "cpd" and not deck.surfaces:
            continue
        law = {"groups": groups, "kn": kn, "kt": kt, "mu": mu, "damping_ratio": damping}
        made.append(law | ({"fc": fc, "dncut": dncut} if deck.cohesive else {}))
    return made


def chosen_decks(folder: Path, names: list[str]) -> list[Deck]:
    """The named decks of a folder, or all; a name may be its beginning."""
    known = {path.stem: path for path in sorted(folder.glob("*.deck"))}
    if not known:
        sys.exit(f"{folder}: holds no decks; set --folder")
    if missing := [name for name in names if not any(k.startswith(name) for k in known)]:
        sys.exit(f"{folder}: no deck {', '.join(missing)}; there are: {', '.join(known)}")
    chosen = [path for k, path in known.items() if not names or k.startswith(tuple(names))]
    return [read_deck(path) for path in chosen]
