"""Distances of convex hulls by a quadratic programme: nothing of the program's own geometry.

The hull of points P, none of them at the origin's side of a plane w.p = 1, is 1/|w| away from the
origin for the shortest such w: min |w| so that w.p >= 1 for all p, Lawson & Hanson's least distance
problem, which they solve by non-negative least squares (Solving Least Squares Problems, 1974,
section 23.4).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

FloatArray = np.ndarray


def hull_distance(first: FloatArray, second: FloatArray) -> float:
    """Distance of the hulls of two sets of points [m], 0 where they meet; shapes [n, 3], [m, 3]."""
    apart = (first[:, None] - second[None]).reshape(-1, 3)
    size = float(np.abs(apart).max())
    if size == 0.0:
        return 0.0
    return size * _from_origin(apart / size)


def _from_origin(points: FloatArray) -> float:
    """Distance of the origin from the hull of points of size 1.

    Scaled by the distance found so far, and solved again: so a small one is not the difference of
    large numbers. Every answer is the length of a point of the hull: the least one is the best.
    """
    distance = float(np.linalg.norm(points, axis=1).min())
    for scale in (1.0, 1.0, 0.5, 2.0):
        if distance < TINY:
            break
        system = np.vstack([points.T / (scale * distance), np.ones(len(points))])
        weights, _ = nnls(system, np.array([0.0, 0.0, 0.0, 1.0]), maxiter=30 * len(points))
        if (total := weights.sum()) > 0.0:
            # weights of points of the hull: the nearest one is their mean
            distance = min(distance, float(np.linalg.norm(weights @ points)) / total)
    return distance


TINY = 1e-13
