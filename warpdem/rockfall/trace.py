"""A trajectory as it was sampled in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.rockfall.rock import Rock


@dataclass(frozen=True, eq=False)
class Trace:
    """States of one rock, the first at its start and the last at its end; local coordinates.

    Attributes:
        id: Of the trajectory.
        rock: Number of the rock.
        time: Rising [s], shape [n].
        position: Of the centre of mass [m], shape [n, 3].
        orientation: Unit quaternions w, x, y, z from the principal frame to the world, shape
            [n, 4].
        velocity: [m/s], shape [n, 3].
        spin: [rad/s], world axes, shape [n, 3].
        contact: Whether it touched the ground, shape [n].
    """

    id: int
    rock: int
    time: FloatArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    contact: BoolArray

    def energy(self, rock: Rock) -> FloatArray:
        """Kinetic, of translation and rotation [J], shape [n]."""
        turning = np.einsum("nji,nj->ni", matrix(self.orientation), self.spin)
        moving = rock.mass * (self.velocity**2).sum(axis=1)
        return 0.5 * (moving + (rock.inertia * turning**2).sum(axis=1))
