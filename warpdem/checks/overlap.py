"""Bodies that overlap at the start."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpdem.features import large_bodies, surface_bodies
from warpdem.filling.repeat import Repeat
from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene_cell import Cell

DEEP = 0.1
"""Overlap at the start worth a warning, in radii of the smaller ball."""

NAMED = 5
"""Pairs of bodies named in warnings; the others are counted."""


class Overlaps(NamedTuple):
    """Pairs of bounding spheres that overlap.

    Attributes:
        pairs: The two bodies of each, shape [pair_count, 2].
        depths: How far each reaches into the other [m], shape [pair_count].
    """

    pairs: IntArray
    depths: FloatArray


class AtStart(NamedTuple):
    """What overlaps when a scene has been placed.

    Attributes:
        warnings: Balls that overlap deeply, in words.
        near: Number of other pairs of bodies of which the bounding spheres overlap; they may touch
            or not. Bodies too large for that to tell anything are left out.
    """

    warnings: tuple[str, ...]
    near: int


def overlaps_at_start(
    placement: Placement, polyhedra: Mapping[str, Polyhedron], cell: Cell | None = None
) -> AtStart:
    """The bodies of a placed scene that overlap, or images of them: exact for two balls."""
    shapes = list(polyhedra.values())
    bound = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    small = np.flatnonzero(~large_bodies(placement, shapes))
    found = _with_images(placement.position[small], bound[small], placement.fixed[small], cell)
    pairs = small[found.pairs]
    ball = np.array([len(shape.vertices) == 1 for shape in shapes], dtype=bool)[placement.shape]
    exact = ball[pairs].all(axis=1)
    deep = np.flatnonzero(exact & (found.depths > DEEP * bound[pairs].min(axis=1)))
    deep = deep[np.argsort(-found.depths[deep], kind="stable")]
    warnings = [_named(placement, pairs[k], float(found.depths[k])) for k in deep[:NAMED]]
    if len(deep) > NAMED:
        others = f"{len(deep) - NAMED} more pairs of balls"
        warnings.append(f"{others} overlap by over {100 * DEEP:g} % of a radius")
    warnings.extend(_beyond_surfaces(placement, shapes, bound * ball))
    return AtStart(tuple(warnings), int((~exact).sum()))


def _beyond_surfaces(
    placement: Placement, shapes: list[Polyhedron], ball_radius: FloatArray
) -> list[str]:
    """Bodies whose centre is beyond an analytic surface; balls also that reach deep into it."""
    free = np.flatnonzero(~placement.fixed)
    warnings = []
    for body in np.flatnonzero(surface_bodies(placement, shapes)):
        surface = shapes[placement.shape[body]].analytic
        assert surface
        scale = placement.scale[body]
        away = placement.position[free] - placement.position[body]
        height = surface.height(away @ matrix(placement.orientation[body]) / scale) * scale
        depth = ball_radius[free] - height
        deep = np.flatnonzero((depth > DEEP * ball_radius[free]) & (depth > 0.0))
        deep = deep[np.argsort(-depth[deep], kind="stable")]
        warnings += [
            _named(placement, np.array([free[k], body]), float(depth[k])) for k in deep[:NAMED]
        ]
        if len(deep) > NAMED:
            warnings.append(f"{len(deep) - NAMED} more bodies overlap such a surface")
    return warnings


def _with_images(
    centres: FloatArray, radii: FloatArray, fixed: BoolArray, cell: Cell | None
) -> Overlaps:
    """Pairs that overlap, each once though it may do so in several images."""
    if cell is None or not len(radii):
        return overlaps(centres, radii, fixed)
    repeat = Repeat(cell)
    centres = repeat.wrapped(centres)
    reach = 2.0 * radii.max()
    low, high = centres.min(axis=0) - reach, centres.max(axis=0) + reach
    places, whose = repeat.with_images(centres, low, high)
    found = overlaps(places, radii[whose], fixed[whose])
    # of two images the pair is counted where one of them is the body itself
    own = (found.pairs < len(radii)).any(axis=1)
    pairs = np.sort(whose[found.pairs[own]], axis=1)
    order = np.argsort(-found.depths[own], kind="stable")
    _, first = np.unique(pairs[order], axis=0, return_index=True)
    chosen = order[np.sort(first)]
    return Overlaps(pairs[chosen].astype(np.int32), found.depths[own][chosen])


def _named(placement: Placement, pair: IntArray, depth: float) -> str:
    first, second = (placement.names[body] for body in pair)
    return f'"{first}" and "{second}" overlap by {depth:.3g} m at the start'


def overlaps(centres: FloatArray, radii: FloatArray, fixed: BoolArray) -> Overlaps:
    """All pairs of balls that overlap, of which one at least is free.

    Works on a grid of cells as wide as the largest ball: meant for balls of similar size.

    Args:
        centres: Shape [body_count, 3] [m].
        radii: Shape [body_count] [m].
        fixed: Shape [body_count].
    """
    found: list[IntArray] = [np.zeros((0, 2), dtype=np.int32)]
    if len(radii) > 1:
        places = centres - centres.min(axis=0)
        # No more than a million cells along an axis, so that their numbers fit into 64 bits.
        width = max(2.0 * float(radii.max()), 1e-6 * float(places.max()))
        cells = np.floor(places / width).astype(np.int64)
        shape = cells.max(axis=0) + 3
        keys = ((cells[:, 0] + 1) * shape[1] + cells[:, 1] + 1) * shape[2] + cells[:, 2] + 1
        order = np.argsort(keys, kind="stable")
        for step in product((-1, 0, 1), repeat=3):
            shift = (step[0] * shape[1] + step[1]) * shape[2] + step[2]
            found.append(_within(centres, radii, order, keys, int(shift)))
    pairs = np.concatenate(found)
    pairs = pairs[~(fixed[pairs[:, 0]] & fixed[pairs[:, 1]])]
    gaps = np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1)
    return Overlaps(pairs, radii[pairs].sum(axis=1) - gaps)


def _within(
    centres: FloatArray, radii: FloatArray, order: IntArray, keys: IntArray, shift: int
) -> IntArray:
    """Overlapping pairs i < j with j in the cell ``shift`` away from that of i."""
    sorted_keys = keys[order]
    start = np.searchsorted(sorted_keys, keys + shift, side="left")
    count = np.searchsorted(sorted_keys, keys + shift, side="right") - start
    first = np.repeat(np.arange(len(keys)), count)
    place = np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    second = order[np.repeat(start, count) + place]
    apart = centres[first] - centres[second]
    reach = radii[first] + radii[second]
    near = (first < second) & (np.einsum("ij,ij->i", apart, apart) < reach * reach)
    return np.stack([first[near], second[near]], axis=1).astype(np.int32)
