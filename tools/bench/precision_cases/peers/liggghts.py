"""LIGGGHTS 3.8: balls over a plane; blocks are balls that are not turned (plain ``fix nve``)."""

from __future__ import annotations

import re
import subprocess
import tempfile
from math import pi, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

LOOP = re.compile(r"Loop time of (\S+) on")
MODEL = "model hooke/stiffness tangential history"
SWITCHES = "limitForce on tangential_damping off"
STATE = "id x y z vx vy vz omegax omegay omegaz"


def rows(problem: dict[str, Any], steps: Sequence[int]) -> list[dict[str, Any]]:
    """One process a number of steps; seconds are its own "Loop time"."""
    found = []
    for count in steps:
        with tempfile.TemporaryDirectory() as folder:
            spent, state = _run(Path(folder), problem, count)
        place, velocity, spin = state[:, 1:4], state[:, 4:7], state[:, 7:10]
        row = {"steps": count, "seconds": spent, "position": place}
        found.append(row | {"velocity": velocity, "spin": spin})
    return found


def _run(folder: Path, problem: dict[str, Any], steps: int) -> tuple[float, NDArray[np.float64]]:
    (folder / "start.data").write_text(_data(problem), encoding="utf-8")
    (folder / "in.txt").write_text(_input(problem, steps), encoding="utf-8")
    command = ["liggghts", "-in", "in.txt", "-log", "none"]
    ran = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=True, timeout=120.0
    )
    state = np.loadtxt(folder / "end.txt", skiprows=9, ndmin=2)
    return float(LOOP.findall(ran.stdout)[0]), state[np.argsort(state[:, 0])]


def radius_and_mass(problem: dict[str, Any]) -> tuple[float, float]:
    """A ball in place of a block is as high."""
    if "block" in problem:
        return 0.5 * problem["block"][2], problem["mass"]
    return problem["radius"], 1.0


def places(problem: dict[str, Any]) -> NDArray[np.float64]:
    """Centres of balls; those of blocks lie at their static overlap."""
    place = np.array(problem["position"], float)
    if "block" in problem:
        radius, mass = radius_and_mass(problem)
        place[:, 2] = radius + mass * problem["gravity"][2] / problem["kn"]
    return place


def gravity(problem: dict[str, Any]) -> list[float]:
    """As a vector."""
    return problem.get("gravity") or [0.0, 0.0, -problem["g"]]


def _data(problem: dict[str, Any]) -> str:
    place = places(problem)
    radius, mass = radius_and_mass(problem)
    density = mass / (4.0 / 3.0 * pi * radius**3)
    low, high = place.min(axis=0) - 1.0, place.max(axis=0) + 3.0
    sides = zip(low.tolist(), high.tolist(), "xyz", strict=True)
    bounds = "\n".join(f"{a!r} {b!r} {axis}lo {axis}hi" for a, b, axis in sides)
    kind = f"1 {2.0 * radius!r} {density!r}"
    atoms = "\n".join(f"{i} {kind} {x!r} {y!r} {z!r}" for i, (x, y, z) in _rows(place))
    spins = np.array(problem.get("spin", 0.0 * place))
    motion = np.hstack([np.array(problem["velocity"]), spins])
    speeds = "\n".join(f"{i} {' '.join(map(repr, row))}" for i, row in _rows(motion))
    count = f"{len(place)} atoms\n2 atom types"
    return f"start\n\n{count}\n{bounds}\n\nAtoms\n\n{atoms}\n\nVelocities\n\n{speeds}\n"


def _rows(values: NDArray[np.float64]) -> Any:
    return enumerate(values.tolist(), 1)


def _input(problem: dict[str, Any], steps: int) -> str:
    _, mass = radius_and_mass(problem)
    dashpot = 2.0 * problem["zeta"] * sqrt(problem["kn"] / mass)
    pull = np.array(gravity(problem))
    size = float(np.linalg.norm(pull))
    way = " ".join(map(repr, (pull / size if size else np.array([0.0, 0.0, -1.0])).tolist()))
    values = {
        "kn": problem["kn"],
        "kt": problem["kt"],
        "gamman": dashpot,
        "gammat": 0.0,
        "coefficientFriction": problem["mu"],
    }
    laws = [
        f"fix {name} all property/global {name} peratomtypepair 2 {' '.join([repr(value)] * 4)}"
        for name, value in values.items()
    ]
    move = "nve" if "block" in problem else "nve/sphere"
    shown = '"%d' + " %.16g" * 9 + '"'
    return "\n".join(
        [
            "atom_style granular\natom_modify map array\nboundary f f f\nnewton off",
            "communicate single vel yes\nunits si\nread_data start.data",
            f"neighbor {0.2 * radius_and_mass(problem)[0]!r} bin",
            "neigh_modify delay 0 every 1 check yes",
            *laws,
            f"pair_style gran {MODEL} {SWITCHES}\npair_coeff * *",
            f"timestep {problem['until'] / steps!r}",
            f"fix weight all gravity {size!r} vector {way}",
            f"fix wall all wall/gran {MODEL} primitive type 2 zplane 0.0 {SWITCHES}",
            f"fix move all {move}\nthermo 1000000000\nthermo_modify lost error norm no",
            f"run {steps}\ndump end all custom 1 end.txt {STATE}",
            f"dump_modify end format {shown}\nrun 0\n",
        ]
    )
