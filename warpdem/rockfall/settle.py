"""Rocks set down at a distance from the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Ground

LISTED = 10
"""Places that a message lists."""


def is_off(ground: Ground, plan: FloatArray) -> BoolArray:
    """Points x, y that no rock's centre may be above: outside, or without data; shape [n]."""
    x, y = plan[:, 0], plan[:, 1]
    cell = ground.grid.index(x, y)
    known = ground.known.reshape(-1)[np.maximum(cell, 0)].astype(bool)
    return (cell < 0) | ~known | np.isnan(ground.height(x, y))


def places(plan: FloatArray, origin: FloatArray) -> str:
    """The first of some points, for a message.

    Args:
        plan: Local x, y [m], shape [n, 2].
        origin: Of the local coordinates, shape [3].
    """
    more = f" and {len(plan) - LISTED} more" if len(plan) > LISTED else ""
    national = (plan[:LISTED] + origin[:2]).tolist()
    return ", ".join(f"({x:.12g}, {y:.12g})" for x, y in national) + more


def resting_height(
    ground: Ground, rock: Rock, plan: FloatArray, orientation: FloatArray, clearance: FloatArray
) -> FloatArray:
    """Height of the centre of mass at which the lowest point of a rock clears the ground [m].

    Each vertex is held against the ground under it, as a contact of the trajectory is: the ball
    of the rounding about it touches the tangent plane. Those over no ground do not count.

    Args:
        ground: What is under it.
        rock: One rock.
        plan: Local x, y of its centre, on known ground [m], shape [n, 2].
        orientation: Unit quaternions from the principal frame to the world, shape [n, 4].
        clearance: Least vertical distance [m], shape [n].
    """
    turn = matrix(orientation)
    rise = np.full(len(plan), -np.inf)
    for a, b, c in rock.vertices.tolist():
        # sums term by term: the order of others may depend on the number of rocks
        x, y, z = (turn[:, k, 0] * a + turn[:, k, 1] * b + turn[:, k, 2] * c for k in range(3))
        x, y = plan[:, 0] + x, plan[:, 1] + y
        np.fmax(rise, ground.height(x, y) + _ball_height(ground, rock, x, y) - z, out=rise)
    nowhere = np.isneginf(rise)
    if nowhere.any():
        rise[nowhere] = ground.height(plan[nowhere, 0], plan[nowhere, 1]) + rock.bound
    return rise + clearance


def _ball_height(ground: Ground, rock: Rock, x: FloatArray, y: FloatArray) -> FloatArray | float:
    """How high above the ground the middle of a ball of the rounding is that touches it [m]."""
    if rock.rounding == 0.0:
        return 0.0
    along_x, along_y = ground.slopes(x, y)
    return rock.rounding * np.sqrt(1.0 + along_x * along_x + along_y * along_y)
