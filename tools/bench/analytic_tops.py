"""Reference families of turning bodies; gates of the angle from the table of design/numerics.md."""

from __future__ import annotations

import csv
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from analytic_row import Row, compared, order_row
from impacts import order_of
from tops import angle_between, euler_zxz, free_rotor, heavy_top, principal_momentum

from warpdem.geometry.orientation import turned

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

Case = dict[str, Any]
TABLE = {"generic": {0.05: 9.75e-3, 0.01: 3.95e-4, 0.001: 3.95e-6}}
"""Largest error of the orientation of the first rotor after 100 s [rad], by dt."""
TOP_TABLE = {0.005: 1.85e-4}
"""The same of the first heavy top after 10 s."""
FINER = np.array([1.0, 2.0, 4.0, 8.0])


def free_rotors(cases: list[Case], folder: Path) -> Iterator[Row]:
    """Bodies free of torque over the whole series of orientations."""
    with (folder / "free_rotor_series.csv").open() as file:
        rows = list(csv.reader(file))[1:]
    for case in cases:
        name = case["params"]["name"]
        series = np.array([row[1:] for row in rows if row[0] == name], float)
        run = partial(_rotor, case, series)
        for dt, most in TABLE.get(name, {}).items():
            angle = run(dt)["angle"]
            yield Row(case["id"], f"angle at dt {dt:g}", angle, 0.0, angle, most, "table")
        order = order_of(lambda n, run=run: run(0.05 / n)["angle"], FINER)
        yield order_row(case["id"], order)
        got = run(0.001)
        yield Row(case["id"], "L_world, drift", got["L"], 0.0, got["L"], 1e-12)
        yield Row(case["id"], "E, excursion", got["E"], 0.0, got["E"], 8e-6, "table")
        yield Row(case["id"], "omega_body", got["w"], 0.0, got["w"], 1e-4)


def _rotor(case: Case, series: np.ndarray, dt: float) -> dict[str, float]:
    """Angle at the end, largest relative errors of momentum, energy and spin.

    ``dt`` is that of a body which turns at sqrt(3) rad/s; a faster one takes shorter steps.
    """
    p, momentum = case["params"], np.array(case["expected"]["L_world"])
    moments, speed = np.array(p["I"]), np.linalg.norm(p["omega0_body"])
    interval = series[1, 0]
    step = interval / round(interval * speed / (dt * np.sqrt(3.0)))
    shots = free_rotor(moments, p["omega0_body"], series[:, 0], dt=step)
    q = np.array([shot.orientation[0] for shot in shots])
    spun = principal_momentum(shots, moments)
    energy = 0.5 * np.sum(spun**2 / moments, axis=1)
    return {
        "angle": float(angle_between(q[-1], series[-1, 1:5])),
        "L": np.abs(turned(q, spun) - momentum).max() / np.linalg.norm(momentum),
        "E": np.abs(energy / energy[0] - 1.0).max(),
        "w": np.abs(spun / moments - series[:, 5:]).max() / speed,
    }


def heavy_tops(cases: list[Case], _: object) -> Iterator[Row]:
    """No joint in the product: kick-drift-kick of its rotation about the pinned point."""
    for case in cases:
        run = partial(_top, case)
        if case["params"]["omega3"] < 10.0:
            for dt, most in TOP_TABLE.items():
                angle = run(dt)["angle"]
                yield Row(case["id"], f"angle at dt {dt:g}", angle, 0.0, angle, most, "table")
        yield order_row(case["id"], order_of(lambda n, run=run: run(0.01 / n)["angle"], FINER))
        got = run(0.0005)
        for angle in ("theta", "phi"):
            off = np.angle(np.exp(1j * (got[angle] - case["expected"][f"{angle}_samples"])))
            yield compared(case["id"], f"{angle}_samples, error", off, 0.0, gate=1e-4)
        yield Row(case["id"], "L_z, drift", got["Lz"], 0.0, got["Lz"], 1e-12)


def _top(case: Case, dt: float) -> dict[str, Any]:
    """Error of the orientation at the end, Euler angles, drift of the vertical momentum."""
    p, x = case["params"], case["expected"]
    orientation, momentum = heavy_top(
        moments=[p["I1"], p["I1"], p["I3"]],
        weight=p["mgl"],
        tilt=p["theta0"],
        spin=p["omega3"],
        times=np.linspace(0.0, p["T"], 21),
        dt=dt,
    )
    axis = turned(orientation, np.array([0.0, 0.0, 1.0]))
    end = euler_zxz(x["phi_T"], x["theta_T"], x["psi_T"])
    return {
        "angle": float(angle_between(orientation[-1], end)),
        "theta": np.arccos(axis[:, 2]),
        "phi": np.arctan2(axis[:, 0], -axis[:, 1]),
        "Lz": np.ptp(momentum[:, 2]) / abs(momentum[0, 2]),
    }


FAMILIES = {"free_rotor": free_rotors, "heavy_top": heavy_tops}
