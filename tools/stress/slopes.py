"""A block on a slope: ten million steps at rest; sliding and sticking at the same settings."""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING

import numpy as np
from rig import Figure, Way, unclean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.simulation import Simulation

G = 9.81
SETTLING = 0.5
"""Time in which a block that has been put down comes to rest [s]."""


def creep(way: Way) -> Iterator[Figure]:
    """A cube at rest on 20 degrees, mu .5, for ten million steps."""
    steps = way.pick(10_000_000, 40_000)
    simulation = _block(way, 20.0, 0.5, "output.energy=false")
    simulation.advance(SETTLING)
    start = simulation.snapshot()
    simulation.advance(simulation.time + steps * simulation.dt)
    shot = simulation.snapshot()
    went = float(np.linalg.norm(shot.position[0] - start.position[0]))
    note = f"{shot.step - start.step} steps of {simulation.dt:.3g} s"
    yield Figure("creep [m]", went, way.gate(1e-9, 1e-6), note)
    yield Figure("speed at the end [m/s]", float(np.linalg.norm(shot.velocity[0])), 1e-9)
    yield Figure("numbers that are not finite", unclean(shot), 0.0)


def slope(way: Way) -> Iterator[Figure]:
    """A block on 20 degrees, .5 s after it was put down: slides with mu .2, sticks with mu .5."""
    angle, end = radians(20.0), way.pick(5.0, 0.5)
    simulation = _block(way, 20.0, 0.2)
    simulation.advance(SETTLING)
    start = simulation.snapshot()
    simulation.advance(SETTLING + end)
    shot = simulation.snapshot()
    # it already slides at the start, at a speed that is known
    begun = shot.time - start.time
    pull = G * (sin(angle) - 0.2 * cos(angle))
    expected = start.velocity[0, 0] * begun + 0.5 * pull * begun**2
    went = shot.position[0, 0] - start.position[0, 0]
    off = abs(went / expected - 1.0)
    yield Figure("mu .2: distance slid, relative", float(off), 1e-3, f"{went:.4g} m")
    simulation = _block(way, 20.0, 0.5)
    simulation.advance(SETTLING)
    start = simulation.snapshot()
    simulation.advance(SETTLING + end)
    shot = simulation.snapshot()
    went = float(np.linalg.norm(shot.position[0] - start.position[0]))
    yield Figure("mu .5: creep [m]", went, 1e-6)


def _block(way: Way, degrees: float, mu: float, *changes: str) -> Simulation:
    """The block on a slope that descends along x, put down where its corners carry it."""
    angle = radians(degrees)
    down = f"gravity.vector={[G * sin(angle), 0.0, -G * cos(angle)]}"
    place = f"body.0.position={[0.0, 0.0, 0.05 - G * cos(angle) / 4e6]}"
    return way.simulation("slope", down, place, f"contact.0.mu={mu}", *changes)
