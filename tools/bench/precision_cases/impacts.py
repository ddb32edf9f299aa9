"""Spheres that hit a plane: at right angles, obliquely with spin and friction, again and again."""

from __future__ import annotations

from functools import cache
from math import acos, cos, exp, log, pi, sin, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np
from slopes import ball as hard_ball
from slopes import law as ground
from slopes import plane, site_on
from slopes import starts as released

from precision_cases.case import GROUND, PLANE, SKIN, WEIGHT, Case, G, lattice, random, scene_of
from precision_cases.hard import Hard
from precision_cases.settings import CONTACT
from scenes import clamped_restitution

if TYPE_CHECKING:
    from collections.abc import Mapping

    from precision_cases.case import FloatArray, Scene

COPIES, APART = 500, 1.2
RADIUS = 0.1
KN, KT, MU = 1e5, 8e4, 0.3
TOUCH = pi / sqrt(KN)
"""Time of an undamped contact of 1 kg [s]."""
BALL = {"kind": "sphere", "name": "ball", "radius": RADIUS}
DENSITY = 3.0 / (4.0 * pi * RADIUS**3)
LADDER = (8, 15, 30, 60, 120, 240, 480, 960)


def balls(height: FloatArray, velocity: FloatArray, spin: FloatArray) -> list[Scene]:
    """Of 1 kg, over the plane, which comes last."""
    place = lattice(len(height), APART)
    rows = zip(place, height, velocity, spin, strict=True)
    return [
        {"shape": "ball", "density": DENSITY, "position": [x, y, z], "velocity": v, "spin": w}
        for (x, y), z, v, w in rows
    ] + [GROUND]


def law(restitution: float, mu: float = 0.0) -> Scene:
    return {"kn": KN, "kt": KT if mu else 0.0, "en2": restitution**2, "mu": mu}


# --- normal impact -----------------------------------------------------------------------------
KEPT = 0.65
FALLS = random(1).uniform(0.05, 0.2, COPIES)
EARLY = random(2).uniform(0.0, 0.2, COPIES) * TOUCH
"""Until each touches, so that onsets have all phases of a step [s]."""


def normal_problem() -> Scene:
    """Starts for any program."""
    velocity = np.column_stack([0 * FALLS, 0 * FALLS, -FALLS])
    return starts(RADIUS + FALLS * EARLY, velocity, 0.0 * velocity, KEPT, 0.0, 1.5 * TOUCH)


def starts(
    height: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    restitution: float,
    mu: float,
    until: float,
    g: float = 0.0,
) -> Scene:
    """What another program needs to run balls over the plane."""
    place = np.column_stack([lattice(len(height), APART), height])
    zeta = damping_ratio(restitution)
    numbers = {"radius": RADIUS, "kn": KN, "kt": KT if mu else 0.0, "mu": mu, "zeta": zeta}
    numbers |= {"g": g, "until": until, "e": restitution}
    motion = {"position": place, "velocity": velocity, "spin": spin}
    return numbers | {key: np.asarray(value).tolist() for key, value in motion.items()}


def damping_ratio(restitution: float) -> float:
    """Of a dashpot that never pulls and keeps so much: the inverse of its formula."""
    low, high = 0.0, 1.0
    while high - low > 1e-15:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if clamped_restitution(middle) > restitution else (low, middle)
    return low


def of_rockable(restitution: float) -> float:
    """What is kept with the formula of contacts that pull, of which these do not."""
    rate = -log(restitution)
    return clamped_restitution(rate / sqrt(pi**2 + rate**2))


def bodies_of(problem: Scene) -> list[Scene]:
    height = np.array(problem["position"])[:, 2]
    return balls(height, problem["velocity"], problem["spin"])


def normal_scene() -> Scene:
    return scene_of(bodies_of(normal_problem()), [BALL, PLANE], law(KEPT), run=SKIN)


def normal_exact(of: str) -> FloatArray:
    return np.full(COPIES, of_rockable(KEPT) if of == "rockable" else KEPT)


def normal_of(velocity: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
    """Restitutions."""
    return velocity[:, 2] / FALLS


# --- oblique impact ----------------------------------------------------------------------------
SPEED = 0.1


@cache
def oblique_problem() -> Scene:
    """At 5 to 80 degrees from the normal, with spins."""
    draw = random(3)
    angle, way = np.radians(draw.uniform(5.0, 80.0, COPIES)), draw.uniform(0, 2 * pi, COPIES)
    along = np.column_stack([np.cos(way), np.sin(way)]) * (SPEED * np.sin(angle))[:, None]
    velocity = np.column_stack([along, -SPEED * np.cos(angle)])
    spin = draw.normal(size=(COPIES, 3)) * 0.5 * SPEED / RADIUS
    height = RADIUS - velocity[:, 2] * EARLY
    return starts(height, velocity, spin, KEPT, MU, 1.5 * TOUCH)


def oblique_scene() -> Scene:
    return scene_of(bodies_of(oblique_problem()), [BALL, PLANE], law(KEPT, MU), run=SKIN)


def oblique_of(velocity: FloatArray, spin: FloatArray, _: FloatArray) -> FloatArray:
    """Velocities, and spins as velocities of the surface."""
    return np.hstack([velocity, RADIUS * spin])


def oblique_rigid() -> FloatArray:
    """Hard contact: the normal impulse is known, friction stops the slip or does what it can."""
    p = oblique_problem()
    v, w = np.array(p["velocity"]), np.array(p["spin"])
    push = -(1.0 + KEPT) * v[:, 2]
    slip = v.copy()
    slip[:, 2] = 0.0
    slip += np.cross(w, [0.0, 0.0, -RADIUS]) * [1.0, 1.0, 0.0]
    size = np.linalg.norm(slip, axis=1)
    # the contact point answers a unit of impulse with 1/m + R^2/I = 7/2
    stop = np.minimum(size / 3.5, MU * push)
    impulse = -slip * (stop / size)[:, None]
    impulse[:, 2] = push
    turn = np.cross([0.0, 0.0, -RADIUS], impulse) / (0.4 * RADIUS**2)
    return np.hstack([v + impulse, RADIUS * (w + turn)])


# --- bounces -----------------------------------------------------------------------------------
BOUNCY, BOUNCED, BOUNCERS = 0.8, 0.8, 50


@cache
def bounce_problem() -> Scene:
    """Let fall from .1 to .3 m."""
    height = RADIUS + random(4).uniform(0.1, 0.3, BOUNCERS)
    none = np.zeros((BOUNCERS, 3))
    return starts(height, none, none, BOUNCY, 0.0, BOUNCED, G)


def bounce_scene() -> Scene:
    return scene_of(
        bodies_of(bounce_problem()), [BALL, PLANE], law(BOUNCY), gravity=WEIGHT, run=SKIN
    )


def bounce_exact(of: str) -> FloatArray:
    """Heights at the end: parabolas, and in contact the oscillator under weight."""
    kept = of_rockable(BOUNCY) if of == "rockable" else BOUNCY
    zeta = damping_ratio(kept)
    gaps = np.array(bounce_problem()["position"])[:, 2] - RADIUS
    return np.array([gap_after(float(gap), BOUNCED, zeta) for gap in gaps])


def bounce_rigid() -> FloatArray:
    """Heights at the end of balls that bounce at once."""
    gaps = np.array(bounce_problem()["position"])[:, 2] - RADIUS
    found = []
    for gap in gaps:
        time, speed, left = sqrt(2.0 * gap / G), sqrt(2.0 * G * gap), BOUNCED
        while left > time:
            left -= time
            speed *= BOUNCY
            time = 2.0 * speed / G
        found.append(gap - 0.5 * G * left**2 if left == BOUNCED else speed * left - G * left**2 / 2)
    return np.array(found)


def gap_after(gap: float, left: float, zeta: float) -> float:
    """Gap of a ball of 1 kg so long after it was let go [m]."""
    speed = 0.0  # upwards
    while True:
        fall = (speed + sqrt(speed**2 + 2.0 * G * gap)) / G
        if fall >= left:
            return gap + speed * left - 0.5 * G * left**2
        left -= fall
        depth, inward, lasted = pressed(G * fall - speed, left, zeta)
        if lasted >= left:
            return -depth
        gap, speed, left = -depth, -inward, left - lasted
        if gap < 0.0:  # the force ends before the overlap does
            out = (speed - sqrt(max(speed**2 + 2.0 * G * gap, 0.0))) / G
            if out >= left:
                return gap + speed * left - 0.5 * G * left**2
            gap, speed, left = 0.0, speed - G * out, left - out


def pressed(inward: float, longest: float, zeta: float) -> tuple[float, float, float]:
    """Overlap, its rate and the time when the force of a contact ends, or at the longest."""
    omega = sqrt(KN)
    swing, rate, sunk = omega * sqrt(1.0 - zeta**2), zeta * omega, G / KN

    def state(t: float) -> tuple[float, float]:
        b = (inward - rate * sunk) / swing
        c, s, decay = cos(swing * t), sin(swing * t), exp(-rate * t)
        d = sunk + decay * (-sunk * c + b * s)
        v = decay * ((rate * sunk + b * swing) * c + (sunk * swing - rate * b) * s)
        return d, v

    def force(t: float) -> float:
        d, v = state(t)
        return KN * d + 2.0 * rate * v

    # the force ends some time after the largest overlap, before the overlap does
    low, high = 0.5 * acos(zeta) / swing, 2.0 * pi / swing
    if force(high) > 0.0:
        high *= 0.75
    while high - low > 1e-15:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if force(middle) > 0.0 else (low, middle)
    end = min(low, longest)
    return *state(end), end


def of_snapshot(measure: Any) -> Any:
    """A measure of velocities, spins and places of the free bodies, of a snapshot."""
    return lambda shot: measure(shot.velocity[:-1], shot.spin[:-1], shot.position[:-1])


def heights(_: FloatArray, __: FloatArray, place: FloatArray) -> FloatArray:
    """Gaps."""
    return place[:, 2] - RADIUS


def bounce_hard(run: Mapping[str, Any], steps: int) -> Hard:
    """By impulses."""
    begin = released(bounce_problem()["position"])
    site = site_on(plane(), ground(0.0, restitution=BOUNCY))

    def measured(end: Any) -> FloatArray:
        return heights(end.velocity, end.spin, end.position)

    return Hard(site, hard_ball(RADIUS, 1.0), run, BOUNCED, steps, begin, measured)


SPHERES = ("YADE", "LIGGGHTS", "MuJoCo", "PyBullet", "Kratos")
CASES = (
    Case(
        "normal_impact",
        f"{COPIES} spheres hit a plane at right angles; restitution, against the closed form",
        1.5 * TOUCH,
        LADDER,
        CONTACT,
        normal_scene,
        of_snapshot(normal_of),
        exact=normal_exact,
        programs=SPHERES,
        problem=normal_problem,
        seen=normal_of,
        rigid=lambda: np.full(COPIES, KEPT),
    ),
    Case(
        "oblique_impact",
        f"{COPIES} spinning spheres hit a plane obliquely; velocities and spins over the speed",
        1.5 * TOUCH,
        LADDER,
        CONTACT,
        oblique_scene,
        of_snapshot(oblique_of),
        unit=SPEED,
        programs=SPHERES,
        problem=oblique_problem,
        seen=oblique_of,
        rigid=oblique_rigid,
    ),
    Case(
        "bounce",
        f"{BOUNCERS} spheres bounce for {BOUNCED} s; height over .2 m, against the closed form",
        BOUNCED,
        tuple(400 * 2**k for k in range(6)),
        (*CONTACT, "nonsmooth"),
        bounce_scene,
        of_snapshot(heights),
        unit=0.2,
        exact=bounce_exact,
        programs=SPHERES,
        problem=bounce_problem,
        seen=heights,
        hard=bounce_hard,
        hard_steps=(80, 160, 320, 640, 1280),
        rigid=bounce_rigid,
    ),
)
