"""Bodies that turn: free of torque, and tops on their tips."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from tops import euler_zxz, heavy_top
from warpdem.kernels.rotation import (
    free_drift,
    free_torque,
    rkmk4_drift,
    taylor_drift,
    taylor_torque,
)

from precision_cases.case import Case, lattice, random, scene_of, turns
from warpdem.geometry.orientation import product, turned

if TYPE_CHECKING:
    from collections.abc import Mapping

    from precision_cases.case import FloatArray, Scene

COPIES = 50
CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


def apart(q: FloatArray, truth: FloatArray) -> FloatArray:
    """Small rotation vectors from one orientation to another [rad]; shape [copies, 3]."""
    turn = product(q, truth * CONJUGATE)
    size = np.linalg.norm(turn[:, 1:], axis=1, keepdims=True)
    angle = 2.0 * np.arctan2(size, np.abs(turn[:, :1]))
    return (
        np.sign(turn[:, :1]) * turn[:, 1:] * np.where(size > 0, angle / np.maximum(size, 1e-300), 2)
    )


# --- free of torque ----------------------------------------------------------------------------
MOMENTS, SPIN, TURNED = [1.0, 2.0, 3.0], np.array([1.0, 1.0, 1.0]), 100.0
AFTER_100_S = np.array(
    [0.7543620159814326, -0.6111927854801947, 0.1860544358049818, 0.15088099528661478]
)
"""Where that body is after 100 s: Jacobi's elliptic functions, 18 digits."""
FACED = turns(COPIES, random(11))
ROTOR = {
    "name": "rotor",
    "kind": "polyhedron",
    "vertices": [[0.0, 0.0, 0.0]],
    "rounding": 0.05,
    "volume": 1.0,
    "inertia_over_mass": MOMENTS,
}


def rotor_scene() -> Scene:
    spins = turned(FACED, np.tile(SPIN, (COPIES, 1)))
    rows = zip(lattice(COPIES, 1.0), FACED, spins, strict=True)
    bodies = [
        {"shape": "rotor", "density": 1.0, "position": [x, y, 0.0], "orientation": q, "spin": w}
        for (x, y), q, w in rows
    ]
    law = {"kn": 1.0, "kt": 0.0, "en2": 1.0, "mu": 0.0}
    return scene_of(bodies, [ROTOR], law, output={"energy": False, "orientation": True})


def rotor_angle(shot: Any) -> FloatArray:
    return apart(shot.orientation, product(FACED, np.tile(AFTER_100_S, (COPIES, 1))))


# --- tops --------------------------------------------------------------------------------------
TOP = {"moments": [1.0, 1.0, 0.5], "weight": 9.81, "tilt": 0.5, "spin": 8.0}
SPUN = 10.0
TOP_AFTER = euler_zxz(20.300191326165226, 1.4850980461230379, 76.64636765074466)
"""Where that top is after 10 s: Jacobi's elliptic functions, 18 digits."""
HOW = {
    "no_squish": (free_drift, free_torque),
    "rkmk4": (rkmk4_drift, free_torque),
    "taylor": (taylor_drift, taylor_torque),
}


class Tops:
    """Many of them; there are no joints in scenes: the drifts alone, kicked by weight."""

    def __init__(self, run: Mapping[str, Any], steps: int) -> None:
        self._run = {**TOP, "times": [SPUN], "dt": SPUN / steps, "copies": COPIES}
        self._run["how"] = HOW["taylor" if "compat" in run else run.get("rotation", "no_squish")]
        self.values = apart(heavy_top(**self._run)[0], TOP_AFTER[None])

    def again(self) -> float:
        """Seconds of another run."""
        begin = time.process_time()
        heavy_top(**self._run)
        return time.process_time() - begin


def nothing(copies: int) -> Any:
    """The truth of measured angles."""
    return lambda _: np.zeros((copies, 3))


CASES = (
    Case(
        "torque_free_top",
        "moments 1 2 3, spin 1 1 1, 100 s; angle [rad], against elliptic functions",
        TURNED,
        tuple(500 * 2**k for k in range(6)),
        ("default", "rkmk4", "taylor", "mixed", "rockable"),
        rotor_scene,
        rotor_angle,
        exact=nothing(COPIES),
    ),
    Case(
        "heavy_top",
        "a top on its tip for 10 s; angle [rad], against elliptic functions",
        SPUN,
        tuple(250 * 2**k for k in range(6)),
        ("default", "rkmk4", "taylor"),
        exact=nothing(1),
        prepared=Tops,
    ),
)
