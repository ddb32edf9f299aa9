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
        self._corners = [shape.surface.points for shape in shapes]
        self._is_single = _fits_single(shapes, self._members, placement)
        self._connect(shapes)
        self._constant = {
            "body": np.arange(len(placement.shape), dtype=np.int32),
            "group": placement.group.astype(np.int32),
            "cluster": placement.cluster.astype(np.int32),
            "mass": _finite(masses(placement, polyhedra)[0]),
        }

    def _connect(self, shapes: Sequence[Polyhedron]) -> None:
        connectivity, sizes, owners = [], [], []
        first = 0
        for shape, members in zip(shapes, self._members, strict=True):
            surface = shape.surface
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
        for members, corners in zip(self._members, self._corners, strict=True):
            turned = corners @ matrix(snapshot.orientation[members]).swapaxes(1, 2)
            turned *= self._placement.scale[members, None, None]
            turned += snapshot.position[members, None]
            parts.append(turned.reshape(-1, 3))
        return np.concatenate(parts).astype(
            np.float32 if self._is_single else np.float64, copy=False
        )

    def fields(self, snapshot: Snapshot, names: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Values of the bodies at each of their polygons, by name; numbers in single precision."""
        values = self._constant | {
            "speed": np.linalg.norm(snapshot.velocity, axis=1),
            "velocity": snapshot.velocity,
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


def _fits_single(
    shapes: Sequence[Polyhedron], members: Sequence[NDArray[np.intp]], placement: Placement
) -> bool:
    sizes = [
        shape.bound * placement.scale[bodies] for shape, bodies in zip(shapes, members, strict=True)
    ]
    radius = np.concatenate(sizes)
    centres = np.abs(placement.position[np.concatenate(members)]).max(axis=1)
    return bool((centres + radius).max() < SINGLE_REACH * radius.min())
