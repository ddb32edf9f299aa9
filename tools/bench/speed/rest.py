"""Cubes that fall to rest: simulated body-seconds per second of CPU time at the same error.

Each program takes the largest step of its ladder (halved from the coarsest) at which the resting
pile is that of its own eighth of the step: mean height within HEIGHT, and at rest as SPEED says.
What rests has lost its energy, but for its height's. A pile is chaotic: mean heights of runs that
are all right scatter by some 5 mm, so HEIGHT, a tenth of an edge, cannot be much less.
"""

from __future__ import annotations

import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from speed import scenes
from speed.compare import able, verdict
from speed.peers import Run
from speed.peers.engines import engines
from speed.peers.ours import OURS
from speed.peers.yade import YADE_POLYHEDRA
from speed.report import Cell, Table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from speed.peers import Peer, Timing

HEIGHT = 0.01
"""Largest difference of the mean heights of two piles that count as the same [m]; cubes are .1."""
SPEED = 0.01
"""Root mean square speed below which a pile is at rest [m/s]; it has fallen at some 3 m/s."""
FINER = 8
COLUMNS = (
    "program",
    "dt [s]",
    "chosen on",
    "height [m]",
    "at dt/8",
    "speed left [m/s]",
    "contacts",
    "body-s per CPU s",
    "warpdem's ratio",
    "target",
    "",
)
TARGETS = {"YADE polyhedra": 30.0}
DIFFERS = (
    "125 cubes of edge .1 m and density 2500, turned at random, fall for 2 s into a box of five "
    "planes; mu .5. warpdem: springs of 1e6 N/m, rounding .01, en2 .1. YADE: sharp cubes, forces "
    "by overlap volume, numerical damping .3 as in its examples; its step is chosen on fewer "
    "cubes, for it is slow. MuJoCo: sharp, soft constraints of two steps, elliptic cones. "
    "PyBullet: 50 iterations of impulses. The latter two do not resolve impacts in time: no "
    "elastic waves, no chosen restitution."
)


@dataclass(frozen=True)
class Engine:
    """A program and how its step is chosen.

    Attributes:
        peer: The program.
        coarsest: Largest step tried [s].
        columns: Side of the cubic lattice on which the step is chosen.
    """

    peer: Peer
    coarsest: float
    columns: int = 5


def every(python: str) -> tuple[Engine, ...]:
    """All of them; ``python`` has MuJoCo and PyBullet."""
    mujoco, pybullet = engines(python)
    return (
        Engine(OURS, 8e-4),
        Engine(YADE_POLYHEDRA, 1.6e-3, columns=2),
        Engine(mujoco, 2e-2),
        Engine(pybullet, 1.6e-2),
    )


def same(one: Timing, other: Timing) -> bool:
    """Whether a pile rests and is the other."""
    apart = abs(one.facts["height"] - other.facts["height"])
    return apart <= HEIGHT and one.facts["speed_rms"] <= SPEED  # false of nan


def largest_step(
    pile: Callable[[float], Timing | None], coarsest: float, *, tries: int = 8
) -> float | None:
    """Largest of the steps coarsest / 2^k whose pile is that of its eighth [s].

    Args:
        pile: The run with a step; None where it failed.
        coarsest: First step tried [s].
        tries: How many.
    """
    for k in range(tries):
        dt = coarsest / 2**k
        one = pile(dt)
        if one is None or not math.isfinite(one.facts["height"]):
            continue
        if one.facts["speed_rms"] > SPEED:
            continue
        finer = pile(dt / FINER)
        if finer is not None and same(one, finer):
            return dt
    return None


def fallen(peer: Peer, columns: int, dt: float, duration: float) -> Timing | None:
    """A whole fall with a step; None, and why, where the program gave up."""
    problem = scenes.tower(columns**3, columns).stepped(dt)
    with tempfile.TemporaryDirectory() as place:
        try:
            timing = peer.timed(Run(problem, Path(place), 1, 0, round(duration / dt)))
        except RuntimeError as fault:
            print(f"{peer.name} at dt {dt:g}: {fault}", file=sys.stderr)
            return None
    print(f"{peer.name}, {columns**3} cubes, dt {dt:g}: {timing}", file=sys.stderr, flush=True)
    return timing


def to_rest(python: str, *, duration: float = 2.0, columns: int = 5) -> Table:
    """The table of all programs that can run; ``columns``^3 cubes fall."""
    all_of = every(python)
    present, skipped = able([engine.peer for engine in all_of])
    rows, ours = [], None
    for engine in all_of:
        if engine.peer not in present:
            continue
        row, speed = _measured(engine, min(engine.columns, columns), columns, duration)
        ours = ours or speed
        rows.append(_judged(row, speed, ours))
    bound = f"same pile: mean heights within {HEIGHT:g} m and at rest within {SPEED:g} m/s"
    return Table(
        f"{columns**3} cubes fall to rest, one thread each",
        COLUMNS,
        tuple(rows),
        (bound, DIFFERS, *skipped),
        ("program", "body-s per CPU s", "program"),
    )


def _measured(
    engine: Engine, few: int, columns: int, duration: float
) -> tuple[list[Cell], float | None]:
    """First cells of a row, and simulated body-seconds per second of CPU time."""
    known: dict[float, Timing | None] = {}

    def pile(dt: float) -> Timing | None:
        if dt not in known:
            known[dt] = fallen(engine.peer, few, dt, duration)
        return known[dt]

    dt = largest_step(pile, engine.coarsest)
    if few == columns or dt is None:
        found, finer = (known[dt], known[dt / FINER]) if dt else (None, None)
    else:
        dt, found = _at_rest(engine.peer, columns, dt, duration)
        finer = None
    row = [engine.peer.name, dt, f"{few**3} cubes"]
    if dt is None or found is None:
        return row, None
    facts = found.facts
    row += [facts["height"], finer and finer.facts["height"], facts["speed_rms"], facts["contacts"]]
    return row, simulated(found, dt)


def _at_rest(
    peer: Peer, columns: int, dt: float, duration: float
) -> tuple[float | None, Timing | None]:
    """The largest of dt, dt/2 and dt/4 [s] with which all cubes come to rest, and that run."""
    for step in (dt, 0.5 * dt, 0.25 * dt):
        found = fallen(peer, columns, step, duration)
        if found is not None and found.facts["speed_rms"] <= SPEED:
            return step, found
    return None, None


def simulated(timing: Timing, dt: float) -> float:
    """Body-seconds per second of CPU time."""
    return timing.bodies * timing.steps * dt / (timing.cpu or timing.wall)


def _judged(row: Sequence[Cell], speed: float | None, ours: float | None) -> tuple[Cell, ...]:
    """A row's cells filled up with speed, ratio and target."""
    name = str(row[0])
    own = name == OURS.name
    ratio = ours / speed if ours and speed and not own else None
    target = TARGETS.get(name)
    filled = [*row, *[None] * (COLUMNS.index("body-s per CPU s") - len(row))]
    return (*filled, speed, ratio, target, verdict(ratio, target))
