"""Towers of cubes: at rest, and at steps around the limit of stability."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from balance import at_rest, largest_step
from rig import Figure, Way, normal_forces, refusal, shots, unclean

from warpdem.errors import UnstableError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.simulation import Simulation
    from warpdem.snapshot import Snapshot

MASS, KN, KT, G = 1000.0, 1e9, 8e8, 9.81
MOMENT = MASS / 6.0
CORNERS = 4
YAW = 1e-6
"""Of cubes that are not quite aligned, rms [rad]: edges of two faces cross where they like."""
OFFSET = 0.1
"""Of every second cube of a tower that is not aligned, along x and y [m]."""


def tower(way: Way) -> Iterator[Figure]:
    """Fifty cubes: aligned, almost so, and every second one .1 m aside along x and y."""
    count, end = way.pick((50, 10.0), (10, 0.1))
    poses = {"aligned": {}, "within 1e-6 rad": {"yaw": YAW}, "offset": {"offset": OFFSET}}
    for what, pose in poses.items():
        simulation = _pile(way, count, **pose)
        # cubes askew settle against their friction by a part of their angle
        twist = 0.1 * YAW if "yaw" in pose else 1e-9
        yield from _standing(simulation, count, end, what, drift=1e-6, twist=twist)


def ten(way: Way) -> Iterator[Figure]:
    """Ten aligned cubes for 5 s, where nothing but rounding could move them."""
    yield from _standing(_pile(way, 10), 10, way.pick(5.0, 0.2), "aligned", drift=1e-12, twist=1e-9)


def _standing(
    simulation: Simulation, count: int, end: float, what: str, *, drift: float, twist: float
) -> Iterator[Figure]:
    """How far a tower goes and turns, looked at ten times, and what its contacts carry."""
    start = simulation.snapshot(contacts=True)
    assert start.contacts
    moved = turned = changes = 0.0
    last = shot = start
    for shot in shots(simulation, np.linspace(0.0, end, 11)[1:]):
        moved = max(moved, float(np.abs(shot.position - start.position)[:count].max()))
        turned = max(turned, float(2.0 * np.abs(_yaw(shot) - _yaw(start)).max()))
        changes += len(shot.contacts.gap) != len(last.contacts.gap)
        last = shot
    note = f"{len(shot.contacts.gap) / count:.1f} sub-contacts a face, {changes:.0f} changes seen"
    yield Figure(f"{what}: a cube moved by [m]", moved, drift, note)
    yield Figure(f"{what}: a cube turned about the vertical by [rad]", turned, twist)
    weights = {(k - 1, k): (count - k) * MASS * G for k in range(1, count)}
    weights[0, count] = count * MASS * G
    loads = _loads(simulation)
    off = max(abs(loads[pair] / weight - 1.0) for pair, weight in weights.items())
    yield Figure(f"{what}: loads against m g, relative", off, 1e-6)
    # crossing edges carry less than kn d where an end of theirs overlaps too
    if not what.startswith("within"):
        carried = normal_forces(shot, dict.fromkeys(weights, KN))
        off = max(abs(carried[pair] / weight - 1.0) for pair, weight in weights.items())
        yield Figure(f"{what}: overlaps against m g / K, relative", off, 1e-6)
    yield Figure(f"{what}: numbers that are not finite", unclean(shot), 0.0)


def _loads(simulation: Simulation) -> dict[tuple[int, int], float]:
    """Vertical force between each two bodies near each other, the lower number first [N]."""
    _, _, lists = simulation.parts
    pairs, count = lists.pairs, lists.pair_count
    bodies = zip(pairs.owner.numpy()[:count], pairs.partner.numpy()[:count], strict=True)
    forces = np.abs(pairs.force.numpy()[:count, 2])
    ordered = [(int(min(pair)), int(max(pair))) for pair in bodies]
    return dict(zip(ordered, forces.tolist(), strict=True))


def _yaw(shot: Snapshot) -> np.ndarray:
    """Half of the small turns about the vertical, shape [body_count]."""
    w, _, _, z = shot.orientation.T
    return z / w


def limit(way: Way) -> Iterator[Figure]:
    """Fifty cubes on four corners each: steps of 2^-12 to 2^3 of the bound, no damping."""
    count, steps = way.pick((50, 3000), (20, 300))
    simulation = _corners(way, count, "auto")
    exact = largest_step(simulation.snapshot(contacts=True), MASS, MOMENT, KN, KT)
    unit = (MASS / KN) ** 0.5
    yield Figure(
        "exact limit against .3229 sqrt(m/kn), relative", abs(exact / unit / 0.3229 - 1), 0.01
    )
    bound = simulation.step_bound()
    yield Figure("bound over the exact limit", bound / exact, 1.0)
    yield Figure("exact limit over the bound", exact / bound, 1.0 / 0.85)
    powers = way.pick(range(-12, 1), (-12, -4, -1, 0))
    worst = max(_growth(way, count, bound * 2.0**k, steps) for k in powers)
    yield Figure("speeds grow by, steps of 2^-12 .. 1 of the bound", worst, 10.0)
    for k in way.pick((1, 2, 3), (1, 3)):
        refused = refusal(lambda k=k: _corners(way, count, bound * 2.0**k))
        growth = np.inf if refused else _growth(way, count, bound * 2.0**k, steps)
        note = "refused when read" if refused else ""
        yield Figure(f"one over what they grow by, step 2^{k} of it", 1.0 / growth, 1e-3, note)
    low, high = 1.0, 1.1
    yield Figure(
        "speeds grow by, step .999 of the exact limit",
        _growth(way, count, 0.999 * exact, steps),
        10.0,
    )
    for _ in range(way.pick(6, 3)):
        middle = 0.5 * (low + high)
        stable = _growth(way, count, middle * exact, steps) < 1e3
        low, high = (middle, high) if stable else (low, middle)
    yield Figure("it blows up at, over the exact limit", high, 1.1)


def _growth(way: Way, count: int, dt: float, steps: int) -> float:
    """By how much the greatest speed has grown after so many steps, at least 1."""
    simulation = _corners(way, count, dt)
    start = np.abs(simulation.snapshot().velocity).max()
    try:
        simulation.advance(steps * dt)
    except UnstableError:
        return np.inf
    return max(1.0, float(np.abs(simulation.snapshot().velocity).max() / start))


def _corners(way: Way, count: int, dt: float | str) -> Simulation:
    """A tower of wide cubes and others in turn, shaken a little, without damping or slip."""
    random = np.random.default_rng(1)
    tables = _bodies(*_column(count, CORNERS * KN), shapes=("wide", "cube"))
    for table in tables:
        table |= {
            "velocity": (1e-6 * random.normal(size=3)).tolist(),
            "spin": (1e-6 * random.normal(size=3)).tolist(),
        }
    stick = [f"contact.{k}.{word}" for k in (0, 1) for word in ("en2=1.0", "mu=1e6")]
    step = f'run.dt="{dt}"' if isinstance(dt, str) else f"run.dt={dt!r}"
    return _with_floor_last(way, tables, *stick, step)


def _pile(way: Way, count: int, *, offset: float = 0.0, yaw: float = 0.0) -> Simulation:
    """A tower that has been put down where its contacts carry it."""
    position, orientation = _column(count, CORNERS * KN, offset)
    orientation[:, 3] = 0.5 * yaw * np.random.default_rng(2).normal(size=count)

    def make(position: np.ndarray, orientation: np.ndarray) -> Simulation:
        return _with_floor_last(way, _bodies(position, orientation))

    return make(*at_rest(make, position, orientation, KN, KT))


def _column(count: int, stiffness: float, offset: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Cubes on top of each other, each as deep in the one below as what lies above presses it."""
    overlaps = MASS * G * np.arange(count, 0, -1) / stiffness
    aside = offset * (np.arange(count) % 2)
    height = np.arange(count) + 0.5 - np.cumsum(overlaps)
    orientation = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    return np.column_stack([aside, aside, height]), orientation


def _bodies(
    position: np.ndarray, orientation: np.ndarray, shapes: Sequence[str] = ("cube",)
) -> list[dict[str, Any]]:
    """Tables of cubes of so many shapes in turn."""
    return [
        {
            "name": f"cube {k}",
            "shape": shapes[k % len(shapes)],
            "group": "cube",
            "density": MASS,
            "position": x.tolist(),
            "orientation": q.tolist(),
        }
        for k, (x, q) in enumerate(zip(position, orientation, strict=True))
    ]


def _with_floor_last(way: Way, tables: list[dict[str, Any]], *changes: str) -> Simulation:
    """The scene with the cubes before its floor: they are bodies 0, 1 ..."""
    floor = way.scene("tower").body[0].model_dump(exclude_unset=True)
    return way.simulation("tower", *changes, "body=[]", body=[*tables, floor])
