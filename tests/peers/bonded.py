"""Rockable's bonded reference runs as scenes, from case.json or an excerpt of one."""

import json
from pathlib import Path

import numpy as np

from warpdem.input.scene import Scene

FOLDER = Path(__file__).resolve().parents[3] / "shared" / "reference" / "rockable"
DATA = Path(__file__).parent / "data" / "bonds"
COLUMNS = ("t", "body", "x", "y", "z")


def scene(case, **run):
    """The scene of a case; ``run`` overrides its clock and numerics."""
    clock = {"duration": case["tmax"], "dt": case["dt"], **run}
    return Scene.model_validate(
        {
            "run": clock,
            "gravity": {"vector": case["gravity"]},
            "shape": [_shape(shape) for shape in case["shapes"]],
            "body": [_body(case, k) for k in range(len(case["bodies"]))],
            "contact": [{"groups": ["rock", "rock"], **_parameters(case, "Contact")}],
            "bond": [_bond(case, command) for command in case["prepro"]],
            "output": {"energy": False},
        }
    )


def as_rockable(case):
    """The scene that does what Rockable does, at its dt."""
    return scene(case, compat="rockable", list_distance=case["dVerlet"])


def _shape(shape):
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


def _body(case, number):
    body = case["bodies"][number]
    return {
        "shape": body["shape"],
        "group": "rock",
        "cluster": body["cluster"],
        "density": case["density"]["0"],
        "position": body["pos"],
        "orientation": body["q"],
        "fixed": number < case["nDriven"],
    }


def _parameters(case, of):
    keys = ("kn", "kt", "en2", "mu", "kr", "mur")
    return {key: float(case["params"][f"{key}{of}"][0][2]) for key in keys}


def _bond(case, command):
    word, tolerance = command.split()
    inner = word != "stickClusters"
    kind = "InnerBond" if inner else "OuterBond"
    given = {key: float(rows[0][2]) for key, rows in case["params"].items()}
    bond = {
        "between": "inner" if inner else "outer",
        "rule": "vertices" if inner else "clusters",
        "tolerance": float(tolerance),
        "walls": True,
        # the bonds of that program's clusters keep the dashpots of the contacts they replace
        "en2": given["en2InnerBond" if inner else "en2Contact"],
    }
    bond |= {key: given[key + kind] for key in ("kn", "kt", "kr", "fn0", "ft0")}
    if bond["kr"]:
        bond["m0"] = given["mom0" + kind]
    bond["power"] = given["pow" + kind]
    return bond


def read_excerpt(name):
    """A case with some rows of its trajectories: ``rows`` at dt, ``finest`` at the refined dt."""
    return json.loads((DATA / f"{name}.json").read_text())


def distance(simulation, rows):
    """Largest distance of the bodies from rows of `COLUMNS` [m]."""
    rows = np.array(rows)
    farthest = 0.0
    for instant in np.unique(rows[:, 0]):
        simulation.advance(float(instant))
        there = rows[rows[:, 0] == instant]
        away = simulation.snapshot().position[there[:, 1].astype(int)] - there[:, 2:]
        farthest = max(farthest, float(np.linalg.norm(away, axis=1).max()))
    return farthest


def write_excerpt(name, count=10):
    """Write a case's definition and some rows of its trajectories into `DATA`."""
    case = json.loads((FOLDER / name / "case.json").read_text())
    keys = ("shapes", "bodies", "params", "tmax", "dt", "nDriven", "gravity", "density")
    content = {key: case[key] for key in (*keys, "dVerlet", "prepro", "self_diff_vs_refined_dt")}
    for shape in content["shapes"]:
        shape.pop("obb_half", None)
    content["source"] = "Rockable (commit 2dc6dd5), double precision, run on input of this project"
    for key, path in (
        ("rows", FOLDER / name / "traj_dt.csv"),
        ("finest", next((FOLDER / name).glob("traj_dt_over_*.csv"))),
    ):
        table = np.genfromtxt(path, delimiter=",", names=True)
        rows = np.stack([table[column] for column in COLUMNS], axis=1)
        instants = np.unique(rows[:, 0])
        chosen = instants[np.linspace(0, len(instants) - 1, count + 1).astype(int)[1:]]
        content[key] = rows[np.isin(rows[:, 0], chosen)].tolist()
    DATA.mkdir(exist_ok=True)
    lines = ",\n".join(f" {json.dumps(key)}: {json.dumps(v)}" for key, v in content.items())
    (DATA / f"{name}.json").write_text("{\n" + lines + "\n}\n")
