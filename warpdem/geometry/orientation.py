"""Unit quaternions w, x, y, z and rotation matrices, on the host."""

from __future__ import annotations

from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def matrix(quaternion: FloatArray) -> FloatArray:
    """Rotation matrices, columns the turned axes; shape [..., 4] to [..., 3, 3]."""
    w, x, y, z = np.moveaxis(np.asarray(quaternion, float), -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Quaternions that turn by ``second`` and then by ``first``; shape [..., 4]."""
    a, b = np.broadcast_arrays(np.asarray(first, float), np.asarray(second, float))
    u, v = a[..., 1:], b[..., 1:]
    scalar = a[..., 0] * b[..., 0] - np.einsum("...i,...i", u, v)
    vector = a[..., :1] * v + b[..., :1] * u + np.cross(u, v)
    return np.concatenate([scalar[..., None], vector], axis=-1)


def turned(quaternion: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors turned by quaternions, each by its own or all by one; shape [..., 3]."""
    return np.einsum("...ij,...j->...i", matrix(quaternion), vectors)


def from_matrix(rotation: FloatArray) -> FloatArray:
    """Unit quaternion of a rotation matrix, largest component positive; shape [4].

    Source: Shepperd (1978), doi:10.2514/3.55767b: divide by the largest component.
    """
    r = rotation
    squares = np.array(
        [
            1.0 + r[0, 0] + r[1, 1] + r[2, 2],
            1.0 + r[0, 0] - r[1, 1] - r[2, 2],
            1.0 - r[0, 0] + r[1, 1] - r[2, 2],
            1.0 - r[0, 0] - r[1, 1] + r[2, 2],
        ]
    )
    products = np.array(
        [
            [squares[0], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], squares[1], r[1, 0] + r[0, 1], r[0, 2] + r[2, 0]],
            [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], squares[2], r[2, 1] + r[1, 2]],
            [r[1, 0] - r[0, 1], r[0, 2] + r[2, 0], r[2, 1] + r[1, 2], squares[3]],
        ]
    )
    row = products[np.argmax(squares)]
    return row / np.linalg.norm(row)


def random_orientations(count: int, generator: np.random.Generator) -> FloatArray:
    """Quaternions of rotations that are all equally likely, shape [count, 4]."""
    parts = generator.standard_normal((count, 4))
    return parts / np.linalg.norm(parts, axis=1, keepdims=True)


def principal_axes(inertia: FloatArray, error: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Principal moments and the rotation to the axes that is nearest to none.

    A tensor diagonal but for its error keeps its axes, so that a symmetric solid does too.

    Args:
        inertia: Symmetric tensor, shape [3, 3].
        error: Its relative error, beyond rounding.

    Returns:
        Moments, shape [3], and a rotation matrix whose columns are the axes, shape [3, 3].
    """
    noise = np.abs(inertia) <= (error + 1e-12) * np.trace(inertia)
    inertia = np.where(noise & ~np.eye(3, dtype=bool), 0.0, inertia)
    if np.count_nonzero(inertia - np.diag(np.diag(inertia))) == 0:
        return np.diag(inertia).copy(), np.eye(3)
    moments, axes = np.linalg.eigh(inertia)
    # of equally near ones (axes turned by 45 degrees) the first, with rising moments
    order = max(permutations(range(3)), key=lambda p: np.abs(np.diag(axes[:, p])).sum().round(6))
    moments, axes = moments[list(order)], axes[:, order]
    axes = axes * np.where(np.diag(axes) < 0.0, -1.0, 1.0)
    if np.linalg.det(axes) < 0.0:
        axes[:, np.argmin(np.abs(np.diag(axes)))] *= -1.0
    return moments, axes
