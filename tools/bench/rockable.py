"""Rockable's reference runs, repeated: how far the bodies end up from where that program has them.

    python tools/bench/rockable.py [CASE ...] [--folder DIR] [--excerpt DIR]

First at equal dt with compat = "rockable": every position over the whole run within 1e-9 m. A
packing is chaotic: its means must agree as those of the two reference runs do. Then the default
numerics at dt/8, with Rockable's law (its dashpot, its cap, its unrotated friction), against the
finest reference run, within twice the distance of that program's own two runs. Exit status 1 if a
case fails.

--excerpt writes definition and some rows of the cases into a folder; tests/peers/data was made so.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.geometry.orientation import product
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray
    from warpdem.snapshot import Snapshot

FOLDER = Path(__file__).resolve().parents[2].parent / "shared" / "reference" / "rockable"
GATE = 1e-9
"""Largest distance at equal dt [m]."""
REFINED = 8
"""How much smaller the step of the default numerics is."""
SPREAD = 5.5
"""Half width of a packing's band, in root mean square differences of the two reference runs.

Nine of ten further runs lie within (Student's distribution, one degree of freedom).
"""
RESTING = 0.5
"""Part of a packing's run that its means leave out at the start."""
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
        folder: Where its trajectories lie; None for an excerpt.
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


def needs(case: Case) -> str:
    """What the case asks for that this version has not; empty when it can be run."""
    has = case.definition
    extra = has.get("extra") or {}
    if has["law"] != "Default":
        return f"law {has['law']}"
    if "numericalDampingCoeff" in extra:
        return "numerical damping"
    if "ContactPartnership" in extra:
        return f"partnership weights ({extra['ContactPartnership']})"
    if has.get("integrator") not in {None, "velocityVerlet"}:
        return f"integrator {has['integrator']}"
    return ""


def scene_of(case: Case, **run: Any) -> Scene:
    """The scene of a case; ``run`` overrides its clock and numerics."""
    has = case.definition
    driven = has["nDriven"]
    return Scene.model_validate(
        {
            "run": {"duration": has["tmax"], "dt": has["dt"], **run},
            "gravity": {"vector": has["gravity"]},
            "shape": [_shape(shape) for shape in has["shapes"]],
            "body": [
                _body(body, has["density"], fixed=number < driven)
                for number, body in enumerate(has["bodies"])
            ],
            "contact": list(_contacts(has["params"])),
            "driver": [_driver(line) for line in has.get("driving") or ()],
            "output": {"energy": False},
        }
    )


def equal(case: Case) -> Scene:
    """The scene that does what Rockable does, at its dt."""
    return scene_of(case, compat="rockable", list_distance=case.definition["dVerlet"])


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


def _contacts(parameters: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    tables = {
        key.removesuffix("Contact"): {(a, b): value for a, b, value in rows}
        for key, rows in parameters.items()
    }
    for a, b in tables["kn"]:
        law = {key: float(tables[key][a, b]) for key in ("kn", "kt", "en2", "mu", "kr", "mur")}
        yield {"groups": [f"g{a}", f"g{b}"], **law, "en2": min(law["en2"], 1.0)}


def compare(simulation: Simulation, rows: FloatArray) -> tuple[float, float]:
    """Largest distance [m] and angle [rad] of the bodies from those of a trajectory.

    Args:
        simulation: At its start.
        rows: Of `COLUMNS`, shape [row_count, 15].
    """
    distance = angle = 0.0
    for instant in np.unique(rows[:, 0]):
        simulation.advance(float(instant))
        now = simulation.snapshot()
        there = rows[rows[:, 0] == instant]
        body = there[:, 1].astype(int)
        away = now.position[body] - there[:, 2:5]
        distance = max(distance, float(np.linalg.norm(away, axis=1).max()))
        angle = max(angle, float(angles(now.orientation[body], there[:, 5:9]).max()))
    return distance, angle


def angles(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles between orientations [rad], shape [count]."""
    apart = product(first, second * np.array([1.0, -1.0, -1.0, -1.0]))
    return 2.0 * np.arctan2(np.linalg.norm(apart[:, 1:], axis=1), np.abs(apart[:, 0]))


def repeat(case: Case) -> bool:
    """Run a case at equal dt, print how far it gets from the reference; whether it passes."""
    if case.is_packing:
        return repeat_packing(case)
    simulation = Simulation(equal(case), device="cpu", threads=1)
    begin = time.perf_counter()
    distance, angle = compare(simulation, case.trajectory())
    spent = time.perf_counter() - begin
    passes = distance <= GATE
    theirs = case.definition["wall_s"][0]
    print(
        f"{case.name:28s} {distance:9.1e} {angle:9.1e}  {verdict(passes)} "
        f"{simulation.step_count:7d} {spent:8.2f} {theirs:8.2f}",
        flush=True,
    )
    return passes


def refine(case: Case) -> bool:
    """Run a case with the default numerics at a finer dt and print its distance; as ``repeat``."""
    step = case.definition["dt"] / REFINED
    simulation = Simulation(scene_of(case, dt=step, **LAW), device="cpu", threads=1)
    begin = time.perf_counter()
    distance, angle = compare(simulation, case.trajectory(case.finest))
    spent = time.perf_counter() - begin
    own = case.definition["self_diff_vs_refined_dt"][str(case.finest)]
    passes = distance <= max(2.0 * own["pos"], GATE) and angle <= max(2.0 * own["ang"], GATE)
    print(
        f"{case.name:28s} {distance:9.1e} {own['pos']:9.1e} {angle:9.1e} {own['ang']:9.1e}  "
        f"{verdict(passes)} {spent:8.2f}",
        flush=True,
    )
    return passes


def repeat_packing(case: Case) -> bool:
    """Run a packing at equal dt and print its means beside those of the reference."""
    assert case.folder
    names = ("t", "z_mean", "ke_trans", "ke_rot", "n_contacts")
    first, second = (
        read_columns(path, names)
        for path in (case.folder / "global_dt.csv", *case.folder.glob("global_dt_over_*.csv"))
    )
    simulation = Simulation(equal(case), device="cpu", threads=1)
    begin = time.perf_counter()
    ours = np.array([bulk(simulation, instant) for instant in first[:, 0]])
    spent = time.perf_counter() - begin
    rows = [measures(table) for table in (ours, bulk_of(first), bulk_of(second))]
    passes = True
    for (what, mine), (_, one), (_, other) in zip(*(row.items() for row in rows), strict=True):
        band = SPREAD * float(np.sqrt(np.mean((one - other) ** 2)))
        middle = 0.5 * float(np.mean(one) + np.mean(other))
        inside = abs(float(np.mean(mine)) - middle) <= band
        passes = passes and inside
        print(
            f"{case.name:28s} {what}: {np.mean(mine):.6g}, reference {np.mean(one):.6g} and "
            f"{np.mean(other):.6g} at dt/2, band {middle:.6g} +- {band:.2g}  {verdict(inside)}"
        )
    theirs = case.definition["wall_s"][0]
    print(
        f"{case.name:28s} {'means':>9s} {'':9s}  {verdict(passes)} {simulation.step_count:7d} "
        f"{spent:8.2f} {theirs:8.2f}",
        flush=True,
    )
    return passes


def bulk(simulation: Simulation, instant: float) -> tuple[float, float, float, float]:
    """Time [s], mean height [m], kinetic energy [J] and number of sub-contacts of a packing."""
    simulation.advance(float(instant))
    now = simulation.snapshot(contacts=True)
    free = ~simulation.placement.fixed
    touching = now.contacts
    assert touching is not None
    return (
        instant,
        float(now.position[free, 2].mean()),
        kinetic(simulation, now),
        float(len(touching.gap)),
    )


def kinetic(simulation: Simulation, now: Snapshot) -> float:
    """Kinetic energy of the free bodies, all alike cubes [J]."""
    free = ~simulation.placement.fixed
    shape = list(simulation.polyhedra.values())[simulation.placement.shape[free][0]]
    mass = shape.volume * simulation.placement.density[free]
    moment = mass * shape.inertia_over_mass[0]
    speeds = (now.velocity[free] ** 2).sum(axis=1), (now.spin[free] ** 2).sum(axis=1)
    return float(0.5 * (mass * speeds[0] + moment * speeds[1]).sum())


def bulk_of(table: FloatArray) -> FloatArray:
    """The columns of `bulk` from a reference's global series."""
    return np.stack([table[:, 0], table[:, 1], table[:, 2] + table[:, 3], table[:, 4]], axis=1)


def measures(table: FloatArray) -> dict[str, FloatArray]:
    """What a packing is judged by, as series whose means count."""
    late = table[:, 0] > RESTING * table[-1, 0]
    fall = (table[:, 0] > 0.2 * table[-1, 0]) & ~late
    return {
        "resting height [m]": table[late, 1],
        "log10 of the kinetic energy while settling [J]": np.log10(table[fall, 2]),
        "sub-contacts at rest": table[late, 3],
    }


def verdict(passes: bool) -> str:  # noqa: FBT001 - a word for a flag
    """PASS or FAIL."""
    return "PASS" if passes else "FAIL"


def excerpt(case: Case, folder: Path) -> None:
    """Write a case's definition and some rows of its trajectory as one small file."""
    keys = ("law", "shapes", "bodies", "params", "tmax", "dt", "nDriven", "gravity", "density")
    keys += ("driving",) * ("driving" in case.definition)
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


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="*", help="names of cases; default: all")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="of the cases")
    parser.add_argument("--excerpt", type=Path, help="folder for excerpts; nothing is run")
    asked = parser.parse_args()
    cases = chosen_cases(asked.folder, asked.case)
    if asked.excerpt:
        for case in cases:
            excerpt(case, asked.excerpt)
        return 0
    able = [case for case in cases if not needs(case)]
    print(f"at equal dt; gate {GATE:g} m; seconds of one thread here and of the reference's run")
    print(f"{'case':28s} {'|dx| [m]':>9s} {'[rad]':>9s} {'steps':>13s} {'here':>8s} {'there':>8s}")
    passes = [repeat(case) for case in able]
    print(f"\ndefault numerics at dt/{REFINED}; gate: twice the reference's own difference")
    print(f"{'case':28s} {'|dx| [m]':>9s} {'own':>9s} {'[rad]':>9s} {'own':>9s} {'seconds':>14s}")
    passes += [refine(case) for case in able if not case.is_packing]
    for case in cases:
        if needs(case):
            print(f"{case.name:28s} needs {needs(case)} (not in this version)")
    return 0 if all(passes) else 1


if __name__ == "__main__":
    sys.exit(main())
