"""The Tschamut field test: simulated against observed deposits, untuned, then by one parameter.

    python tools/bench/rockfall_tschamut.py --data FOLDER [--orientations N] [--picture FILE.png]

Terrain, blocks and release states are those of scenes/rockfall_tschamut.toml; FOLDER holds
observed_deposition.csv (EnviDat, doi:10.16904/envidat.34), where half of the throws ended. Only
these throws are simulated, each with N random orientations, from 2 cm above the ground with the
measured velocity.

``leave`` is the share whose run-out exceeds 20 m; mean, sd and 90 % quantile of the run-out and the
spread across the mean direction are those of the ones that leave, as is the first statistic D of
Kolmogorov and Smirnov against the observed run-outs. The second D counts the others too.

The trajectories of one throw share its place and velocity, and the observed one is of the same
throw. So p is that of a permutation within throws: how often D is no smaller when in each throw
some other trajectory takes the part of the observed one. It cannot be less than .001.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rockfall_cases as cases

import warpdem
from warpdem.geometry.terrain import read_raster
from warpdem.rockfall.classes import PUBLISHED
from warpdem.rockfall.prepare import method_of
from warpdem.rockfall.rocks import rocks_of
from warpdem.rockfall.settle import resting_height

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene import Scene
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import GroundClass, Site

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "rockfall_tschamut.toml"
FILES = SCENE.parent / "data" / "tschamut"
GONE = 20.0
"""Run-out beyond which a block has left its release [m]."""
FEW = 5
"""Fewer trajectories have no statistics."""
CLEARANCE = 0.02
SCANS = {
    "mu_min": (0.35, 0.45, 0.55, 0.65, 0.8, 1.0, 1.2),
    "mu_max": (0.7, 0.8, 1.0, 1.5, 2.0, 3.0),
    "drag": (0.0, 0.1, 0.2, 0.3, 0.4, 0.6),
}
PUSHES = (0.0, 1.5, 3.0)
"""Added to the velocity at release, downhill [m/s]."""


@dataclass(frozen=True, eq=False)
class Throws:
    """Releases and where their blocks were found; one row each.

    Attributes:
        place: x, y of the release [m], shape [n, 2].
        velocity: At the release [m/s], shape [n, 3].
        rock: Number of the block, shape [n].
        deposit: x, y [m], shape [n, 2].
    """

    place: FloatArray
    velocity: FloatArray
    rock: IntArray
    deposit: FloatArray


@dataclass(frozen=True)
class Case:
    """What is simulated: a ground, a push [m/s], a roughness of nodes every metre [m]."""

    ground: GroundClass
    push: float = 0.0
    roughness: float = 0.0


def throws_of(folder: Path, rocks: Sequence[Rock]) -> Throws:
    """Those throws whose deposits are known."""
    seen = {row["trajectory_id"]: row for row in cases.table(folder / "observed_deposition.csv")}
    rows = [
        row for row in cases.table(FILES / "release_points.csv") if row["trajectory_id"] in seen
    ]
    order = [rock.name for rock in rocks]
    return Throws(
        cases.numbers(rows, "x_m", "y_m"),
        cases.numbers(rows, "vx_mps", "vy_mps", "vz_mps"),
        np.array([order.index(row["block_id"]) for row in rows]),
        cases.numbers([seen[row["trajectory_id"]] for row in rows], "x_m", "y_m"),
    )


def downhill(site: Site, place: FloatArray) -> FloatArray:
    """Unit vectors down the slope at local places, shape [n, 3]."""
    step = 0.5 * site.ground.grid.cell
    x, y = place.T
    height = site.ground.height
    rise_x = (height(x + step, y) - height(x - step, y)) / (2 * step)
    rise_y = (height(x, y + step) - height(x, y - step)) / (2 * step)
    along = np.column_stack([-rise_x, -rise_y, -(rise_x**2) - rise_y**2])
    return along / np.linalg.norm(along, axis=1, keepdims=True)


def displacements(
    scene: Scene, case: Case, throws: Throws, rocks: Sequence[Rock], count: int
) -> FloatArray:
    """Ways in plan from release to deposit [m], shape [throw_count, count, 2]."""
    raster = read_raster(FILES / "terrain.asc", nodes="corner")
    if case.roughness:
        every_metre = round(raster.cell)
        raster = cases.roughened(cases.refined(raster, every_metre), case.roughness, seed=2)
    site = cases.site_of(raster, case.ground)
    place = np.repeat(throws.place - site.origin[:2], count, axis=0)
    rock = np.repeat(throws.rock, count)
    orientation = cases.random_orientations(len(place), seed=1)
    height = np.empty(len(place))
    for number, one in enumerate(rocks):
        at = np.flatnonzero(rock == number)
        clearance = np.full(len(at), CLEARANCE)
        height[at] = resting_height(site.ground, one, place[at], orientation[at], clearance)
    velocity = np.repeat(throws.velocity, count, axis=0) + case.push * downhill(site, place)
    position = np.column_stack([place, height])
    starts = cases.starts_of(position, orientation, velocity, np.zeros(3), rock)
    flights = cases.fly(site, rocks, method_of(scene), starts)
    return (flights.position[:, :2] - place).reshape(-1, count, 2)


def spread(way: FloatArray) -> float:
    """Standard deviation across the mean direction [m]."""
    mean = way.mean(axis=0)
    return float(np.std(way @ np.array([-mean[1], mean[0]]) / np.linalg.norm(mean)))


def line(name: str, way: FloatArray, observed: FloatArray) -> tuple[float, float]:
    """Print one row of the table; the two statistics of Kolmogorov and Smirnov."""
    run, seen = np.linalg.norm(way, axis=-1), np.linalg.norm(observed, axis=1)
    gone = run > GONE
    everything = cases.kolmogorov_smirnov(run.ravel(), seen)
    chance = cases.chance_within(list(run), seen)
    head = f"{name:26s} {gone.mean():5.0%}"
    if gone.sum() < FEW:
        print(f"{head}  too few leave{'':25s} {everything:5.2f} {chance:5.3f}")
        return 1.0, everything
    left = run[gone]
    distance = cases.kolmogorov_smirnov(left, seen)
    likely = cases.chance_within([one[one > GONE] for one in run], seen)
    print(
        f"{head} {left.mean():6.1f} {left.std():6.1f} {np.quantile(left, 0.9):6.1f} "
        f"{spread(way[gone]):7.1f} {distance:6.2f} {likely:5.3f} {everything:5.2f} {chance:5.3f}"
    )
    return distance, everything


def picture(path: Path, ways: dict[str, FloatArray], observed: FloatArray) -> None:
    """Distributions of the run-out, and deposits in plan seen from their releases."""
    import matplotlib as mpl  # noqa: PLC0415 - only for the picture

    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5))
    for name, way in {"observed": observed, **ways}.items():
        run = np.sort(np.linalg.norm(way, axis=-1).ravel())
        style = {"color": "black", "linewidth": 2.5} if name == "observed" else {"linewidth": 1.0}
        left.step(run, np.arange(1, len(run) + 1) / len(run), label=name, **style)
    left.set(xlabel="run-out [m]", ylabel="share", title="all, those that stay included")
    left.legend()
    for name, way in ways.items():
        if name == "hard":
            right.plot(*way.reshape(-1, 2).T, ".", markersize=2, alpha=0.4, label=name)
    right.plot(*observed.T, "k^", markersize=5, label="observed")
    right.set(xlabel="east of the release [m]", ylabel="north [m]", aspect="equal")
    right.legend()
    figure.tight_layout()
    figure.savefig(path, dpi=120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="of observed_deposition.csv")
    parser.add_argument("--orientations", type=int, default=10, help="of each throw")
    parser.add_argument("--picture", type=Path, help="file of a plot")
    asked = parser.parse_args()
    scene = warpdem.load(SCENE)
    rocks = rocks_of(scene)
    throws = throws_of(asked.data, rocks)
    observed = throws.deposit - throws.place

    def run(name: str, case: Case) -> tuple[tuple[float, float], FloatArray]:
        way = displacements(scene, case, throws, rocks, asked.orientations)
        return line(name, way, observed), way

    print(f"{len(throws.rock)} throws x {asked.orientations} orientations")
    print(
        f"{'':26s} {'leave':>5s} {'mean':>6s} {'sd':>6s} {'q90':>6s} {'lateral':>7s} "
        f"{'D':>6s} {'p':>5s} {'D all':>5s} {'p':>5s}"
    )
    line("observed", observed[:, None], observed)
    ways = {name: run(name, Case(ground))[1] for name, ground in PUBLISHED.items()}
    hard = PUBLISHED["hard"]
    for key, values in SCANS.items():
        scan = {
            value: run(f"hard, {key} {value:g}", Case(replace(hard, **{key: value})))[0]
            for value in values
        }
        gone, everything = (values[k] for k in np.argmin([scan[v] for v in values], axis=0))
        print(f"  best {key}: {gone:g} by D of those that leave, {everything:g} by D of all")
    for push in PUSHES:
        for roughness in (0.0, 0.1):
            run(f"hard, +{push:g} m/s, rough {roughness:g}", Case(hard, push, roughness))
    if asked.picture:
        picture(asked.picture, ways, observed)


if __name__ == "__main__":
    main()
