"""Delivered restitution of a cube, asked against got, for many ways to hit a plane or a free cube.

    python tools/bench/restitution.py [--steps N | --auto]

Newton's ratio at the middle of the touching corner, edge or face at the first separation, without
friction and gravity, N steps in a contact with eight sub-contacts, or as dt = "auto" has it. Poses
are those of shared/prototypes/numerics/share.py. Exit status 1 if one differs by more than 0.005.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from math import acos, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from rockable import verdict

from warpdem.geometry.orientation import product, turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.snapshot import Snapshot

ASKED = (0.2, 0.5, 0.8)
GATE = 0.005
STEPS = 40
STIFFNESS = 1e7
ROUNDING = 0.05
GAP = 1e-4
LONGEST = 10_000
"""Steps after which a collision must be over."""
CONJUGATE = np.array([1.0, -1.0, -1.0, -1.0])


def about(axis: tuple[float, float, float], angle: float) -> FloatArray:
    """Quaternion of a turn by ``angle`` [rad] about ``axis``."""
    unit = np.array(axis) / np.linalg.norm(axis)
    return np.concatenate([[cos(0.5 * angle)], sin(0.5 * angle) * unit])


@dataclass(frozen=True)
class Pose:
    """How a cube of edge 1 m comes down.

    Attributes:
        turn: Its orientation.
        free: It hits the top of another free cube, else a plane.
        offset: Of the touching feature from the middle of that top [m].
    """

    turn: FloatArray
    free: bool = False
    offset: tuple[float, float] = (0.0, 0.0)


FACE = about((0, 0, 1), 0.0)
EDGE = about((1, 0, 0), pi / 4)
CORNER = about((1, -1, 0), acos(1 / sqrt(3)))
OBLIQUE = about((0.6, 0.3, 0.1), 0.25)

POSES = {
    "plane, face": Pose(FACE),
    "plane, edge": Pose(EDGE),
    "plane, corner": Pose(CORNER),
    "plane, oblique corner": Pose(OBLIQUE),
    "cube, face aligned (8)": Pose(FACE, free=True),
    "cube, face yaw 1e-6 (12)": Pose(about((0, 0, 1), 1e-6), free=True),
    "cube, face offset .1 .1 (4)": Pose(FACE, free=True, offset=(0.1, 0.1)),
    "cube, face yaw .3 (8)": Pose(about((0, 0, 1), 0.3), free=True),
    "cube, edge on face": Pose(EDGE, free=True, offset=(0.1, 0.1)),
    "cube, corner on face": Pose(CORNER, free=True, offset=(0.1, 0.07)),
    "cube, oblique corner": Pose(OBLIQUE, free=True, offset=(0.1, 0.07)),
}
"""In brackets how many sub-contacts share the impact."""


def feature(turn: FloatArray) -> FloatArray:
    """Middle of the lowest corner, edge or face of the core, about the centre [m]."""
    half = 0.5 - ROUNDING
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    corners = turned(turn, half * signs)
    return corners[corners[:, 2] < corners[:, 2].min() + 0.02].mean(axis=0)


def scene_of(pose: Pose, asked: float, steps: int | None) -> Scene:
    """A cube that meets a plane, or another free cube, at 1 m/s."""
    dt = pi / sqrt(8.0 * STIFFNESS) / steps if steps else "auto"
    low = feature(pose.turn)
    height = GAP + ROUNDING - low[2]
    cube = {"kind": "box", "name": "cube", "size": [1.0] * 3, "rounding": ROUNDING}
    upper: dict[str, Any] = {"shape": "cube", "orientation": pose.turn, "density": 1.0}
    if pose.free:
        place = [pose.offset[0] - low[0], pose.offset[1] - low[1], 0.5 + height]
        upper |= {"position": place, "velocity": [0.0, 0.0, -0.5]}
        lower = {"shape": "cube", "velocity": [0.0, 0.0, 0.5], "density": 1.0}
        lower["position"] = [0.0, 0.0, 0.0]
        shapes = [cube]
    else:
        upper |= {"position": [0.0, 0.0, height], "velocity": [0.0, 0.0, -1.0]}
        lower = {"shape": "plane", "position": [0.0, 0.0, -2.0], "fixed": True}
        plane = {"kind": "box", "name": "plane", "size": [40.0, 40.0, 4.0], "rounding": ROUNDING}
        shapes = [cube, plane]
    law = {"groups": ["default"] * 2, "kn": STIFFNESS, "kt": 0.0, "en2": asked**2, "mu": 0.0}
    return Scene.model_validate(
        {
            "run": {"duration": 1.0, "dt": dt},
            "gravity": {"vector": [0.0, 0.0, 0.0]},
            "shape": shapes,
            "body": [upper, lower],
            "contact": [law],
            "output": {"energy": False},
        }
    )


def delivered(pose: Pose, asked: float, steps: int | None = STEPS) -> tuple[float, int]:
    """Newton's ratio at the first separation, and the largest number of sub-contacts."""
    simulation = Simulation(scene_of(pose, asked, steps), device="cpu", threads=1)
    most = 0
    while simulation.step_count < LONGEST:
        simulation.advance(simulation.time + simulation.dt)
        now = simulation.snapshot(contacts=True)
        assert now.contacts is not None
        count = len(now.contacts.gap)
        if most and not count:
            return separation(pose, now), most
        most = max(most, count)
    raise RuntimeError("the bodies do not part")


def separation(pose: Pose, now: Snapshot) -> float:
    """Speed at which the touching feature leaves the other body [m/s]."""
    arm = turned(product(now.orientation[0], pose.turn * CONJUGATE), feature(pose.turn))
    point = now.position[0] + arm
    speeds = now.velocity + np.cross(now.spin, point - now.position)
    return float(speeds[0, 2] - speeds[1, 2])


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=STEPS, help="in a contact")
    parser.add_argument("--auto", action="store_true", help='dt = "auto"')
    asked = parser.parse_args()
    steps = None if asked.auto else asked.steps
    passes = True
    print(f"{'asked':30s}" + "".join(f"{e:8.1f}" for e in ASKED) + f"   gate {GATE}")
    for name, pose in POSES.items():
        got = [delivered(pose, e, steps)[0] for e in ASKED]
        within = max(abs(e - e_asked) for e, e_asked in zip(got, ASKED, strict=True)) <= GATE
        passes = passes and within
        print(f"{name:30s}" + "".join(f"{e:8.4f}" for e in got) + f"   {verdict(within)}")
    return 0 if passes else 1


if __name__ == "__main__":
    sys.exit(main())
