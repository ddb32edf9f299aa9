"""Blocks on their faces and edges: towers that settle, a block that rocks, a bonded beam."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from beams import Beam
from scipy.integrate import solve_ivp
from slopes import box, law, plane, site_on, starts

from precision_cases.case import GROUND, PLANE, WEIGHT, Case, G, random, scene_of
from precision_cases.hard import Hard
from precision_cases.settings import SHARED

if TYPE_CHECKING:
    from collections.abc import Mapping

    from precision_cases.case import FloatArray, Scene

# --- towers ------------------------------------------------------------------------------------
SIDE, SETTLED = 0.2, 0.1
STONE = {"kn": 1e6, "kt": 8e5, "en2": 0.25, "mu": 0.5}
DENSITY = 2500.0


def tower_scene(count: int, copies: int, taper: float) -> Scene:
    """Cubes that just touch, each a little smaller than the one below and turned by some 1e-3."""
    sizes = SIDE - taper * np.arange(count)
    shapes = [
        {"kind": "box", "name": f"cube{k}", "size": [size] * 3, "rounding": 0.01}
        for k, size in enumerate(sizes)
    ]
    heights = np.cumsum(sizes) - 0.5 * sizes
    yaws = random(31).normal(size=(copies, count)) * 1e-3
    bodies = [
        {
            "shape": f"cube{k}",
            "density": DENSITY,
            "position": [3.0 * SIDE * tower, 0.0, heights[k]],
            "orientation": [np.cos(0.5 * yaw), 0.0, 0.0, np.sin(0.5 * yaw)],
        }
        for tower in range(copies)
        for k, yaw in enumerate(yaws[tower])
    ]
    return scene_of([*bodies, GROUND], [*shapes, PLANE], STONE, gravity=WEIGHT)


def places(shot: Any) -> FloatArray:
    """Of the free bodies."""
    return shot.position[:-1]


# --- a rocking block ---------------------------------------------------------------------------
HALF, TALL, ROCKED = 0.1, 0.4, 0.6
PARTS = np.linspace(0.3, 0.6, 10)
"""Tilts at the start, over the slenderness."""


@cache
def rocking_scene() -> Scene:
    """Blocks let go on their edges, 30 to 60 % of the way to falling over."""
    slim, arm = np.arctan2(HALF, TALL), np.hypot(HALF, TALL)
    shape = {"kind": "box", "name": "block", "size": [2 * HALF, 0.3, 2 * TALL], "rounding": 1e-3}
    bodies = [
        {
            "shape": "block",
            "density": DENSITY,
            "position": [
                1.5 * k + HALF - arm * np.sin(slim - tilt),
                0.0,
                arm * np.cos(slim - tilt),
            ],
            "orientation": [np.cos(0.5 * tilt), 0.0, np.sin(0.5 * tilt), 0.0],
        }
        for k, tilt in enumerate(slim * PARTS)
    ]
    law = {"kn": 1e7, "kt": 8e6, "en2": 0.04, "mu": 0.8}
    return scene_of([*bodies, GROUND], [shape, PLANE], law, gravity=WEIGHT)


def rocking_rigid() -> FloatArray:
    """Housner's block: each impact keeps 1 - 3/2 sin^2 of the slenderness of the spin."""
    slim, arm = np.arctan2(HALF, TALL), np.hypot(HALF, TALL)
    square, kept = 3.0 * G / (4.0 * arm), 1.0 - 1.5 * np.sin(slim) ** 2

    def rate(_: float, y: FloatArray) -> list[float]:
        return [y[1], -square * np.sin(slim - abs(y[0])) * np.sign(y[0])]

    def level(_: float, y: FloatArray) -> float:
        return y[0]

    level.terminal = True  # type: ignore[attr-defined]
    found = []
    for tilt in slim * PARTS:
        state, now = np.array([tilt, 0.0]), 0.0
        while now < ROCKED:
            exact = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853", "events": level}
            way = solve_ivp(rate, (now, ROCKED), state, **exact)
            now, state = way.t[-1], way.y[:, -1]
            if way.t_events[0].size:
                spin = kept * state[1]
                state = np.array([1e-9 * np.sign(spin), spin])
        found.append(state[0] / slim)
    return np.array(found)


def rocking_hard(run: Mapping[str, Any], steps: int) -> Hard:
    """By impulses; friction never slips."""
    slim, arm = np.arctan2(HALF, TALL), np.hypot(HALF, TALL)
    tilt = slim * PARTS
    place = np.column_stack(
        [HALF - arm * np.sin(slim - tilt), 1.5 * np.arange(len(tilt)), arm * np.cos(slim - tilt)]
    )
    begin = starts(place)
    begin.orientation[:] = np.column_stack(
        [np.cos(0.5 * tilt), 0.0 * tilt, np.sin(0.5 * tilt), 0.0 * tilt]
    )
    rock, site = box((2 * HALF, 0.5, 2 * TALL)), site_on(plane(), law(5.0))

    def measured(end: Any) -> FloatArray:
        return 2.0 * np.arctan2(end.orientation[:, 2], end.orientation[:, 0]) / slim

    return Hard(site, rock, run, ROCKED, steps, begin, measured)


def tilts(shot: Any) -> FloatArray:
    """Over the slenderness."""
    q = shot.orientation[:-1]
    return 2.0 * np.arctan2(q[:, 2], q[:, 0]) / np.arctan2(HALF, TALL)


# --- a bonded cantilever -----------------------------------------------------------------------
CUBES, BEAMS, MODE, SWUNG = 5, 10, 2, 0.02
BEAM = Beam(CUBES, 0.1, 1e7, 5e6)
OMEGA, SHAPES = BEAM.bending()
SWING = SHAPES[:, MODE] / np.abs(SHAPES[:CUBES, MODE]).max()
AMPLITUDE = 1e-6 * BEAM.side


def beam_scene() -> Scene:
    """Beams that start in their third mode of bending."""
    velocity, spin = np.zeros((CUBES + 1, 3)), np.zeros((CUBES + 1, 3))
    velocity[1:, 2] = AMPLITUDE * OMEGA[MODE] * SWING[:CUBES]
    spin[1:, 1] = -AMPLITUDE * OMEGA[MODE] * SWING[CUBES:]
    one = BEAM.scene(motion=(velocity.tolist(), spin.tolist()))
    bodies = [
        {**body, "position": [body["position"][0], 0.5 * k, 0.0], "cluster": k}
        for k in range(BEAMS)
        for body in one["body"]
    ]
    return {**one, "body": bodies}


def deflections(shot: Any) -> FloatArray:
    """Of the free cubes, over the amplitude; shape [beams, cubes]."""
    return shot.position[:, 2].reshape(BEAMS, CUBES + 1)[:, 1:] / AMPLITUDE


def swung(_: str) -> FloatArray:
    """The mode, in its time."""
    return np.tile(np.sin(OMEGA[MODE] * SWUNG) * SWING[:CUBES], (BEAMS, 1))


CASES = (
    Case(
        "tower_10",
        "5 towers of 10 cubes settle for .1 s; places over 1 mm, against a finer run",
        SETTLED,
        tuple(100 * 2**k for k in range(5)),
        SHARED,
        lambda: tower_scene(10, 5, 1e-3),
        places,
        unit=1e-3,
    ),
    Case(
        "tower_50",
        "a tower of 50 cubes settles for .1 s; places over 1 cm, against a finer run",
        SETTLED,
        tuple(100 * 2**k for k in range(5)),
        SHARED,
        lambda: tower_scene(50, 1, 5e-4),
        places,
        unit=1e-2,
    ),
    Case(
        "rocking_block",
        "10 blocks rock for .6 s; tilt over the slenderness, against a finer run",
        ROCKED,
        tuple(600 * 2**k for k in range(5)),
        (*SHARED, "nonsmooth"),
        rocking_scene,
        tilts,
        rigid=rocking_rigid,
        hard=rocking_hard,
        hard_steps=(300, 600, 1200, 2400, 4800),
    ),
    Case(
        "cantilever",
        "10 bonded beams swing in their third mode; deflection, against the linear beam",
        SWUNG,
        tuple(125 * 2**k for k in range(6)),
        ("default", "mixed", "rockable"),
        beam_scene,
        deflections,
        exact=swung,
    ),
)
