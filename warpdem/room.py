"""How far bodies may go into each other, and how fast: what the guards measure by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.checks.timestep import masses
from warpdem.kernels.guarding import Room
from warpdem.kernels.precision import wide
from warpdem.model import on

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.kernels.views import Geometry

LOOKS = 8.0
"""A body that may get through another is looked at so many times on its way to the middle."""

NAMES = ("half", "lever", "critical", "narrow")


def room_of(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    geometry: Geometry,
    device: Any,
    *,
    contacts: bool,
) -> Room:
    """The room of each body (see kernels.guarding); arrays of length 1 without ``contacts``."""
    room = Room()
    if not contacts:
        for name in NAMES:
            setattr(room, name, on(device, np.zeros(1), wide))
        return room
    shapes = list(polyhedra.values())
    scale = placement.scale
    radius = np.array([s.radius for s in shapes])[placement.shape] * scale
    bound = np.array([s.bound for s in shapes])[placement.shape] * scale
    surface = np.array([s.analytic is not None for s in shapes])[placement.shape]
    halves = _halves(shapes, geometry)[placement.shape]
    half = np.where(halves > 0.0, halves * scale, halves)
    narrow = _narrowest(radius, half, surface)
    room.half = on(device, half, wide)
    room.lever = on(device, np.where(surface, 0.0, bound - radius), wide)
    room.narrow = on(device, narrow / LOOKS, wide)
    room.critical = on(device, _critical(scene, placement, polyhedra, narrow), wide)
    return room


def _halves(shapes: list[Polyhedron], geometry: Geometry) -> FloatArray:
    """To the middle of the solid behind the nearest face [m]; 0 for sheets, -1 without faces."""
    depth, start = geometry.depth.numpy(), geometry.face_start.numpy()
    faces = [depth[start[k] : start[k + 1]] for k in range(len(shapes))]
    return np.array([float(own.min()) if len(own) else -1.0 for own in faces])


def _narrowest(radius: FloatArray, half: FloatArray, surface: np.ndarray) -> FloatArray:
    """Least room of each body with any other, or less [m], shape [body_count]."""
    others = np.where(surface, np.inf, radius + np.maximum(half, 0.0))
    least = float(others.min(initial=np.inf))
    own = np.where(half >= 0.0, half, np.inf)
    thinnest = float(np.where(surface, np.inf, radius).min(initial=np.inf))
    return radius + np.minimum(own + thinnest, least)


def _critical(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    narrow: FloatArray,
) -> FloatArray:
    """Speed at which the softest contact of each body gives way by half its room [m/s].

    A driven body is stopped by no mass of its own: that of the heaviest free one stands for it.
    """
    mass = masses(placement, polyhedra)[0]
    heaviest = float(mass[~placement.fixed].max(initial=0.0))
    mass = np.where(placement.fixed, heaviest, mass)
    table = scene.contact_table(placement.groups)
    softest = np.full(len(placement.groups), np.inf)
    for (group, _), law in table.items():
        index = placement.groups.index(group)
        softest[index] = min(softest[index], law.kn)
    with np.errstate(divide="ignore", invalid="ignore"):
        speed = 0.5 * narrow * np.sqrt(softest[placement.group] / mass)
    return np.nan_to_num(speed, nan=np.inf, posinf=1e300)
