"""Rocks of a form: equant, flat or long polyhedra from a seed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.assembly import assembled
from warpdem.geometry.hull import convex_hull
from warpdem.geometry.inertia import rounded_moments
from warpdem.geometry.polyhedron import Polyhedron, build
from warpdem.rockfall.random import Purpose, Streams

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.geometry.core import Core

_ABOVE, _BELOW = 5.0 / 6.0, 1.0 / 2.0  # ratios of the axes on both sides of Zingg's 2/3

FORMS = {
    "equant": (1.0, _ABOVE, _ABOVE * _ABOVE),
    "flat": (1.0, _ABOVE, _ABOVE * _BELOW),
    "long": (1.0, _BELOW, _BELOW * _ABOVE),
}
"""Extents a >= b >= c along the rock's own axes over a, by form."""

_TRIES = 10  # places tried for a corner; the farthest from all others is taken


def built(
    form: str, volume: float, *, name: str, vertices: int, rounding: float = 0.0, seed: int = 0
) -> Polyhedron:
    """A rock of a form.

    Args:
        form: A key of ``FORMS``.
        volume: Of the rounded rock [m^3].
        name: Of the rock.
        vertices: Number of corners, 4 at least.
        rounding: Minkowski radius [m].
        seed: Of the form.

    Raises:
        GeometryError: The rounding alone is larger than the volume.
    """
    points = _corners(vertices, seed)
    points = points / np.ptp(points, axis=0) * np.array(FORMS[form])
    facets = convex_hull(points)
    core, _ = assembled(points, facets, None, repair=True)
    return build(
        _scale(core, volume, rounding) * points, facets, name=name, radius=rounding, repair=True
    )


def _corners(count: int, seed: int) -> FloatArray:
    """Directions spread over the sphere, shape [count, 3].

    Source: Mitchell (1991), doi:10.1145/122718.122736: the best of some candidates.
    """
    tried = Streams(seed, np.arange(count * _TRIES)).directions(Purpose.FORM)
    tried = tried.reshape(count, _TRIES, 3)
    points = tried[:1, 0]
    for candidates in tried[1:]:
        away = candidates[:, None] - points
        squares = away[..., 0] ** 2 + away[..., 1] ** 2 + away[..., 2] ** 2
        best = candidates[squares.min(axis=1).argmax()]
        points = np.concatenate([points, best[None]])
    return points


def _scale(core: Core, volume: float, rounding: float) -> float:
    """What a core is multiplied by for its rounded solid to have the volume.

    The volume at scale s is V s^3 + A r s^2 + M r^2 s + 4/3 pi r^3: Steiner's formula.
    """
    ball = 4.0 / 3.0 * np.pi * rounding**3
    if ball >= volume:
        largest = (0.75 / np.pi * volume) ** (1.0 / 3.0)
        raise GeometryError(
            f"rounding = {rounding:g} m is too large for a volume of {volume:g} m^3: it must be "
            f"less than {largest:.3g} m, the radius of the ball of that volume"
        )
    cube = rounded_moments(core, 0.0).volume
    square = rounding * float(np.linalg.norm(core.area_vectors, axis=1).sum())
    arcs = core.edge_arcs
    length = np.linalg.norm(np.diff(core.vertices[arcs.ends], axis=1)[:, 0], axis=1)
    line = rounding**2 * float(arcs.half @ length)
    scale = (volume / cube) ** (1.0 / 3.0)
    # Newton's steps from above fall to the root of a polynomial that only bends upwards
    for _ in range(100):
        excess = ((cube * scale + square) * scale + line) * scale + ball - volume
        step = excess / ((3.0 * cube * scale + 2.0 * square) * scale + line)
        scale -= step
        if abs(step) <= 1e-15 * scale:
            break
    return scale
