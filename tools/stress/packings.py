"""Many bodies: thin ones that fall, a packing that is repeated, a drum that turns for long."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from rig import Figure, Way, shots, unclean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.simulation import Simulation

LOOKS = 100


def needles(way: Way) -> Iterator[Figure]:
    """Two hundred needles 1 x .01 x .01 m and fifty plates 1 x 1 x .01 m dropped on a floor."""
    count, end = way.pick((250, 0.9), (30, 0.15))
    simulation = way.simulation("needles", f"fill.0.count={count}", *_low(way))
    start = simulation.snapshot().energy
    begun = start.kinetic + start.potential + start.elastic
    gained, length = -np.inf, 0.0
    for shot in shots(simulation, np.linspace(0.0, end, LOOKS + 1)[1:]):
        energy = shot.energy
        now = energy.kinetic + energy.potential + energy.elastic
        gained = max(gained, (now - begun) / begun)
        length = max(length, float(np.abs(np.linalg.norm(shot.orientation, axis=1) - 1.0).max()))
    lost = 1.0 - now / begun
    note = f"{simulation.body_count} bodies, {shot.step} steps, {lost:.2f} lost at the end"
    yield Figure("energy above that of the start, relative", gained, 1e-3, note)
    yield Figure("length of quaternions, off one by", length, 1e-12)
    yield Figure("numbers that are not finite", unclean(shot), 0.0)


def _low(way: Way) -> list[str]:
    """Changes that bring a few bodies near the floor, to land soon."""
    if not way.short:
        return []
    region = "{ min = [-4.0, -4.0, 0.0], max = [4.0, 4.0, 1.7] }"
    return [f"fill.0.region={region}", "fill.0.velocity=[0.0, 0.0, -3.0]"]


def packing(way: Way) -> Iterator[Figure]:
    """Two thousand blocks, twice with different host threads; then all moved by 1e-12 m."""
    count, end = way.pick((2000, 3.0), (100, 0.25))
    first = _packed(way, count, end, threads=1)
    again = _packed(way, count, end, threads=2)
    moved = _packed(way, count, end, threads=1, by=1e-12)
    one, two, other = (simulation.snapshot() for simulation in (first, again, moved))
    words = ("position", "orientation", "velocity", "spin")
    differ = sum(np.count_nonzero(getattr(one, w) != getattr(two, w)) for w in words)
    note = f"{first.body_count} bodies, {one.step} steps"
    yield Figure("numbers that differ in a second run", float(differ), 0.0, note)
    free = slice(-count, None)
    # the planes come first
    heights = [float(shot.position[free, 2].mean()) for shot in (one, other)]
    apart = float(np.abs(one.position[free] - other.position[free]).max())
    note = f"a body ends up to {apart:.2g} m from where it was"
    off = abs(heights[1] / heights[0] - 1.0)
    yield Figure("bulk height after a shift of 1e-12 m, relative", off, 1e-2, note)
    if not way.short:
        fast = np.sqrt((one.velocity[free] ** 2).sum(axis=1).mean())
        yield Figure("speed of the bodies by then, rms [m/s]", float(fast), 0.05)


def _packed(way: Way, count: int, end: float, *, threads: int, by: float = 0.0) -> Simulation:
    """The packing at its end; all the bodies may start a little aside."""
    changes = [f"fill.0.count={count}"]
    if by:
        changes += [f"body.{k}.position={_aside(way, k, by)}" for k in range(5)]
    if way.short:
        region = "{ min = [-0.25, -0.25, 0.0], max = [0.25, 0.25, 1.4] }"
        changes += [f"fill.0.region={region}"]
    simulation = way.simulation("packing", *changes, threads=threads)
    simulation.advance(end)
    return simulation


def _aside(way: Way, body: int, by: float) -> list[float]:
    """Where a wall stands when it has been moved: all bodies as against the walls."""
    return [float(x) - by for x in way.scene("packing").body[body].position]


def drum(way: Way) -> Iterator[Figure]:
    """Sixteen blocks in a turning drum for a million steps: what friction does to the energy."""
    steps = way.pick(1_000_000, 3000)
    simulation = way.simulation("drum")
    marks = []
    for share in np.linspace(0.0, 1.0, 11)[1:]:
        simulation.advance(steps * float(share) * simulation.dt)
        marks.append(simulation.snapshot())
    worst = min(b.energy.friction - a.energy.friction for a, b in pairwise(marks))
    shot = marks[-1]
    work = shot.energy.work
    note = f"{shot.step} steps, {work:.3g} J of work, {shot.energy.friction / work:.2f} by friction"
    gained = max(shot.energy.balance / work, 0.0)
    yield Figure("energy that appeared, over the work", gained, 1e-3, note)
    half = marks[len(marks) // 2 - 1]
    late = abs(shot.energy.balance - half.energy.balance) / (work - half.energy.work)
    # after the blocks have fallen
    yield Figure("unaccounted in the second half, over its work", late, 1e-3)
    yield Figure("what friction gave back in a tenth of the time [J]", max(-worst, 0.0), 0.0)
    moving = max(mark.energy.kinetic / half.energy.kinetic for mark in marks[len(marks) // 2 :])
    yield Figure("kinetic energy, over that half-way", float(moving), 10.0)
    yield Figure("numbers that are not finite", unclean(shot), 0.0)
