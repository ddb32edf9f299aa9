"""The Tschamut field test: simulated against observed deposits, untuned, then by one parameter.

    python tools/bench/rockfall_tschamut.py --data FOLDER [--orientations N] [--picture FILE.png]

Terrain, blocks and release states travel with the gallery (scenes/data/tschamut); FOLDER holds
observed_deposition.csv (EnviDat, doi:10.16904/envidat.34), where half of the throws ended. Only
these throws are simulated, each with N random orientations, as boxes of the measured size and mass,
dropped from 2 cm with the measured velocity.

``leave`` is the share whose run-out exceeds 20 m; mean, sd and 90 % quantile of the run-out and the
spread across the mean direction are those of the ones that leave, as is the first statistic of
Kolmogorov and Smirnov against all observed run-outs. The second counts the others too. Its p treats
trajectories as independent, though N start from each release.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rockfall_cases as cases

from warpdem.rockfall.classes import PUBLISHED
from warpdem.rockfall.flights import Method

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import GroundClass

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "data" / "tschamut"
GONE = 20.0
"""Run-out beyond which a block has left its release [m]."""
CLEARANCE = 0.02
SCANS = {
    "mu_min": (0.35, 0.45, 0.55, 0.65, 0.8, 0.9, 1.0),
    "mu_max": (0.7, 0.8, 1.0, 1.5, 2.0),
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


def blocks() -> dict[str, Rock]:
    """The measured boxes, by their number in the field."""
    found = {}
    for row in cases.table(SCENE / "block_metadata.csv"):
        size = cases.numbers([row], "size_x_m", "size_y_m", "size_z_m")[0]
        found[row["block_id"]] = cases.convex_rock(
            row["name"], cases.box(size), float(row["mass_kg"])
        )
    return found


def throws_of(folder: Path, rocks: dict[str, Rock]) -> Throws:
    """Those throws whose deposits are known."""
    seen = {row["trajectory_id"]: row for row in cases.table(folder / "observed_deposition.csv")}
    rows = [
        row for row in cases.table(SCENE / "release_points.csv") if row["trajectory_id"] in seen
    ]
    order = list(rocks)
    return Throws(
        cases.numbers(rows, "x_m", "y_m"),
        cases.numbers(rows, "vx_mps", "vy_mps", "vz_mps"),
        np.array([order.index(row["block_id"]) for row in rows]),
        cases.numbers([seen[row["trajectory_id"]] for row in rows], "x_m", "y_m"),
    )


def downhill(nodes: cases.Nodes, place: FloatArray) -> FloatArray:
    """Unit vectors down the slope at places, shape [n, 3]."""
    step = 0.5 * nodes.cell
    x, y = place.T
    rise_x = (nodes.at(x + step, y) - nodes.at(x - step, y)) / (2 * step)
    rise_y = (nodes.at(x, y + step) - nodes.at(x, y - step)) / (2 * step)
    along = np.column_stack([-rise_x, -rise_y, -(rise_x**2) - rise_y**2])
    return along / np.linalg.norm(along, axis=1, keepdims=True)


def displacements(case: Case, throws: Throws, rocks: list[Rock], count: int) -> FloatArray:
    """Ways in plan from release to deposit [m], ``count`` of each throw, shape [n, 2]."""
    nodes = cases.nodes_of(SCENE / "terrain.asc", centres=False)
    if case.roughness:
        nodes = nodes.refined(1.0).rough(case.roughness, seed=2)
    site, origin = cases.site_of(nodes, case.ground, reach=5.0)
    local = nodes.moved(origin)
    place = np.repeat(throws.place - origin[:2], count, axis=0)
    rock = np.repeat(throws.rock, count)
    orientation = cases.random_orientations(len(place), seed=1)
    height = np.empty(len(place))
    for number, one in enumerate(rocks):
        at = rock == number
        height[at] = cases.clear_heights(local, one, place[at], orientation[at], CLEARANCE)
    starts = cases.starts_of(
        np.column_stack([place, height]),
        orientation,
        np.repeat(throws.velocity, count, axis=0) + case.push * downhill(local, place),
        np.zeros(3),
        rock=rock,
        release=np.repeat(np.arange(len(throws.place)), count),
    )
    flights = cases.fly(site, rocks, Method(duration=60.0), starts)
    return flights.position[:, :2] - place


def spread(way: FloatArray) -> float:
    """Standard deviation across the mean direction [m]."""
    mean = way.mean(axis=0)
    return float(np.std(way @ np.array([-mean[1], mean[0]]) / np.linalg.norm(mean)))


def line(name: str, way: FloatArray, observed: FloatArray) -> tuple[float, float]:
    """Print one row of the table; the two statistics of Kolmogorov and Smirnov."""
    run, seen = np.linalg.norm(way, axis=1), np.linalg.norm(observed, axis=1)
    gone = run > GONE
    everything, chance = cases.kolmogorov_smirnov(run, seen)
    head = f"{name:26s} {gone.mean():5.0%}"
    if gone.sum() < 5:
        print(f"{head}  too few leave{'':28s} {everything:5.2f} {chance:8.1e}")
        return 1.0, everything
    distance, likely = cases.kolmogorov_smirnov(run[gone], seen)
    print(
        f"{head} {run[gone].mean():6.1f} {run[gone].std():6.1f} {np.quantile(run[gone], 0.9):6.1f} "
        f"{spread(way[gone]):7.1f} {distance:6.2f} {likely:8.1e} {everything:5.2f} {chance:8.1e}"
    )
    return distance, everything


def picture(path: Path, ways: dict[str, FloatArray], observed: FloatArray) -> None:
    """Distributions of the run-out, and deposits in plan seen from their releases."""
    import matplotlib as mpl  # noqa: PLC0415 - only for the picture

    mpl.use("Agg")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - after the backend is chosen

    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5))
    for name, way in {"observed": observed, **ways}.items():
        run = np.sort(np.linalg.norm(way, axis=1))
        style = {"color": "black", "linewidth": 2.5} if name == "observed" else {"linewidth": 1.0}
        left.step(run, np.arange(1, len(run) + 1) / len(run), label=name, **style)
    left.set(xlabel="run-out [m]", ylabel="share", title="all, those that stay included")
    left.legend()
    for name, way in ways.items():
        if name == "hard":
            right.plot(*way.T, ".", markersize=2, alpha=0.4, label=name)
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
    known = blocks()
    throws, rocks = throws_of(asked.data, known), list(known.values())
    observed = throws.deposit - throws.place

    def run(name: str, case: Case) -> tuple[tuple[float, float], FloatArray]:
        way = displacements(case, throws, rocks, asked.orientations)
        return line(name, way, observed), way

    print(f"{len(throws.rock)} throws x {asked.orientations} orientations")
    print(
        f"{'':26s} {'leave':>5s} {'mean':>6s} {'sd':>6s} {'q90':>6s} {'lateral':>7s} "
        f"{'D':>6s} {'p':>8s} {'D all':>5s} {'p':>8s}"
    )
    line("observed", observed, observed)
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
