"""How far one can go from a surface along its normal before another part of it is as near."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray


def reach(base: FloatArray, direction: FloatArray, triangles: FloatArray) -> FloatArray:
    """Largest t such that the ball about x + t n through x leaves each triangle outside; or inf.

    Such balls are nested, so the least value over the triangles of a surface is the distance of x
    from the surface's medial axis along n.

    Args:
        base: Points x, shape [..., 3].
        direction: Unit vectors n, shape [..., 3].
        triangles: Corners, also of triangles without area, shape [..., 3, 3].
    """
    a, b, c = (triangles[..., k, :] - base for k in range(3))
    curvature = np.maximum(
        _curvature(direction, a, b),
        np.maximum(_curvature(direction, b, c), _curvature(direction, c, a)),
    )
    with np.errstate(divide="ignore"):
        at_border = np.where(curvature > 0.0, 0.5 / np.maximum(curvature, 1e-300), np.inf)
    return np.minimum(at_border, _to_inside(direction, a, b, c))


def _dot(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.einsum("...i,...i", x, y)


def _curvature(direction: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Largest n.y / y.y over the points y of segments a b: half the inverse of the ball's radius.

    With y = a + s e it is (A + B s)/(p + 2 q s + g s^2), greatest where
    B g s^2 + 2 A g s + 2 A q - B p = 0 and A + B s > 0.
    """
    e = b - a
    along, rise = _dot(direction, a), _dot(direction, e)
    p, q, g = _dot(a, a), _dot(a, e), np.maximum(_dot(e, e), 1e-300)
    rest = (2.0 * along * q - rise * p) / g
    root = np.sqrt(np.maximum(along * along - rise * rest, 0.0))
    # the quotient without cancellation
    upper = np.where(along > 0.0, -rest, root - along)
    lower = np.where(along > 0.0, root + along, rise)
    s = np.clip(upper / np.where(lower == 0.0, 1e-300, lower), 0.0, 1.0)
    highest = along / np.maximum(p, 1e-300)
    for place in (s, np.ones_like(s)):
        y = a + place[..., None] * e
        highest = np.maximum(highest, _dot(direction, y) / np.maximum(_dot(y, y), 1e-300))
    return highest


def _to_inside(direction: FloatArray, a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """The largest t until the ball touches the triangle inside its borders, or inf."""
    normal = np.cross(b - a, c - a)
    length = np.sqrt(_dot(normal, normal))
    unit = normal / np.maximum(length, 1e-300)[..., None]
    height = _dot(unit, a)
    unit = np.where((height < 0.0)[..., None], -unit, unit)
    slope = 1.0 + _dot(direction, unit)
    t = np.abs(height) / np.maximum(slope, 1e-12)
    foot = t[..., None] * (direction + unit)
    inside = (length > 0.0) & (height != 0.0) & (slope > 1e-12)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= _dot(np.cross(v - u, foot - u), normal) >= 0.0
    return np.where(inside, t, np.inf)
