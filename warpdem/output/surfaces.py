"""The rounded surfaces of all bodies as one grid of polygons."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.checks.timestep import masses
from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray
    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.arrays import FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.geometry.surface import Surface
    from warpdem.snapshot import Snapshot


SINGLE_REACH = 1e4
"""Points are single precision while the scene reaches less than so many times its smallest body:
they are then off by less than a thousandth of it."""


class Surfaces:
    """Surfaces of the bodies, shape by shape; what does not move is computed once.

    Attributes:
        body: The body each polygon belongs to, shape [polygon_count].
    """

    def __init__(self, polyhedra: Mapping[str, Polyhedron], placement: Placement) -> None:
        self._placement = placement
        used = np.unique(placement.shape)
        self._members = [np.flatnonzero(placement.shape == shape) for shape in used]
        every_shape = list(polyhedra.values())
        shapes = [every_shape[shape] for shape in used]
        drawn = [
            _drawn(shape, who, placement) for shape, who in zip(shapes, self._members, strict=True)
        ]
        self._corners = [surface.points for surface in drawn]
        self._is_single = _fits_single(shapes, drawn, self._members, placement)
        self._connect(drawn)
        self._constant = {
            "body": np.arange(len(placement.shape), dtype=np.int32),
            "group": placement.group.astype(np.int32),
            "cluster": placement.cluster.astype(np.int32),
            "mass": _finite(masses(placement, polyhedra)[0]),
        }

    def _connect(self, drawn: Sequence[Surface]) -> None:
        connectivity, sizes, owners = [], [], []
        first = 0
        for surface, members in zip(drawn, self._members, strict=True):
            starts = first + len(surface.points) * np.arange(len(members))
            connectivity.append((starts[:, None] + surface.connectivity).ravel())
            sizes.append(np.tile(np.diff(surface.offsets), len(members)))
            owners.append(np.repeat(members, len(surface.offsets) - 1))
            first += len(surface.points) * len(members)
        self._connectivity = np.concatenate(connectivity).astype(np.int32)
        ends = np.cumsum(np.concatenate(sizes))
        self._offsets = np.concatenate([[0], ends]).astype(np.int32)
        self.body = np.concatenate(owners)

    def points(self, snapshot: Snapshot) -> NDArray[np.floating]:
        """Corners of all surfaces at one instant, world [m], shape [point_count, 3]."""
        parts = []
        position = self._drawn(snapshot)
        for members, corners in zip(self._members, self._corners, strict=True):
            turned = corners @ matrix(snapshot.orientation[members]).swapaxes(1, 2)
            turned *= self._placement.scale[members, None, None]
            turned += position[members, None]
            parts.append(turned.reshape(-1, 3))
        return np.concatenate(parts).astype(
            np.float32 if self._is_single else np.float64, copy=False
        )

    def _drawn(self, snapshot: Snapshot) -> FloatArray:
        """Where centres are shown [m]: moving bodies with their centre in a periodic cell."""
        if snapshot.cell is None:
            return snapshot.position
        still = self._placement.fixed[:, None]
        return np.where(still, snapshot.position, snapshot.cell.wrapped(snapshot.position))

    def fields(self, snapshot: Snapshot, names: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Values of the bodies at each of their polygons, by name; numbers in single precision."""
        velocity = snapshot.velocity
        if snapshot.cell is not None:
            velocity = snapshot.cell.velocity_seen(snapshot.position, velocity)
        values = self._constant | {
            "speed": np.linalg.norm(velocity, axis=1),
            "velocity": velocity,
            "spin": snapshot.spin,
            "force": snapshot.force,
        }
        if snapshot.breakage:
            values["fragment"] = snapshot.breakage.fragment.astype(np.int32)
        known = [name for name in names if name in values]
        return {name: np.take(_single(values[name]), self.body, axis=0) for name in known}

    def grid(self, snapshot: Snapshot, names: Sequence[str]) -> vtkUnstructuredGrid:
        """All surfaces at one instant, with the named fields as cell data."""
        from warpdem.output import vtu  # noqa: PLC0415 - loads VTK, which a run without frames need not

        cell_data = self.fields(snapshot, names)
        return vtu.polygons(self.points(snapshot), self._connectivity, self._offsets, cell_data)


def _single(values: NDArray[Any]) -> NDArray[Any]:
    return values.astype(np.float32) if values.dtype == np.float64 else values


def _finite(mass: FloatArray) -> FloatArray:
    """Masses with 0 for the fixed bodies: an infinite one would spoil every colour scale."""
    return np.where(np.isfinite(mass), mass, 0.0)


def _drawn(shape: Polyhedron, members: NDArray[np.intp], placement: Placement) -> Surface:
    """Surface of a shape; an analytic one out to the farthest free body from one of its bodies."""
    if not shape.analytic:
        return shape.surface
    free = placement.position[~placement.fixed]
    reach = 0.0
    for body in members:
        away = np.linalg.norm(free - placement.position[body], axis=1).max(initial=0.0)
        reach = max(reach, float(away / placement.scale[body]))
    return shape.analytic.drawn(reach or shape.bound)


def _fits_single(
    shapes: Sequence[Polyhedron],
    drawn: Sequence[Surface],
    members: Sequence[NDArray[np.intp]],
    placement: Placement,
) -> bool:
    sizes = [
        shape.bound * placement.scale[bodies]
        for shape, bodies in zip(shapes, members, strict=True)
        if not shape.analytic
    ]
    smallest = min((size.min() for size in sizes), default=1.0)
    farthest = max(
        np.linalg.norm(surface.points, axis=1).max() * placement.scale[bodies].max()
        + np.abs(placement.position[bodies]).max()
        for surface, bodies in zip(drawn, members, strict=True)
    )
    return bool(farthest < SINGLE_REACH * smallest)
