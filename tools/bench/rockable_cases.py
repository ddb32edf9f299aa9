"""Rockable's reference runs: their input, their rows, and the scenes made of them."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.converting.convert import converted
from warpdem.input.scene import Scene

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray

FOLDER = Path(__file__).resolve().parents[2].parent / "shared" / "reference" / "rockable"
EXCERPT_ROWS = 10

LAW = {
    "damping": "contact",
    "restitution": "bilateral",
    "friction_cap": "elastic",
    "friction_frame": "fixed",
}
"""What is Rockable's law rather than its numerics."""
COLUMNS = ("t", "body", "x", "y", "z", "qw", "qx", "qy", "qz", "vx", "vy", "vz", "wx", "wy", "wz")


@dataclass(frozen=True)
class Case:
    """A reference run.

    Attributes:
        name: Of its folder.
        definition: Shapes, bodies, law and clock, as in case.json.
        folder: Where its input and its trajectories lie; None for an excerpt.
    """

    name: str
    definition: Mapping[str, Any]
    folder: Path | None = None

    @property
    def is_packing(self) -> bool:
        """Chaotic: compared by its means."""
        return self.folder is not None and (self.folder / "global_dt.csv").exists()

    @cached_property
    def finest(self) -> int:
        """By how much the finest reference run divides dt."""
        return max(int(path.stem.split("_")[-1]) for path in self._trajectories("traj_dt_over_*"))

    def trajectory(self, refined: int = 1) -> FloatArray:
        """Rows of `COLUMNS` of the run at dt / refined, shape [row_count, 15]."""
        stem = "traj_dt" if refined == 1 else f"traj_dt_over_{refined}"
        return read_columns(self._trajectories(stem)[0], COLUMNS)

    def _trajectories(self, stem: str) -> list[Path]:
        assert self.folder
        return sorted(self.folder.glob(f"{stem}.csv"))


def read_case(folder: Path) -> Case:
    """The case of a folder with a case.json."""
    return Case(folder.name, json.loads((folder / "case.json").read_text()), folder)


def read_columns(path: Path, names: tuple[str, ...]) -> FloatArray:
    """Columns of a table by name, shape [row_count, column_count]."""
    table = np.genfromtxt(path, delimiter=",", names=True)
    return np.stack([table[name] for name in names], axis=1)


def equal(case: Case) -> Scene:
    """The scene that does what Rockable does, at its dt: as ``convert`` makes it of its input."""
    if case.folder is None:
        return defined(case)
    return _read_back(case.folder, {})


def refined(case: Case, parts: int) -> Scene:
    """The scene of the default numerics with Rockable's law, at dt / parts."""
    assert case.folder
    return _read_back(case.folder, {"dt": case.definition["dt"] / parts, **LAW}, accurate=True)


def _read_back(folder: Path, run: Mapping[str, Any], *, accurate: bool = False) -> Scene:
    source = folder / "input.txt"
    tables = converted(source, folder, accurate=accurate).tables
    tables["run"] |= run
    tables["output"]["energy"] = False
    return Scene.model_validate(tables).located(folder / "scene.toml")


def defined(case: Case) -> Scene:
    """The scene of a Default case at equal dt, from its definition rather than its input file."""
    has = case.definition
    forces = list(_forces(has.get("extra") or {}))
    drivers = [_driver(line) for line in has.get("driving") or ()]
    driven = has["nDriven"]
    run = {"dt": has["dt"], "compat": "rockable", "list_distance": has["dVerlet"]}
    return Scene.model_validate(
        {
            "run": {"duration": has["tmax"], **run},
            "gravity": {"vector": has["gravity"]},
            "shape": [_shape(shape) for shape in has["shapes"]],
            "body": [
                _body(body, has["density"], fixed=number < driven)
                for number, body in enumerate(has["bodies"])
            ],
            "contact": list(_contacts(has["params"])),
            **({"force": forces} if forces else {}),
            **({"driver": drivers} if drivers else {}),
            "output": {"energy": False},
        }
    )


def _shape(shape: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "kind": "polyhedron",
        "name": shape["name"],
        "vertices": shape["vertices"],
        "edges": shape["edges"],
        "faces": shape["faces"],
        "rounding": shape["radius"],
        "volume": shape["volume"],
        "inertia_over_mass": shape["I_over_m"],
    }


def _body(body: Mapping[str, Any], density: Mapping[str, float], *, fixed: bool) -> dict[str, Any]:
    turn = np.array(body["q"], float)
    return {
        "shape": body["shape"],
        "group": f"g{body['group']}",
        "density": density[str(body["group"])],
        "scale": body["homothety"],
        "position": body["pos"],
        "orientation": turn / np.linalg.norm(turn),
        "velocity": body["vel"],
        "spin": body["vrot"],
        "fixed": fixed,
    }


def _contacts(parameters: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    tables = {
        key.removesuffix("Contact"): {(a, b): value for a, b, value in rows}
        for key, rows in parameters.items()
    }
    for a, b in tables["kn"]:
        law = {key: float(tables[key][a, b]) for key in ("kn", "kt", "en2", "mu", "kr", "mur")}
        yield {"groups": [f"g{a}", f"g{b}"], **law, "en2": min(law["en2"], 1.0)}


def _forces(extra: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    if coefficient := float(extra.get("numericalDampingCoeff", 0.0)):
        yield {"kind": "numerical_damping", "coefficient": coefficient}


def _driver(line: str) -> dict[str, Any]:
    """A driver of a line of Rockable's drivingSystem.txt."""
    word, kind, *numbers = line.split()
    if word == "Control":
        axis = kind.strip("_")[0]
        assert kind == f"_{axis}_For_", line
        body, force = numbers
        return {"kind": "control", "bodies": [f"body[{body}]"], "force": {axis: float(force)}}
    assert kind == "shaker", line
    body, x, y, z, amplitude, frequency = numbers
    direction = np.array([x, y, z], float)
    return {
        "kind": "sine",
        "bodies": [f"body[{body}]"],
        "translation": float(amplitude) * direction / np.linalg.norm(direction),
        "frequency": float(frequency),
    }


def excerpt(case: Case, folder: Path) -> None:
    """Write a case's definition and some rows of its trajectory as one small file."""
    keys = ("law", "shapes", "bodies", "params", "tmax", "dt", "nDriven", "gravity", "density")
    keys += tuple(key for key in ("driving", "extra") if case.definition.get(key))
    rows = case.trajectory()
    instants = np.unique(rows[:, 0])
    chosen = instants[np.linspace(0, len(instants) - 1, EXCERPT_ROWS + 1).astype(int)[1:]]
    content = {
        "name": case.name,
        "description": case.definition["description"],
        "source": "Rockable (commit 2dc6dd5), double precision, run on input of this project",
        **{key: case.definition[key] for key in (*keys, "dVerlet")},
        "columns": COLUMNS,
        "rows": rows[np.isin(rows[:, 0], chosen)].tolist(),
    }
    for shape in content["shapes"]:
        shape.pop("obb_half", None)
    lines = ",\n".join(f" {json.dumps(key)}: {json.dumps(v)}" for key, v in content.items())
    (folder / f"{case.name}.json").write_text("{\n" + lines + "\n}\n")


def read_excerpt(path: Path) -> tuple[Case, FloatArray]:
    """A case that ``excerpt`` wrote, and its rows of `COLUMNS`."""
    content = json.loads(path.read_text())
    return Case(content["name"], content), np.array(content["rows"])


def chosen_cases(folder: Path, names: list[str]) -> list[Case]:
    """The named cases of a folder, or all."""
    known = {path.parent.name: path.parent for path in sorted(folder.glob("*/case.json"))}
    if not known:
        sys.exit(f"{folder}: holds no cases; set --folder")
    if missing := [name for name in names if name not in known]:
        sys.exit(f"{folder}: no case {', '.join(missing)}; there are: {', '.join(known)}")
    return [read_case(known[name]) for name in names or known]


def verdict(passes: bool) -> str:  # noqa: FBT001 - a word for a flag
    """PASS or FAIL."""
    return "PASS" if passes else "FAIL"
