"""Friction on a plane: a ball that comes to roll, blocks that slide or stick on a slope."""

from __future__ import annotations

from functools import cache
from math import cos, radians, sin
from typing import TYPE_CHECKING, Any

import numpy as np
from slopes import ball as hard_ball
from slopes import box as hard_box
from slopes import law as ground
from slopes import plane, site_on
from slopes import starts as released

from precision_cases.case import GROUND, PLANE, SKIN, WEIGHT, Case, G, lattice, random, scene_of
from precision_cases.hard import Hard
from precision_cases.impacts import BALL, KN, MU, RADIUS, SPHERES, balls, law, of_snapshot, starts
from precision_cases.settings import CONTACT, SHARED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from precision_cases.case import FloatArray, Scene

# --- a sliding ball comes to roll --------------------------------------------------------------
ROLLERS, ROLLED, KEPT = 50, 0.2, 0.65
SPEEDS = random(21).uniform(0.5, 1.5, ROLLERS)


@cache
def roll_problem() -> Scene:
    """Balls at rest on the plane but for their speed."""
    velocity = SPEEDS[:, None] * np.array([1.0, 0.0, 0.0])
    height = np.full(ROLLERS, RADIUS - G / KN)
    return starts(height, velocity, 0.0 * velocity, KEPT, MU, ROLLED, G)


def roll_scene() -> Scene:
    p = roll_problem()
    bodies = balls(np.array(p["position"])[:, 2], p["velocity"], p["spin"])
    return scene_of(bodies, [BALL, PLANE], law(KEPT, MU), gravity=WEIGHT, run=SKIN)


def rolling(velocity: FloatArray, spin: FloatArray, _: FloatArray) -> FloatArray:
    """Velocity and speed of the surface, over the speed at the start."""
    return np.column_stack([velocity[:, 0], RADIUS * spin[:, 1]]) / SPEEDS[:, None]


def roll_rigid() -> FloatArray:
    """Both 5/7."""
    return np.full((ROLLERS, 2), 5.0 / 7.0)


def roll_hard(run: Mapping[str, Any], steps: int) -> Hard:
    """By impulses."""
    p = roll_problem()
    place = np.array(p["position"])
    place[:, 2] = RADIUS
    begin = released(place, velocity=p["velocity"])
    site = site_on(plane(), ground(MU))

    def measured(end: Any) -> FloatArray:
        return rolling(end.velocity, end.spin, end.position)

    return Hard(site, hard_ball(RADIUS, 1.0), run, ROLLED, steps, begin, measured)


# --- blocks on a slope -------------------------------------------------------------------------
ANGLE, GRIP, SLID = radians(20.0), 0.5, 0.8
BLOCK = (0.2, 0.2, 0.1)
HARDNESS = {"kn": 1e6, "kt": 8e5, "en2": 0.1, "mu": GRIP}
MASS = 10.0
WAYS = random(22).uniform(0.3, 0.8, 10)
"""Speeds of the sliding ones at the start [m/s]."""
DOWN = (G * sin(ANGLE), 0.0, -G * cos(ANGLE))


def slope_scene(speeds: FloatArray) -> Scene:
    """Blocks pressed to the plane as they are at rest; gravity is tilted."""
    size = {"size": list(BLOCK), "rounding": 0.01}
    inertia = (np.square(BLOCK).sum() - np.square(BLOCK)) / 12.0
    shape = {"kind": "box", "name": "block", "volume": 1.0, "inertia_over_mass": inertia, **size}
    sunk = MASS * G * cos(ANGLE) / (4.0 * HARDNESS["kn"])
    bodies = [
        {
            "shape": "block",
            "density": MASS,
            "position": [x, y, 0.5 * BLOCK[2] - sunk],
            "velocity": [v, 0.0, 0.0],
        }
        for (x, y), v in zip(lattice(len(speeds), 3.0), speeds, strict=True)
    ]
    weight = {"vector": list(DOWN)}
    return scene_of([*bodies, GROUND], [shape, PLANE], HARDNESS, gravity=weight, run=SKIN)


def slope_problem(speeds: FloatArray) -> Scene:
    """For other programs."""
    place = np.column_stack([lattice(len(speeds), 3.0), np.zeros(len(speeds))])
    velocity = np.asarray(speeds)[:, None] * np.array([1.0, 0.0, 0.0])
    known = {"block": list(BLOCK), "mass": MASS, "gravity": list(DOWN), "until": SLID}
    known |= {"position": place.tolist(), "velocity": velocity.tolist(), "mu": GRIP}
    return known | {"kn": 4.0 * HARDNESS["kn"], "kt": 4.0 * HARDNESS["kt"], "zeta": 0.4}


def way(place: FloatArray) -> FloatArray:
    """How far each has come down [m]."""
    return place[:, 0] - lattice(len(place), 3.0)[:, 0]


def stops(speeds: FloatArray) -> FloatArray:
    """Ways on which friction stops them [m]."""
    return speeds**2 / (2.0 * G * (GRIP * cos(ANGLE) - sin(ANGLE)))


def slope_hard(speeds: FloatArray, unit: FloatArray | float) -> Any:
    """By impulses, on a real slope."""

    def made(run: Mapping[str, Any], steps: int) -> Hard:
        normal, along = (
            np.array([sin(ANGLE), 0, cos(ANGLE)]),
            np.array([cos(ANGLE), 0, -sin(ANGLE)]),
        )
        spread = np.arange(len(speeds))[:, None] * np.array([0.0, 3.0, 0.0])
        place = (0.5 * BLOCK[2] - 1e-9) * normal + spread
        turn = (cos(ANGLE / 2), 0.0, sin(ANGLE / 2), 0.0)
        begin = released(place, velocity=speeds[:, None] * along, orientation=turn)
        site = site_on(plane((-np.tan(ANGLE), 0.0)), ground(GRIP))

        def measured(end: Any) -> FloatArray:
            return ((end.position - place) @ along) / unit

        return Hard(site, hard_box(BLOCK, MASS), run, SLID, steps, begin, measured)

    return made


STILL = np.zeros(10)
BLOCKS = ("YADE", "LIGGGHTS", "MuJoCo", "PyBullet")
CASES = (
    Case(
        "slip_to_roll",
        f"{ROLLERS} sliding balls come to roll; velocity and spin over the speed",
        ROLLED,
        tuple(200 * 2**k for k in range(6)),
        (*CONTACT, "nonsmooth"),
        roll_scene,
        of_snapshot(rolling),
        programs=SPHERES,
        problem=roll_problem,
        seen=rolling,
        rigid=roll_rigid,
        hard=roll_hard,
        hard_steps=(20, 40, 80, 160, 320),
    ),
    Case(
        "slope_slide",
        "10 blocks slide down 20 degrees until friction stops them; way, against v^2/(2 a)",
        SLID,
        tuple(800 * 2**k for k in range(5)),
        (*SHARED, "nonsmooth"),
        lambda: slope_scene(WAYS),
        lambda shot: way(shot.position[:-1]) / stops(WAYS),
        exact=lambda _: np.ones(10),
        programs=BLOCKS,
        problem=lambda: slope_problem(WAYS),
        seen=lambda _, __, place: way(place) / stops(WAYS),
        rigid=lambda: np.ones(10),
        hard=slope_hard(WAYS, stops(WAYS)),
        hard_steps=(80, 160, 320, 640, 1280),
    ),
    Case(
        "slope_stick",
        "10 blocks stick on the same slope with the same settings; way [m], against a finer run",
        SLID,
        tuple(800 * 2**k for k in range(5)),
        (*SHARED, "nonsmooth"),
        lambda: slope_scene(STILL),
        lambda shot: way(shot.position[:-1]),
        finer=4,
        programs=BLOCKS,
        problem=lambda: slope_problem(STILL),
        seen=lambda _, __, place: way(place),
        rigid=lambda: STILL,
        hard=slope_hard(STILL, 1.0),
        hard_steps=(80, 160, 320, 640, 1280),
    ),
)
