"""Far from the origin; nothing, one body, a million of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from rig import Figure, Way, turn, unclean

from warpdem.checks.check import check

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.snapshot import Snapshot

FAR = (1e3, 2.6e6)
MEMORY = 0.1
"""How well memory is to be foreseen, relative, once the lists' lengths are known."""


def far(way: Way) -> Iterator[Figure]:
    """One scene at the origin, 1e3 and 2.6e6 m away along x and y."""
    end = way.pick(1.0, 0.3)
    here = _moved(way, 0.0, end)
    for by in FAR:
        there = _moved(way, by, end)
        off = np.abs(there.position - here.position - [by, by, 0.0]).max()
        yield Figure(f"{by:g} m away: places [m]", float(off), way.gate(1e-9, 1e-4))
        angle = turn(there.orientation[0], here.orientation[0])
        yield Figure(f"{by:g} m away: orientation [rad]", angle, way.gate(1e-8, 1e-3))


def _moved(way: Way, by: float, end: float) -> Snapshot:
    bodies = way.scene("far").body
    places = [[x + by for x in body.position[:2]] + [body.position[2]] for body in bodies]
    changes = [f"body.{k}.position={[float(x) for x in place]}" for k, place in enumerate(places)]
    simulation = way.simulation("far", *changes)
    simulation.advance(end)
    return simulation.snapshot()


def sizes(way: Way) -> Iterator[Figure]:
    """Scenes of no body, of one, of a million without contact."""
    for what, changes in (("nothing", ["body=[]"]), ("one body", [])):
        simulation = way.simulation("free", "run.duration=1.0", "run.dt=1e-2", *changes)
        simulation.advance(1.0)
        shot = simulation.snapshot(contacts=True)
        yield Figure(
            f"{what}: steps not done, numbers not finite",
            abs(simulation.step_count - 100) + unclean(shot),
            0.0,
        )
    count = way.pick(1_000_000, 20_000)
    scene = way.scene("crowd", f"fill.0.count={count}")
    foreseen = check(scene).memory
    simulation = way.simulation("crowd", f"fill.0.count={count}")
    start = simulation.snapshot()
    simulation.advance(10 * simulation.dt)
    shot = simulation.snapshot()
    yield Figure(f"{count} bodies: missing", float(count - simulation.body_count), 0.0)
    fall = -9.81 * simulation.dt**2 * 50.0
    off = float(np.abs(shot.position - start.position - [0.0, 0.0, fall]).max())
    yield Figure(f"{count} bodies: place after ten steps [m]", off, 1e-15)
    # half as many: what one more body takes, whatever the lists are
    half = way.simulation("crowd", f"fill.0.count={count // 2}")
    half.advance(10 * half.dt)
    taken = _held(simulation)
    each = (taken - _held(half)) / (count - count // 2)
    sizes_of = foreseen.sizes["body"] + foreseen.sizes.get("vertex", 0)
    note = f"{each:.0f} B a body, {taken / 1e6:.4g} MB of the {foreseen.total / 1e6:.4g} of a heap"
    yield Figure(
        f"{count} bodies: memory of one against the foreseen, relative",
        abs(each / sizes_of - 1.0),
        MEMORY,
        note,
    )
    yield Figure(f"{count} bodies: memory over that foreseen", taken / foreseen.total, 1.0 + MEMORY)


def _held(thing: Any) -> int:
    """Bytes of all arrays on the device that an object holds, each once."""
    found: dict[int, int] = {}
    seen: set[int] = set()
    left = [thing]
    while left:
        here = left.pop()
        if id(here) in seen:
            continue
        seen.add(id(here))
        if hasattr(here, "ptr") and hasattr(here, "capacity"):
            found[here.ptr] = here.capacity
        elif isinstance(here, list | tuple):
            left += here
        elif hasattr(here, "_cls"):
            left += [getattr(here, name) for name in here._cls.vars]  # noqa: SLF001 - a Warp struct
        elif type(here).__module__.startswith("warpdem"):
            left += vars(here).values() if hasattr(here, "__dict__") else []
    return sum(found.values())
