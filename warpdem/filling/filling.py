"""The bodies of a fill: which shape, how large, which way up, where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.curve import along_curve
from warpdem.filling.scatter import lattice, random_places
from warpdem.filling.sizes import drawn, largest
from warpdem.geometry.orientation import IDENTITY, product, random_orientations

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.filling.repeat import Repeat
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene_fill import Fill


@dataclass(frozen=True, eq=False)
class Filled:
    """Generated bodies.

    Attributes:
        shape: Number of the shape among all, shape [count].
        scale: Homothety, shape [count].
        position: Centres of mass [m], shape [count, 3].
        orientation: Of the principal frames, shape [count, 4].
        radius: Of the bounding spheres [m], shape [count].
        wanted: How many were asked for, or found room for in a lattice without ``count``.
    """

    shape: IntArray
    scale: FloatArray
    position: FloatArray
    orientation: FloatArray
    radius: FloatArray
    wanted: int


def filled(
    fill: Fill,
    shapes: Mapping[str, Polyhedron],
    generator: np.random.Generator,
    blocked: Callable[[FloatArray, FloatArray], BoolArray],
    repeat: Repeat,
) -> Filled:
    """Bodies of a fill whose bounding spheres meet neither one another nor what is there.

    Args:
        fill: What to generate.
        shapes: All shapes by name.
        generator: Source of randomness.
        blocked: Says which balls, by centres and radii, meet bodies that are there.
        repeat: Periods of space.
    """
    low, high = np.array(fill.region.min), np.array(fill.region.max)
    count = fill.count
    sites = np.zeros((0, 3))
    if count is None:
        reach = largest(fill.size) * max(shapes[name].bound for name in fill.shapes)
        sites = lattice(low, high, reach, fill.spacing, repeat)
        count = len(sites)
    shape, scale, radius = _kinds(fill, shapes, generator, count)
    orientation = _orientations(fill, shapes, generator, shape)
    if fill.kind == "random":
        position, placed = random_places(generator, low, high, radius, blocked, repeat)
        chosen = np.flatnonzero(placed)
        chosen = chosen[along_curve(position[chosen])]
        position = position[chosen]
    else:
        if fill.count is not None and count:
            sites = lattice(low, high, float(radius.max()), fill.spacing, repeat)
        met = repeat.touched(blocked, sites, np.full(len(sites), radius.max(initial=0.0)))
        position = sites[~met][:count]
        chosen = np.arange(len(position))
    return Filled(
        shape[chosen], scale[chosen], position, orientation[chosen], radius[chosen], count
    )


def _kinds(
    fill: Fill, shapes: Mapping[str, Polyhedron], generator: np.random.Generator, count: int
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Shape number, homothety and bounding radius of ``count`` bodies."""
    number = {name: k for k, name in enumerate(shapes)}
    weights = np.array(fill.weights or [1.0] * len(fill.shapes))
    choice = generator.choice(len(fill.shapes), count, p=weights / weights.sum())
    scale = drawn(fill.size, count, generator)
    bound = np.array([shapes[name].bound for name in fill.shapes])
    shape = np.array([number[name] for name in fill.shapes])
    return shape[choice], scale, scale * bound[choice]


def _orientations(
    fill: Fill,
    shapes: Mapping[str, Polyhedron],
    generator: np.random.Generator,
    shape: IntArray,
) -> FloatArray:
    """Orientations of the principal frames, shape [count, 4]."""
    if fill.orientation == "random":
        return random_orientations(len(shape), generator)
    turn = IDENTITY if isinstance(fill.orientation, str) else np.array(fill.orientation)
    frames = np.array([polyhedron.frame_rotation for polyhedron in shapes.values()])
    return product(turn, frames[shape].reshape(-1, 4))
