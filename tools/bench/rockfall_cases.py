"""What the rockfall benches share: rasters changed, sites of one class, starts, statistics."""

from __future__ import annotations

import csv
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.geometry.terrain import Raster, raster_of
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.heights import origin_of, raster_ground
from warpdem.rockfall.rocks import rock_of
from warpdem.rockfall.site import Site
from warpdem.rockfall.solids import hulled

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.flights import Flights, Method
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import GroundClass
    from warpdem.rockfall.trajectories import Sample

G = 9.81
SLOTS = 512
"""Rocks followed at once: reading them back costs little then."""


def table(path: Path) -> list[dict[str, str]]:
    """Rows of a CSV file by column."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows: Sequence[dict[str, str]], *columns: str) -> FloatArray:
    """Columns of rows as numbers, shape [row_count, column_count]."""
    return np.array([[float(row[column] or "nan") for column in columns] for row in rows])


def extended(raster: Raster, width: float) -> Raster:
    """Continued on all sides, mirrored through the border's points so that slopes go on."""
    count = int(np.ceil(width / raster.cell))
    heights = np.pad(raster.heights, count, mode="reflect", reflect_type="odd")
    shift = count * raster.cell
    return raster_of(heights, raster.x[0] - shift, raster.y[-1] - shift, raster.cell)


def refined(raster: Raster, count: int) -> Raster:
    """The same bilinear surface with nodes ``count`` times as close."""
    rows, columns = raster.heights.shape
    v = np.arange((rows - 1) * count + 1) / count
    u = np.arange((columns - 1) * count + 1) / count
    by_row = np.array([np.interp(u, np.arange(columns), row) for row in raster.heights])
    fine = np.array([np.interp(v, np.arange(rows), column) for column in by_row.T]).T
    return raster_of(fine, raster.x[0], raster.y[-1], raster.cell / count)


def roughened(raster: Raster, deviation: float, seed: int) -> Raster:
    """With independent normal noise at each node [m]."""
    noise = np.random.default_rng(seed).normal(scale=deviation, size=raster.heights.shape)
    return raster_of(raster.heights + noise, raster.x[0], raster.y[-1], raster.cell)


def coarsened(raster: Raster, count: int) -> Raster:
    """Means of count x count nodes, at their middles, from the south-west corner on."""
    rows, columns = (size // count for size in raster.heights.shape)
    blocks = raster.heights[::-1][: rows * count, : columns * count]
    means = blocks.reshape(rows, count, columns, count).mean(axis=(1, 3))
    shift = 0.5 * (count - 1) * raster.cell
    west, south = raster.x[0] + shift, raster.y[-1] + shift
    return raster_of(means[::-1], west, south, raster.cell * count)


def slope(profile: FloatArray, west: float, *, width: float, cell: float) -> Raster:
    """Heights along x from ``west`` on, the same for all y within ``width`` of 0."""
    count = int(2 * width / cell) + 1
    return raster_of(np.tile(profile, (count, 1)), west, -width, cell)


def site_of(raster: Raster, ground_class: GroundClass) -> Site:
    """A site of one class."""
    origin = origin_of(raster.x, raster.y, raster.heights)
    ground = raster_ground(raster, origin)
    nothing = np.zeros(ground.known.shape, np.int32)
    return Site(
        origin, "", ground, (ground_class,), nothing, (), None, None, (), results=ground.grid
    )


def height(site: Site, x: FloatArray, y: FloatArray) -> FloatArray:
    """Of the ground at national coordinates, NaN beside it [m]."""
    return site.ground.height(x - site.origin[0], y - site.origin[1]) + site.origin[2]


def chamfered_box(size: Sequence[float]) -> FloatArray:
    """EOTA's test body: edges cut off a quarter deep, 17/24 of the box; shape [24, 3]."""
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    outward = [np.where(np.arange(3) == axis, 0.5, 0.25) for axis in range(3)]
    return np.concatenate([corners * along for along in outward]) * np.asarray(size)


def hull_rock(name: str, points: FloatArray, mass: float) -> Rock:
    """The hull of points as a rock of some mass [kg]."""
    solid, _ = hulled(points, name=name, rounding=0.0)
    return rock_of(solid, name, mass)


def random_orientations(count: int, seed: int) -> FloatArray:
    """Unit quaternions w, x, y, z, uniform over all turns, shape [count, 4]."""
    drawn = np.random.default_rng(seed).normal(size=(count, 4))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def depths(site: Site, rock: Rock, trace: Sample) -> FloatArray:
    """Vertical depth of the lowest vertex below the ground at each sample, negative above [m]."""
    corner = np.einsum("nij,vj->nvi", matrix(trace.orientation), rock.vertices)
    corner += trace.position[:, None]
    under = site.ground.height(corner[..., 0], corner[..., 1])
    return (under - corner[..., 2]).max(axis=1)


def starts_of(
    position: FloatArray,
    orientation: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    rock: IntArray | None = None,
) -> Starts:
    """Starts numbered from 0; arrays as of ``Starts`` or one row for all, positions local."""
    count = len(position)
    numbers_of_rocks = np.zeros(count) if rock is None else rock
    return Starts(
        np.arange(count),
        np.zeros(count, np.int32),
        numbers_of_rocks.astype(np.int32),
        position,
        orientation,
        np.broadcast_to(velocity, (count, 3)).copy(),
        np.broadcast_to(spin, (count, 3)).copy(),
    )


def fly(site: Site, rocks: Sequence[Rock], method: Method, starts: Starts) -> Flights:
    """Trajectories to their ends."""
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - compiles kernels

    return Trajectories(site, rocks, method, visits=False).fly(starts)


def follow(
    site: Site, rocks: Sequence[Rock], method: Method, starts: Starts, every: float
) -> list[Sample]:
    """Trajectories sampled each ``every`` seconds."""
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - compiles kernels

    return Trajectories(site, rocks, method, slots=SLOTS, visits=False).follow(starts, every)


def kolmogorov_smirnov(first: FloatArray, second: FloatArray) -> float:
    """Largest distance of two empirical distributions."""
    a, b = np.sort(first), np.sort(second)
    everywhere = np.concatenate([a, b])
    share_a = np.searchsorted(a, everywhere, side="right") / len(a)
    share_b = np.searchsorted(b, everywhere, side="right") / len(b)
    return float(np.abs(share_a - share_b).max())


def chance_within(groups: Sequence[FloatArray], observed: FloatArray, draws: int = 999) -> float:
    """Probability of a Kolmogorov-Smirnov distance no smaller, by permutation within groups.

    The hypothesis is that each observed value is one like the simulated ones of its group. In each
    draw one of the group, the observed value included, takes the part of the observed one. Values
    of different groups may have different distributions.

    Args:
        groups: Simulated values of each observation; may be empty.
        observed: One value a group, shape [group_count].
        draws: Whose share is returned; none is less than 1 / (draws + 1).
    """
    pools = [np.append(group, seen) for group, seen in zip(groups, observed, strict=True)]
    first = np.cumsum([0, *(len(pool) for pool in pools)])
    pooled = np.concatenate(pools)
    own = first[1:] - 1
    distance = kolmogorov_smirnov(np.delete(pooled, own), pooled[own]) - 1e-12
    random, reached = np.random.default_rng(3), 0
    for _ in range(draws):
        picked = random.integers(first[:-1], first[1:])
        reached += kolmogorov_smirnov(np.delete(pooled, picked), pooled[picked]) >= distance
    return (1 + reached) / (1 + draws)


def band(values: FloatArray) -> str:
    """Median and 10 to 90 % of values, as text."""
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return f"{middle:6.2f} ({low:6.2f} .. {high:6.2f})"
