"""Small stacks: a heavy cube on a light one, soft contacts between hard ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rig import Figure, Way, normal_forces, shots, speed, unclean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.simulation import Simulation

G = 9.81
OVERLAP = 1e-6
REST = 1e-6


def heavy(way: Way) -> Iterator[Figure]:
    """1e6 kg on 1 kg, kn 1e8, put down as deep as it ends up: the light one springs 1000 times."""
    kn, corners = 1e8, 4
    below, above = (mass * G / (corners * kn) for mass in (1e6 + 1.0, 1e6))
    places = (0.5 - below, 1.6 - below - above)
    simulation = way.simulation(
        "heavy", *(f"body.{k}.position=[0.0, 0.0, {z!r}]" for k, z in enumerate(places))
    )
    weights = {(0, 2): (1e6 + 1.0) * G, (0, 1): 1e6 * G}
    yield from _let_go(way, sum((below, above)))
    yield from _at_rest(simulation, way.pick(10.0, 0.3), weights, dict.fromkeys(weights, kn))


def _let_go(way: Way, sinking: float) -> Iterator[Figure]:
    """Put down without overlap; dashpots so strong that the heavy one comes to rest too."""
    strong = [f"contact.{k}.damping_ratio=1000.0" for k in (0, 1)]
    simulation = way.simulation("heavy", *strong, drop="en2")
    (shot,) = shots(simulation, [way.pick(2.0, 0.1)])
    aside = float(np.abs(shot.position[:2, :2]).max())
    yield Figure("let go, zeta 1000: moved aside by [m]", aside, 1e-9)
    if not way.short:
        off = abs((1.6 - float(shot.position[1, 2])) / sinking - 1.0)
        yield Figure("let go, zeta 1000: sinking against m g / K, relative", off, OVERLAP)


def stiff(way: Way) -> Iterator[Figure]:
    """Four blocks, contacts of 1e9 and of 1e5 N/m, put down without overlap."""
    simulation = way.simulation("stiff")
    weights = {(0, 4): 4 * G, (0, 1): 3 * G, (1, 2): 2 * G, (2, 3): G}
    kn = {(0, 4): 1e9, (0, 1): 1e9, (1, 2): 1e5, (2, 3): 1e5}
    yield from _at_rest(simulation, way.pick(3.0, 0.6), weights, kn)


def _at_rest(
    simulation: Simulation,
    end: float,
    weights: dict[tuple[int, int], float],
    kn: dict[tuple[int, int], float],
) -> Iterator[Figure]:
    """Overlaps against the weights above them, rest, and no NaN."""
    (shot,) = shots(simulation, [end])
    carried = normal_forces(shot, kn)
    off = max(abs(carried[pair] / weight - 1.0) for pair, weight in weights.items())
    yield Figure("overlaps against m g / K, relative", off, OVERLAP)
    yield Figure("speed at the end [m/s]", speed(shot, 0.5), REST)
    yield Figure("numbers that are not finite", unclean(shot), 0.0)
