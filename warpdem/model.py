"""The model: arrays that never change during a run, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.features import Features
    from warpdem.kernels.guarding import Room
    from warpdem.kernels.views import External, Geometry, Inertia


@dataclass(frozen=True)
class Model:
    """What a simulation is made of.

    Attributes:
        device: Where the arrays live.
        features: What the scene needs.
        geometry: Shapes and the body-to-shape table (see kernels.views for each array).
        inertia: Masses [kg] and principal moments [kg m^2]; zero inverses: fixed or driven.
        materials: Contact parameters of group i and j at i * group_count + j.
        group_count: Number of groups.
        gravity: Acceleration of free fall [m/s^2].
        mass, moment: On the host; infinite for fixed bodies, shapes [body_count], [body_count, 3].
        bound: Bounding radii [m], shape [body_count].
        large: Bodies found through the tree of large bodies, and surfaces, shape [body_count].
        surface: Bodies that are analytic surfaces, shape [body_count].
        external: Forces on single bodies (see kernels.views).
        skin: Distance within which feature pairs are listed, at first [m].
        skin_adapts: The scene leaves it to the run.
        lever: Largest rounding radius: so far from a body another's core may touch it [m].
        reach: Gap up to which some contacts attract [m].
        keep_within: Gap up to which an open contact keeps its history (compat) [m].
        periodic: Axes along which space repeats itself.
        cell_size: Edges of the periodic cell at the start [m].
        solid_volume: Of the free bodies [m^3].
        trees: The feature trees, kept alive here.
        gauges: What measures the areas of pressures.
        room: How far bodies may go into each other (see kernels.guarding).
    """

    device: Any
    features: Features
    geometry: Geometry
    inertia: Inertia
    materials: wp.array
    group_count: int
    gravity: FloatArray
    mass: FloatArray
    moment: FloatArray
    bound: FloatArray
    large: BoolArray
    surface: BoolArray
    external: External
    skin: float
    skin_adapts: bool
    lever: float
    reach: float
    keep_within: float
    periodic: tuple[bool, ...]
    cell_size: tuple[float, ...]
    solid_volume: float
    trees: tuple[wp.Bvh, ...]
    gauges: wp.array
    room: Room

    @property
    def body_count(self) -> int:
        """Number of bodies, fixed ones included."""
        return len(self.mass)

    @property
    def free(self) -> BoolArray:
        """Bodies that forces move, shape [body_count]."""
        return np.isfinite(self.mass)


def on(device: Any, values: FloatArray | IntArray | BoolArray, dtype: Any) -> wp.array:
    """A device array of ``dtype`` with the given values."""
    return wp.array(np.ascontiguousarray(values), dtype=dtype, device=device)
