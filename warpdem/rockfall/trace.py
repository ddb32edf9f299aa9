"""A trajectory as it was sampled in time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.rockfall.samples import Sample

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.rockfall.rock import Rock


@dataclass(frozen=True, eq=False)
class Trace(Sample):
    """The way of one trajectory, the first state at its start and the last at its end.

    Attributes:
        id: Of the trajectory.
        rock: Number of the rock.
    """

    id: int
    rock: int

    def energy(self, rock: Rock) -> FloatArray:
        """Kinetic, of translation and rotation [J], shape [n]."""
        turning = np.einsum("nji,nj->ni", matrix(self.orientation), self.spin)
        moving = rock.mass * (self.velocity**2).sum(axis=1)
        return 0.5 * (moving + (rock.inertia * turning**2).sum(axis=1))
