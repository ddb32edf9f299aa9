"""What the rockfall benches share: sites of nodes, hulls, starts on the ground, statistics."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.geometry.terrain import read_raster
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.site import Grid, Ground, GroundClass, Site

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.flights import Flights, Method
    from warpdem.rockfall.trajectories import Sample

G = 9.81


def table(path: Path) -> list[dict[str, str]]:
    """Rows of a CSV file by column."""
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def numbers(rows: Sequence[dict[str, str]], *columns: str) -> FloatArray:
    """Columns of rows as numbers, shape [row_count, column_count]."""
    return np.array([[float(row[column] or "nan") for column in columns] for row in rows])


@dataclass(frozen=True, eq=False)
class Nodes:
    """Heights at the nodes of a square grid; row 0 lies in the south.

    Attributes:
        x, y: Of the first node [m].
        cell: [m].
        heights: [m], shape [row_count, column_count].
    """

    x: float
    y: float
    cell: float
    heights: FloatArray

    def moved(self, origin: FloatArray) -> Nodes:
        """In coordinates that begin at ``origin``."""
        return Nodes(self.x - origin[0], self.y - origin[1], self.cell, self.heights - origin[2])

    def extended(self, width: float) -> Nodes:
        """Continued on all sides, mirrored through the border's points so that slopes go on."""
        count = int(np.ceil(width / self.cell))
        heights = np.pad(self.heights, count, mode="reflect", reflect_type="odd")
        return Nodes(self.x - count * self.cell, self.y - count * self.cell, self.cell, heights)

    def refined(self, cell: float) -> Nodes:
        """The same bilinear surface with nodes closer together, at a divisor of ``cell``."""
        rows, columns = self.heights.shape
        count = round(self.cell / cell)
        v = np.arange((rows - 1) * count + 1) / count
        u = np.arange((columns - 1) * count + 1) / count
        by_row = np.array([np.interp(u, np.arange(columns), row) for row in self.heights])
        fine = np.array([np.interp(v, np.arange(rows), column) for column in by_row.T]).T
        return Nodes(self.x, self.y, self.cell / count, fine)

    def rough(self, deviation: float, seed: int) -> Nodes:
        """With independent normal noise at each node [m]."""
        noise = np.random.default_rng(seed).normal(scale=deviation, size=self.heights.shape)
        return Nodes(self.x, self.y, self.cell, self.heights + noise)

    def coarsened(self, count: int) -> Nodes:
        """Means of count x count nodes, at their middles."""
        rows, columns = (size // count for size in self.heights.shape)
        blocks = self.heights[: rows * count, : columns * count]
        heights = blocks.reshape(rows, count, columns, count).mean(axis=(1, 3))
        shift = 0.5 * (count - 1) * self.cell
        return Nodes(self.x + shift, self.y + shift, self.cell * count, heights)

    def at(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Height of the bilinear surface, NaN beside it [m]."""
        u = (np.asarray(x) - self.x) / self.cell
        v = (np.asarray(y) - self.y) / self.cell
        rows, columns = self.heights.shape
        inside = (u >= 0) & (u <= columns - 1) & (v >= 0) & (v <= rows - 1)
        i = np.clip(np.where(inside, u, 0).astype(int), 0, columns - 2)
        j = np.clip(np.where(inside, v, 0).astype(int), 0, rows - 2)
        u, v, z = u - i, v - j, self.heights
        low = z[j, i] * (1 - u) + z[j, i + 1] * u
        high = z[j + 1, i] * (1 - u) + z[j + 1, i + 1] * u
        return np.where(inside, low * (1 - v) + high * v, np.nan)


def nodes_of(path: Path, *, centres: bool) -> Nodes:
    """Of an ESRI ASCII grid; its heights lie at cell centres, or at xllcorner, yllcorner on."""
    raster = read_raster(path)
    cell = raster.x[1] - raster.x[0]
    shift = 0.5 * cell if centres else 0.0
    return Nodes(raster.x[0] + shift, raster.y[-1] + shift, cell, raster.heights[::-1])


def plane(slope: float, *, length: float, width: float, cell: float = 1.0) -> Nodes:
    """A plane that falls towards +x by ``slope`` degrees, through the origin near its upper end."""
    x = np.arange(-10.0, length + cell, cell)
    heights = np.tile(-np.tan(np.radians(slope)) * x, (int(2 * width / cell) + 1, 1))
    return Nodes(-10.0, -width, cell, heights)


def steepest(nodes: Nodes, reach: float) -> FloatArray:
    """Largest slope within ``reach`` of each cell, shape [rows, columns]."""
    z = nodes.heights
    along_x = np.abs(np.diff(z, axis=1)) / nodes.cell
    along_y = np.abs(np.diff(z, axis=0)) / nodes.cell
    slope = np.hypot(
        np.maximum(along_x[:-1], along_x[1:]), np.maximum(along_y[:, :-1], along_y[:, 1:])
    )
    for axis in (0, 1):
        count = int(np.ceil(reach / nodes.cell))
        padded = np.pad(slope, [(count, count) if i == axis else (0, 0) for i in (0, 1)])
        windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * count + 1, axis)
        slope = windows.max(axis=-1)
    return slope


def site_of(nodes: Nodes, ground_class: GroundClass, *, reach: float) -> tuple[Site, FloatArray]:
    """A site of one class; and its origin, to be taken from national coordinates, shape [3].

    Args:
        nodes: The ground.
        ground_class: Of all of it.
        reach: Distance within which slopes are bounded [m]; of a rock's size at least.
    """
    rows, columns = nodes.heights.shape
    origin = np.array([np.floor(nodes.x), np.floor(nodes.y), np.floor(np.nanmin(nodes.heights))])
    shape = (rows - 1, columns - 1)
    grid = Grid(nodes.x - origin[0], nodes.y - origin[1], nodes.cell, *shape)
    ground = Ground(
        grid=grid,
        heights=nodes.heights - origin[2],
        facets=None,
        known=np.ones(shape, bool),
        steep=steepest(nodes, reach),
        reach=reach,
    )
    site = Site(
        origin=origin,
        crs="",
        ground=ground,
        classes=(ground_class,),
        class_of=np.zeros(shape, np.int32),
        stands=(),
        stand_of=None,
        trees=None,
        barriers=(),
        results=grid,
    )
    return site, origin


def box(size: Sequence[float]) -> FloatArray:
    """Corners of a box, shape [8, 3]."""
    return np.array(list(product((-0.5, 0.5), repeat=3))) * np.asarray(size)


def chamfered_box(size: Sequence[float]) -> FloatArray:
    """EOTA's test body: edges cut off a quarter deep, 17/24 of the box; shape [24, 3]."""
    corners = np.array(list(product((-1.0, 1.0), repeat=3)))
    outward = [np.where(np.arange(3) == axis, 0.5, 0.25) for axis in range(3)]
    return np.concatenate([corners * along for along in outward]) * np.asarray(size)


def convex_rock(name: str, points: FloatArray, mass: float) -> Rock:
    """The hull of points whose axes are principal, such as boxes; moved to its centre of mass.

    Args:
        name: Of the rock.
        points: All of them corners of the hull, shape [point_count, 3].
        mass: [kg].
    """
    loops = hull_faces(points)
    triangles = np.array([[loop[0], b, c] for loop in loops for b, c in pairwise(loop[1:])])
    sides = np.array([side for loop in loops for side in pairwise([*loop, loop[0]])])
    volume, centre, second = solid(points[triangles])
    covariance = second / volume - np.outer(centre, centre)
    inertia = mass * (np.trace(covariance) - np.diag(covariance))
    corners = points - centre
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    return Rock(name, corners, 0.0, edges, mass, inertia, corners, triangles)


def hull_faces(points: FloatArray) -> list[list[int]]:
    """Corners of each face of a hull, counter-clockwise from outside; of few points.

    Each plane through three points with all others on one side is a face.
    """
    middle = points.mean(axis=0)
    near = 1e-9 * np.ptp(points, axis=0).max()
    faces: dict[frozenset[int], list[int]] = {}
    for a, b, c in combinations(range(len(points)), 3):
        normal = np.cross(points[b] - points[a], points[c] - points[a])
        outward = normal @ (points[a] - middle)
        if abs(outward) < near**3:  # no plane, or one through the middle
            continue
        normal *= np.sign(outward) / np.linalg.norm(normal)
        above = (points - points[a]) @ normal
        if above.max() > near:
            continue
        face = np.flatnonzero(above > -near)
        first = points[face[0]] - points[face].mean(axis=0)
        out = points[face] - points[face].mean(axis=0)
        angle = np.arctan2(out @ np.cross(normal, first), out @ first)
        faces[frozenset(face.tolist())] = face[np.argsort(angle)].tolist()
    return list(faces.values())


def solid(triangles: FloatArray) -> tuple[float, FloatArray, FloatArray]:
    """Volume, centre and second moment of what outward triangles [n, 3, 3] enclose."""
    volume = np.linalg.det(triangles) / 6.0
    total = triangles.sum(axis=1)
    second = np.einsum("n,ni,nj->ij", volume, total, total)
    second += np.einsum("n,nki,nkj->ij", volume, triangles, triangles)
    return volume.sum(), volume @ total / (4.0 * volume.sum()), second / 20.0


def random_orientations(count: int, seed: int) -> FloatArray:
    """Unit quaternions w, x, y, z, uniform over all turns, shape [count, 4]."""
    drawn = np.random.default_rng(seed).normal(size=(count, 4))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


def clear_heights(
    nodes: Nodes, rock: Rock, place: FloatArray, orientation: FloatArray, clearance: float
) -> FloatArray:
    """Heights of the centre at which the nearest vertex is ``clearance`` above the ground [m].

    Args:
        nodes: The ground.
        rock: Of all starts.
        place: x, y of the centres, shape [n, 2].
        orientation: Of the rock, shape [n, 4].
        clearance: Vertical [m].
    """
    arm = np.einsum("nij,vj->nvi", matrix(orientation), rock.vertices)
    under = nodes.at(place[:, None, 0] + arm[..., 0], place[:, None, 1] + arm[..., 1])
    return np.nanmax(under - arm[..., 2], axis=1) + clearance + rock.rounding


def depths(nodes: Nodes, rock: Rock, trace: Sample) -> FloatArray:
    """Vertical depth of the lowest vertex below the ground at each sample, negative above [m].

    Args:
        nodes: The ground.
        rock: That of the trace.
        trace: In the coordinates of the nodes.
    """
    corner = np.einsum("nij,vj->nvi", matrix(trace.orientation), rock.vertices)
    corner += trace.position[:, None]
    return (nodes.at(corner[..., 0], corner[..., 1]) - corner[..., 2]).max(axis=1)


def starts_of(
    position: FloatArray,
    orientation: FloatArray,
    velocity: FloatArray,
    spin: FloatArray,
    *,
    rock: IntArray,
    release: IntArray,
) -> Starts:
    """Starts numbered from 0; arrays as of ``Starts``, positions local."""
    count = len(position)
    return Starts(
        np.arange(count),
        release.astype(np.int32),
        rock.astype(np.int32),
        position,
        orientation,
        np.broadcast_to(velocity, (count, 3)).copy(),
        np.broadcast_to(spin, (count, 3)).copy(),
    )


def fly(site: Site, rocks: Sequence[Rock], method: Method, starts: Starts) -> Flights:
    """Trajectories to their ends."""
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - compiles kernels

    return Trajectories(site, tuple(rocks), method, device="cpu").fly(starts)


def follow(
    site: Site, rocks: Sequence[Rock], method: Method, starts: Starts, every: float
) -> list[Sample]:
    """Trajectories sampled each ``every`` seconds."""
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - compiles kernels

    return Trajectories(site, tuple(rocks), method, device="cpu").follow(starts, every)


def kolmogorov_smirnov(first: FloatArray, second: FloatArray) -> tuple[float, float]:
    """Largest distance of two empirical distributions, and the probability of a larger one.

    The latter is the asymptotic one with the correction for small samples; Stephens (1970),
    doi:10.1111/j.2517-6161.1970.tb00821.x: within .01 from some ten values a sample on.
    """
    a, b = np.sort(first), np.sort(second)
    everywhere = np.concatenate([a, b])
    share_a = np.searchsorted(a, everywhere, side="right") / len(a)
    share_b = np.searchsorted(b, everywhere, side="right") / len(b)
    distance = float(np.abs(share_a - share_b).max())
    root = np.sqrt(len(a) * len(b) / (len(a) + len(b)))
    scaled = (root + 0.12 + 0.11 / root) * distance
    if scaled < 0.2:  # the series alternates without end; the sum is 1 within 1e-10
        return distance, 1.0
    k = np.arange(1, 101)
    tail = 2.0 * float(((-1.0) ** (k - 1) * np.exp(-2.0 * (k * scaled) ** 2)).sum())
    return distance, min(max(tail, 0.0), 1.0)


def band(values: FloatArray) -> str:
    """Median and 10 to 90 % of values, as text."""
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return f"{middle:6.2f} ({low:6.2f} .. {high:6.2f})"
