"""What sleep saves and what it costs in accuracy: a pile of which a small part is stirred, or hit.

    python tools/bench/sleep.py [--sphere 10] [--cube 7] [--intervals 10] [--hits 3]

Piles of so many spheres or cubes of .1 m a side of a box come to rest. Then a driven ball pushes
two loose bodies about on them: each interval of .04 s is run with and without sleep in turn, on one
thread; medians. Then a ball of 30 kg is thrown up from 1 m and falls on the middle of a pile of
5 x 5 x 4 balls at rest, so many piles: height and losses with sleep, less those without.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

import numpy as np

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

SIZE = 0.1
QUIET, INTERVAL = 2.0, 0.04
LAW = {"groups": ["default", "default"], "kn": 1e6, "kt": 8e5, "mu": 0.4, "en2": 0.1}
BALL = {"kind": "sphere", "name": "sphere", "radius": 0.5 * SIZE}
CUBE = {"kind": "box", "name": "cube", "size": [SIZE] * 3, "rounding": 0.05 * SIZE}
OTHERS = [
    {"kind": "sphere", "name": "stirrer", "radius": 0.8 * SIZE},
    {"kind": "plane", "name": "plane"},
]
HALF = float(np.sqrt(0.5))
SLEEP = {"speed": 2e-3, "after": 0.05, "tolerance": 0.02}


def box(width: float) -> list[dict[str, Any]]:
    """Floor and four walls; z = 0 is the floor."""
    a = 0.5 * width
    walls = {
        (0.0, 0.0, 0.0): [1.0, 0.0, 0.0, 0.0],
        (-a, 0.0, 0.0): [HALF, 0.0, HALF, 0.0],
        (a, 0.0, 0.0): [HALF, 0.0, -HALF, 0.0],
        (0.0, -a, 0.0): [HALF, -HALF, 0.0, 0.0],
        (0.0, a, 0.0): [HALF, HALF, 0.0, 0.0],
    }
    fixed = {"shape": "plane", "fixed": True}
    return [{**fixed, "position": at, "orientation": q} for at, q in walls.items()]


def pile(shape: str, sides: tuple[int, int, int], seed: int = 0) -> list[dict[str, Any]]:
    """Bodies a little apart from one another, not quite in line."""
    random = np.random.default_rng(seed)
    pitch = 1.02 * SIZE
    places = np.stack(np.meshgrid(*map(np.arange, sides), indexing="ij"), -1).reshape(-1, 3)
    middle = np.array([0.5 * (sides[0] - 1), 0.5 * (sides[1] - 1), -0.5])
    shift = random.uniform(-0.008, 0.008, places.shape) * SIZE
    free = {"shape": shape, "density": 2500.0}
    return [{**free, "position": at} for at in (places - middle) * pitch + shift]


def simulation(
    bodies: list[dict[str, Any]],
    sleep: dict[str, float] | None,
    drivers: list[dict[str, Any]] | None = None,
    dt: float | str = "auto",
) -> Simulation:
    """The bodies, one thread."""
    run: dict[str, Any] = {"duration": 100.0, "dt": dt}
    if sleep:
        run["sleep"] = sleep
    scene = {
        "run": run,
        "shape": [BALL, CUBE, *OTHERS],
        "body": bodies,
        "contact": [LAW],
        "driver": drivers or [],
    }
    return Simulation(Scene.model_validate(scene), device="cpu", threads=1)


def stirred(shape: str, side: int, intervals: int) -> None:
    """Print the time of a step with and without sleep."""
    width = 1.02 * SIZE * side + 0.01 * SIZE
    bodies, top = settled(shape, side, width)
    end = 0.5 * width - SIZE
    loose = [
        {**bodies[0], "position": [end - 1.6 * SIZE * k, end, top + 0.51 * SIZE]} for k in (1, 2)
    ]
    stirrer = {"shape": "stirrer", "name": "stirrer", "fixed": True}
    # clear of the pile, not of what lies on it
    bodies += [*loose, {**stirrer, "position": [end, end, top + 0.9 * SIZE]}, *box(width)]
    sweep = {
        "kind": "sine",
        "bodies": ["stirrer"],
        "translation": [-2.0 * SIZE, 0.0, 0.0],
        "frequency": 1.0,
        "start": QUIET + INTERVAL,
    }
    both = [simulation(bodies, sleep, [sweep]) for sleep in (None, SLEEP)]
    for each in both:
        each.advance(QUIET)
    quiet = both[1].report()["asleep"]
    rest = paired(both, QUIET, 1)
    spent = paired(both, QUIET + INTERVAL, intervals)
    report = both[1].report()
    print(
        f"| {shape} | {side**3 + 2} | {quiet} | {report['asleep']} | {report['woken']} "
        f"| {1e6 * np.median(spent[:, 0]):.0f} | {1e6 * np.median(spent[:, 1]):.0f} "
        f"| {np.median(spent[:, 0] / spent[:, 1]):.2f} | {rest[0, 0] / rest[0, 1]:.2f} |",
        flush=True,
    )


def settled(shape: str, side: int, width: float) -> tuple[list[dict[str, Any]], float]:
    """The pile come to rest, and the height of its surface."""
    bodies = pile(shape, (side,) * 3)
    lying = simulation([*bodies, *box(width)], None)
    lying.advance(QUIET)
    now = lying.snapshot()
    top = float(now.position[: side**3, 2].max()) + 0.5 * SIZE
    places = zip(bodies, now.position, now.orientation, strict=False)
    return [{**body, "position": x, "orientation": q} for body, x, q in places], top


def paired(both: list[Simulation], start: float, intervals: int) -> np.ndarray:
    """Seconds a step of each, in turn; shape [intervals, 2]."""
    spent = np.zeros((intervals, len(both)))
    for k in range(intervals):
        for place, each in enumerate(both):
            steps, begin = each.step_count, time.perf_counter()
            each.advance(start + (k + 1) * INTERVAL)
            spent[k, place] = (time.perf_counter() - begin) / (each.step_count - steps)
    return spent


def hit(seeds: int) -> None:
    """Print what sleep changes of a pile that is hit: by tolerance; and what half the step does."""
    ways = {
        "half the step": (None, 0.5),
        **{f"tolerance {t:g}": ({**SLEEP, "tolerance": t}, 1.0) for t in (0.002, 0.02, 0.1, 0.5)},
    }
    found: dict[str, list[tuple[float, ...]]] = {way: [] for way in ways}
    for seed in range(seeds):
        balls = pile("sphere", (5, 5, 4), seed)
        # falls through .5 g t^2 = 1 m after the pile has come to rest
        thrown = QUIET * 9.81 / 2.0
        heavy = {
            "shape": "stirrer",
            "density": 14000.0,
            "position": [0.01, 0.02, 1.0],
            "velocity": [0.0, 0.0, thrown],
        }
        bodies = [*balls, heavy, *box(5.1 * SIZE + 0.01 * SIZE)]
        plain = simulation(bodies, None)
        before = outcome(plain)
        for way, (sleep, factor) in ways.items():
            other = simulation(bodies, sleep, dt=plain.dt * factor)
            after = outcome(other)
            told = other.report()
            found[way].append((*(after - before), told.get("asleep", 0), told.get("woken", 0)))
    for way, values in found.items():
        v = np.array(values)
        print(
            f"| {way} | {np.abs(v[:, 0]).mean() / SIZE:.1e} | {np.abs(v[:, 1]).mean() / SIZE:.1e} "
            f"| {np.abs(v[:, 2]).mean():.1e} | {np.abs(v[:, 3]).mean():.1e} "
            f"| {v[:, 4].mean():.0f} | {v[:, 5].mean():.0f} |",
            flush=True,
        )


def outcome(each: Simulation) -> np.ndarray:
    """At the end: mean height, that of the heavy ball [m], part of the energy lost, balance."""
    start = each.snapshot().energy
    each.advance(2.0 * QUIET + 1.5)
    now = each.snapshot()
    assert start
    assert now.energy
    lost = now.energy.dashpot + now.energy.friction
    first = start.kinetic + start.potential
    heights = now.position[:100, 2].mean(), now.position[100, 2]
    return np.array([*heights, lost / first, now.energy.balance / first])


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sphere", type=int, default=10)
    parser.add_argument("--cube", type=int, default=7)
    parser.add_argument("--intervals", type=int, default=10)
    parser.add_argument("--hits", type=int, default=3)
    asked = parser.parse_args()
    print(
        "| shape | free | asleep before | after | woken | us a step | with sleep | ratio | before |"
    )
    print("|---|---|---|---|---|---|---|---|---|")
    for shape in ("sphere", "cube"):
        if side := getattr(asked, shape):
            stirred(shape, side, asked.intervals)
    print("\n| change | mean height / size | ball / size | lost | balance | asleep | woken |")
    print("|---|---|---|---|---|---|---|")
    if asked.hits:
        hit(asked.hits)


if __name__ == "__main__":
    main()
