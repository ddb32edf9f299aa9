"""Stiffness of contacts that all stick, as a matrix: exact limit of the step, places of rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import product

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from warpdem.simulation import Simulation
    from warpdem.snapshot import Snapshot

    Matrix = NDArray[np.float64]

Poses = "tuple[Matrix, Matrix]"


def cross(v: Matrix) -> Matrix:
    """The matrix that takes w to v x w."""
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def stiffness(shot: Snapshot, kn: float, kt: float) -> Matrix:
    """Stiffness of all contacts that touch, against small motions about the world's axes.

    Args:
        shot: With contacts.
        kn: Of each contact, along its normal [N/m].
        kt: Across it [N/m].

    Returns:
        Symmetric, shape [6 body_count, 6 body_count]: displacement, then turn, of each body.
    """
    contacts = shot.contacts
    assert contacts
    size = 6 * len(shot.position)
    total = np.zeros((size, size))
    for (i, j), point, n in zip(contacts.bodies, contacts.point, contacts.normal, strict=True):
        block = kn * np.outer(n, n) + kt * (np.eye(3) - np.outer(n, n))
        motion = np.zeros((3, size))
        for body, sign in ((i, 1.0), (j, -1.0)):
            # the velocity of the contact point is v - arm x spin
            at = 6 * body
            motion[:, at : at + 3] = sign * np.eye(3)
            motion[:, at + 3 : at + 6] = -sign * cross(point - shot.position[body])
        total += motion.T @ block @ motion
    return total


def largest_step(shot: Snapshot, mass: float, moment: float, kn: float, kt: float) -> float:
    """Exact limit of the undamped step, 2/omega of the fastest mode [s].

    The last body is fixed; the others have one mass [kg] and one moment of inertia [kg m^2].
    """
    free = 6 * (len(shot.position) - 1)
    scale = np.tile([mass] * 3 + [moment] * 3, len(shot.position) - 1) ** -0.5
    matrix = stiffness(shot, kn, kt)[:free, :free] * scale * scale[:, None]
    return 2.0 / float(np.sqrt(np.linalg.eigvalsh(matrix)[-1]))


def at_rest(
    make: Callable[[Matrix, Matrix], Simulation],
    position: Matrix,
    orientation: Matrix,
    kn: float,
    kt: float,
    rounds: int = 12,
) -> tuple[Matrix, Matrix]:
    """Poses of the free bodies at which all forces cancel, by Newton's method.

    Args:
        make: A simulation of bodies that start so; a fixed one comes last.
        position: Where the search starts [m], shape [free_count, 3].
        orientation: The same, w, x, y, z, shape [free_count, 4].
        kn: Of each contact [N/m].
        kt: The same, against which what moves across is held while searching.
        rounds: Steps of the search.
    """
    for _ in range(rounds):
        shot = make(position, orientation).snapshot(contacts=True)
        free = len(position)
        matrix = stiffness(shot, kn, kt)[: 6 * free, : 6 * free]
        load = np.concatenate([shot.force[:free], shot.torque[:free]], axis=1).ravel()
        moved = np.linalg.solve(matrix, load).reshape(free, 6)
        position = position + moved[:, :3]
        small = np.concatenate([np.ones((free, 1)), 0.5 * moved[:, 3:]], axis=1)
        small /= np.linalg.norm(small, axis=1)[:, None]
        orientation = np.array([product(a, b) for a, b in zip(small, orientation, strict=True)])
    return position, orientation / np.linalg.norm(orientation, axis=1)[:, None]
