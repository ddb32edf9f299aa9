"""Random feature pairs through the device functions of the narrow phase, against a reference.

Each kind of pair (vertex-vertex, vertex-edge, edge-edge, vertex-face) is drawn with lengths from a
millimetre to a kilometre; half are near a degenerate case: parallel or crossing edges, a vertex
over a corner or a border, coincident points. What must hold of an admissible pair: gap = distance
of the two features less the roundings; the contact point lies half the gap from both; the normal is
a unit vector. Of one that is not admissible: an end of the edge, or a border of the face, is as
near as the feature itself, so that no contact is lost. Edges within 1e-5 rad of parallel are left
to their ends: these may be farther by as much of their length.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import solids
import warp as wp
from faces import Prisms
from reference import hull_distance
from warpdem.kernels.narrow import between, edge_edge, vertex_edge
from warpdem.kernels.precision import real, vec3

if TYPE_CHECKING:
    import argparse
    from pathlib import Path

VV, VE, EV, EE = range(4)
NAMES = ("vertex-vertex", "vertex-edge", "edge-vertex", "edge-edge")
FAR_AWAY = 1e9
ERROR = 1e-9
"""Largest error of a gap or a contact point over the size of the pair [-]."""
PARALLEL = 1e-5
"""Angle below which edges are left to their ends [rad]."""
RULES = ("sum", "pnorm")
"""Of run.partnership, under which whole solids are looked at."""
BATCH = 20_000


@wp.kernel(enable_backward=False)
def segments(
    kind: wp.array(dtype=wp.int32),
    points: wp.array2d(dtype=vec3),
    radius: wp.array2d(dtype=real),
    gap: wp.array(dtype=real),
    outside: wp.array(dtype=real),
    normal: wp.array(dtype=vec3),
    point: wp.array(dtype=vec3),
):
    """Pairs without faces; a vertex is the first of its two points."""
    k = wp.tid()
    a = points[k, 0]
    b = points[k, 2]
    ra = radius[k, 0]
    rb = radius[k, 1]
    far = real(FAR_AWAY)
    hit = between(a, b, ra, rb, far, real(0.0))
    if kind[k] == 1:
        hit = vertex_edge(a, b, points[k, 3], real(1.0), ra, rb, far, True)
    if kind[k] == 2:
        hit = vertex_edge(b, a, points[k, 1], real(-1.0), rb, ra, far, True)
    if kind[k] == 3:
        hit = edge_edge(a, points[k, 1], b, points[k, 3], ra, rb, far, True)
    gap[k] = hit.gap
    outside[k] = hit.outside
    normal[k] = hit.normal
    point[k] = hit.point


def draw(random: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Kinds, four points and two roundings of so many pairs, shapes [n], [n, 4, 3], [n, 2]."""
    kind = random.integers(0, 4, count)
    length = 10.0 ** random.uniform(-3.0, 3.0, count)[:, None]
    ratio = 10.0 ** random.uniform(-2.0, 2.0, count)[:, None]
    along, other = _units(random, count), _units(random, count)
    near = random.random(count)[:, None] < 0.5
    # within 1e-12 to .1 rad of parallel
    tilt = 10.0 ** random.uniform(-12.0, -1.0, count)[:, None]
    other = np.where(near, along + tilt * other, other)
    a = random.normal(size=(count, 3)) * length
    # where the other one begins: over a share of the first, or exactly over an end of it
    share = random.choice([0.0, 1.0, 0.5, -0.1, 1.1], count)[:, None]
    share = np.where(near, share, random.uniform(-0.5, 1.5, count)[:, None])
    aside = 10.0 ** random.uniform(-6.0, 0.0, count)[:, None] * np.cross(
        along, _units(random, count)
    )
    b = a + length * (share * along + np.where(random.random(count)[:, None] < 0.1, 0.0, aside))
    back = random.choice([0.0, 0.5, 1.0], count)[:, None] * length * ratio * other
    points = np.stack([a, a + length * along, b - back, b - back + length * ratio * other], axis=1)
    return kind, points, 10.0 ** random.uniform(-3.0, -1.0, (count, 2)) * length


def _units(random: np.random.Generator, count: int) -> np.ndarray:
    vectors = random.normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def hits(kind: np.ndarray, points: np.ndarray, radius: np.ndarray) -> tuple[np.ndarray, ...]:
    """Gap, outside, normal and point of each pair by the device functions."""
    count = len(kind)
    out = [wp.zeros(count, dtype=t, device="cpu") for t in (real, real, vec3, vec3)]
    given = [
        wp.array(kind.astype(np.int32), dtype=wp.int32, device="cpu"),
        wp.array(points, dtype=vec3, device="cpu"),
        wp.array(radius, dtype=real, device="cpu"),
    ]
    wp.launch(segments, dim=count, inputs=given, outputs=out, device="cpu")
    return tuple(array.numpy() for array in out)


def ends(kind: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points whose hulls the two features of a pair are."""
    return (
        points[0:2] if kind in {EV, EE} else points[0:1],
        points[2:4] if kind in {VE, EE} else points[2:3],
    )


def parts(kind: int, points: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Pairs of which one is the nearest where the pair itself is not admissible."""
    first, second = ends(kind, points)
    if kind == EE:
        return [*((p[None], second) for p in first), *((first, p[None]) for p in second)]
    return [(p[None], q[None]) for p in first for q in second]


def fault_of(
    first: np.ndarray,
    second: np.ndarray,
    others: list[tuple[np.ndarray, np.ndarray]],
    radius: np.ndarray,
    hit: tuple[Any, ...],
) -> str:
    """What is wrong with a hit of the hulls of two sets of points; empty where nothing is."""
    size = float(np.ptp(np.concatenate([first, second]), axis=0).max()) + float(radius.sum())
    distance = hull_distance(first, second)
    if hit[1] > 0.0:
        lost = min(hull_distance(*pair) for pair in others) - distance if others else np.inf
        allowed = PARALLEL if _parallel(first, second) else ERROR
        return f"lost: {lost / size:.2e} nearer than its ends" if lost > allowed * size else ""
    error = abs(hit[0] + radius.sum() - distance) / size
    if error > ERROR:
        return f"gap wrong by {error:.2e} of the size"
    return _misplaced(first, second, radius, hit, size) if distance > ERROR * size else ""


def _parallel(first: np.ndarray, second: np.ndarray) -> bool:
    """Whether two edges are so nearly parallel that they are left to their ends."""
    if len(first) != 2 or len(second) != 2:
        return False
    units = [(hull[1] - hull[0]) / np.linalg.norm(hull[1] - hull[0]) for hull in (first, second)]
    return float(np.linalg.norm(np.cross(*units))) <= 1.001 * PARALLEL


def _misplaced(
    first: np.ndarray, second: np.ndarray, radius: np.ndarray, hit: tuple[Any, ...], size: float
) -> str:
    """Whether the normal is a unit vector, and leads from the contact point to both cores."""
    gap, _, normal, point = hit
    if abs(float(normal @ normal) - 1.0) > ERROR:
        return "normal is no unit vector"
    core = point + normal * (radius[0] + 0.5 * gap), point - normal * (radius[1] + 0.5 * gap)
    sides = zip(core, (first, second), strict=True)
    miss = max(hull_distance(p[None], hull) / size for p, hull in sides)
    return f"contact point wrong by {miss:.2e} of the size" if miss > ERROR else ""


def main(asked: argparse.Namespace) -> int:
    """The command: number of failures."""
    failures = fuzz(asked.count, asked.seed, asked.out)
    count = max(asked.count // 500, 1)
    found = [f for rule in RULES for f in solids.faults(count, asked.seed, partnership=rule)]
    print(f"{count} pairs of solids, rules {', '.join(RULES)}: {len(found)} failures")
    print("\n".join(f"  {fault}" for fault in found))
    return failures + len(found)


def fuzz(count: int, seed: int, folder: Path) -> int:
    """Examine so many pairs of all kinds; the number of failures."""
    wp.config.quiet = True
    random = np.random.default_rng(seed)
    faces = count // 4
    counts: Counter[str] = Counter()
    failures = 0
    for first in range(0, count - faces, BATCH):
        kind, points, radius = draw(random, min(BATCH, count - faces - first))
        found = hits(kind, points, radius)
        for k in range(len(kind)):
            hit = tuple(values[k] for values in found)
            counts[f"{NAMES[kind[k]]}, {'outside' if hit[1] else 'admissible'}"] += 1
            sets = ends(kind[k], points[k])
            told = fault_of(*sets, parts(kind[k], points[k]), radius[k], hit)
            failures += _keep(folder, told, NAMES[kind[k]], failures, points[k], radius[k], hit)
    prisms = Prisms(random)
    for first in range(0, faces, BATCH):
        for name, told, case in prisms.examine(random, min(BATCH, faces - first), fault_of):
            counts[f"vertex-face, {name}"] += 1
            failures += _keep(folder, told, "vertex-face", failures, *case) if told else 0
    print(f"{count} feature pairs (seed {seed}), {failures} failures:")
    for name, times in sorted(counts.items()):
        print(f"  {times:6d} {name}")
    return failures


def _keep(folder: Path, told: str, name: str, failures: int, *case: Any) -> int:
    """Write down one of the first failures."""
    if told and failures < 20:
        folder.mkdir(parents=True, exist_ok=True)
        with np.printoptions(precision=17):
            text = "\n".join(map(repr, case))
        (folder / f"features-{failures}.txt").write_text(f"{name}: {told}\n{text}\n")
        print(f"  {name}: {told}", flush=True)
    return int(bool(told))
