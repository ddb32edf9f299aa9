"""A cube held together by some 8000 bonds, all of which break in one step."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from rig import Figure, Way

if TYPE_CHECKING:
    from collections.abc import Iterator

COUNT = (14, 14, 15)
APART = 0.02
RATE = 1000.0
"""Of the expansion, the same everywhere, so that all bonds are stretched alike [1/s]."""


def bonds(way: Way) -> Iterator[Figure]:
    """The cube flies apart evenly: every bond is stretched beyond its strength by one step."""
    size = way.pick(COUNT, (5, 5, 5))
    tables = _grains(size)
    expected = 3 * np.prod(size) - sum(np.prod(size) // n for n in size)
    simulation = way.simulation("bonded", body=tables)
    start = simulation.snapshot()
    count = len(start.breakage.intact)
    note = f"{count} bonds"
    yield Figure("bonds made, against neighbours", abs(count - int(expected)), 0.0, note)
    simulation.advance(20 * simulation.dt)
    shot = simulation.snapshot()
    broken, account = shot.breakage, shot.energy
    pairs = {tuple(sorted(pair)) for pair in broken.bodies.tolist()}
    yield Figure("bonds left, lost or doubled", int(broken.intact.sum()) + count - len(pairs), 0.0)
    yield Figure("steps in which they broke, less one", len(set(broken.step.tolist())) - 1, 0.0)
    mass = 2500.0 * 4.0 / 3.0 * np.pi * 0.01**3
    drift = mass * np.abs((shot.velocity - start.velocity).sum(axis=0)).max()
    scale = mass * np.abs(start.velocity).sum()
    yield Figure("momentum, relative", float(drift / scale), way.gate(1e-12, 1e-6))
    energy = start.energy.kinetic  # the bonds, stretched by one step, hold 1e-6 of it
    off = abs(broken.released.sum() / account.broken - 1.0)
    yield Figure("released against the account, relative", float(off), 1e-10)
    yield Figure("balance of energies, relative", abs(account.balance) / energy, 1e-10)


def _grains(size: tuple[int, int, int]) -> list[dict[str, Any]]:
    """Balls that just touch, flying away from their middle."""
    middle = 0.5 * APART * (np.array(size) - 1.0)
    places = [APART * np.array(cell, float) - middle for cell in product(*map(range, size))]
    return [
        {
            "shape": "grain",
            "group": "grain",
            "position": place.tolist(),
            "velocity": (RATE * place).tolist(),
        }
        for place in places
    ]
