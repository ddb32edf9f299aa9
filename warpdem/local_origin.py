"""A local origin: far from that of the scene a body's place has too few digits to move by a step.

At national map coordinates, 2.6e6 m, neighbouring numbers are 5e-10 m apart, and each step rounds.
So the device sees places from an origin near the bodies, and snapshots show them where they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.input.scene import Scene
    from warpdem.model import Model
    from warpdem.snapshot import Snapshot

GRID = 1024.0
"""Local origins are multiples of this [m]: a power of two, so that subtracting one rounds nothing;
scenes nearer than half of it keep their own."""


def of(scene: Scene, placement: Placement) -> FloatArray:
    """The local origin of a scene, near the middle of its free bodies [m], shape [3].

    Zero with a periodic cell or a fluid, whose own places stay as the scene gives them.
    """
    free = placement.position[~placement.fixed]
    fluid = any(force.kind == "fluid" for force in scene.force)
    if not len(free) or scene.cell is not None or fluid:
        return np.zeros(3)
    middle = 0.5 * (free.min(axis=0) + free.max(axis=0))
    return GRID * np.round(middle / GRID)


def moved(scene: Scene, placement: Placement, origin: FloatArray) -> tuple[Scene, Placement]:
    """The axes of drivers, and the bodies, as seen from a local origin [m], shape [3]."""
    if not origin.any():
        return scene, placement
    drivers = tuple(
        driver.model_copy(update={"point": tuple(np.array(point) - origin)})
        if (point := getattr(driver, "point", None)) is not None
        else driver
        for driver in scene.driver
    )
    there = scene.model_copy(update={"driver": drivers})
    return there, replace(placement, position=placement.position - origin)


def shown(shot: Snapshot, origin: FloatArray, model: Model) -> Snapshot:
    """A snapshot with places and potential energy as of the scene's own origin."""
    if not origin.any():
        return shot
    contacts, energy = shot.contacts, shot.energy
    if contacts is not None:
        contacts = replace(contacts, point=contacts.point + origin)
    if energy is not None:
        lift = float(model.mass[model.free].sum() * (model.gravity @ origin))
        energy = replace(energy, potential=energy.potential - lift)
    return replace(shot, position=shot.position + origin, contacts=contacts, energy=energy)
