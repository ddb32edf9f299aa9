"""How stiff the bonds hold each body: what bounds the time step before the first one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.bonds.creation import Interfaces
    from warpdem.filling.placement import Placement


def stiffest(
    made: Interfaces, placement: Placement, mass: FloatArray, moment: FloatArray
) -> tuple[float, float]:
    """Bound of the square of the highest frequency of the bonded bodies, and that of a pair.

    The first is the largest eigenvalue of M^-1 sum phi K over the bonds of a body, 6 x 6, phi = 2
    between two free bodies; the second sqrt(sum kn/m_eff) of the stiffest interface.

    Args:
        made: The bonds.
        placement: The bodies.
        mass: Infinite for fixed bodies [kg], shape [body_count].
        moment: Principal moments [kg m^2], shape [body_count, 3].

    Returns:
        [1/s^2] and [1/s].
    """
    kn, kt, kr = (made.stiffness(key) for key in ("kn", "kt", "kr"))
    square = float(highest(made, placement, mass, moment, (kn, kt, kr)).max())
    together = kn * made.counts * np.sum(1.0 / mass[made.bodies], axis=1)
    return square, float(np.sqrt(together.max()))


def highest(
    made: Interfaces,
    placement: Placement,
    mass: FloatArray,
    moment: FloatArray,
    stiffness: tuple[FloatArray, FloatArray, FloatArray],
) -> FloatArray:
    """Largest eigenvalue of M^-1 sum phi K of each body, shape [body_count].

    ``stiffness`` is normal, tangential and against turning, of each interface's bonds.
    """
    kn, kt, kr = (np.repeat(values, made.counts) for values in stiffness)
    bodies = np.repeat(made.bodies, made.counts, axis=0)
    phi = np.where(np.isfinite(mass[bodies]).all(axis=1), 2.0, 1.0)
    blocks = np.zeros((len(mass), 6, 6))
    rotation = matrix(placement.orientation)
    n = made.sites.normal
    across = np.eye(3) - n[:, :, None] * n[:, None, :]
    local = kn[:, None, None] * n[:, :, None] * n[:, None, :] + kt[:, None, None] * across
    for end in bodies.T:
        arm = made.sites.point - placement.position[end]
        motion = np.zeros((len(arm), 3, 6))
        motion[:, :, :3] = np.eye(3)
        # principal axes: the velocity of the bond's point is v - arm x (R w)
        motion[:, :, 3:] = -np.cross(arm[:, :, None], rotation[end], axis=1)
        block = np.einsum("cki,ckl,clj->cij", motion, local, motion)
        block[:, 3:, 3:] += kr[:, None, None] * np.eye(3)
        np.add.at(blocks, end, phi[:, None, None] * block)
    scale = 1.0 / np.sqrt(np.column_stack([mass, mass, mass, moment]))
    squares = np.linalg.eigvalsh(scale[:, :, None] * blocks * scale[:, None, :])
    return squares[:, -1].astype(np.float64)
