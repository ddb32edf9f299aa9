"""Forces on single bodies as the device reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.flow import flow_of
from warpdem.input.scene_force import Drag, Fluid, NumericalDamping, VelocityBarrier
from warpdem.kernels.precision import wide, wide3
from warpdem.kernels.views import External
from warpdem.model import on

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene


def external_of(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron], device: Any
) -> External:
    """Coefficients of the forces on single bodies, on a device.

    Raises:
        SceneError: A grid of fluid velocities cannot be used.
    """
    external = External()
    drag = np.zeros(len(placement.shape))
    for force in scene.force:
        match force:
            case Drag():
                drag += force.product * _acts_on(force.groups, placement)
                external.drag = on(device, drag, wide)
            case Fluid():
                area = np.pi * equal_radii(placement, polyhedra) ** 2
                friction = force.cx * area * _acts_on(force.groups, placement)
                external.fluid = on(device, friction, wide)
            case NumericalDamping():
                external.damping = force.coefficient
            case VelocityBarrier():
                external.speed_limit = force.velocity or 0.0
                external.speed_exponent = force.velocity_exponent
                external.spin_limit = force.spin or 0.0
                external.spin_exponent = force.spin_exponent
    if flow := flow_of(scene):
        external.flow = wp.array(flow.velocity, dtype=wide3, device=device)
        external.origin = wide3(*flow.origin)
        external.spacing = wide3(*flow.spacing)
    return external


def _acts_on(groups: tuple[str, ...] | None, placement: Placement) -> BoolArray:
    """Bodies of the named groups, or all, shape [body_count]."""
    if groups is None:
        return np.ones(len(placement.group), dtype=bool)
    return np.isin(placement.group, [placement.groups.index(name) for name in groups])


def equal_radii(placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> FloatArray:
    """Radii of the balls that have the bodies' volumes [m], shape [body_count]."""
    volume = np.array([shape.volume for shape in polyhedra.values()])[placement.shape]
    return np.cbrt(0.75 * volume / np.pi) * placement.scale
