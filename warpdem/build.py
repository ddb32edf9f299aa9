"""Scene to model and state: the one place that allocates what a run keeps."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.bonding import Bonding
from warpdem.checks.timestep import masses
from warpdem.device_forces import external_of
from warpdem.device_shapes import shape_arrays
from warpdem.drives import allocate_drives, gauges
from warpdem.features import Features, large_bodies, ranks, surface_bodies, tree_shapes
from warpdem.kernels.precision import real, wide, wide3
from warpdem.kernels.views import Geometry, Inertia
from warpdem.materials import materials
from warpdem.model import Model, on
from warpdem.periodic import cell_of
from warpdem.room import room_of
from warpdem.sleeping import sleep_of
from warpdem.state import State, allocate_state

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import FloatArray
    from warpdem.bonds.creation import Interfaces
    from warpdem.driving.plan import Plan
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene

# of the median bounding radius of the free bodies, to begin with
SKIN = 0.12


def build(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    features: Features,
    device: Any,
    *,
    plan: Plan,
    interfaces: Interfaces | None,
) -> tuple[Model, State]:
    """Model and state of a placed scene on a device."""
    shapes = list(polyhedra.values())
    geometry, trees = shape_arrays(
        shapes, tree_shapes(placement, shapes), device, once=features.once
    )
    bound = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    large = large_bodies(placement, shapes)
    surface = surface_bodies(placement, shapes)
    arms = _body_arrays(geometry, placement, shapes, bound, large, device)
    mass, moment = masses(placement, polyhedra)
    model = Model(
        device=device,
        features=features,
        geometry=geometry,
        inertia=_inertia(plan, mass, moment, device),
        materials=materials(scene, placement, features, device),
        group_count=len(placement.groups),
        gravity=np.array(scene.gravity.vector),
        mass=mass,
        moment=moment,
        bound=bound,
        large=large,
        surface=surface,
        external=external_of(scene, placement, polyhedra, device),
        skin=_skin(scene, bound[~placement.fixed]),
        lever=float((geometry.radius.numpy() * ~surface).max(initial=0.0)),
        reach=max((law.dncut or 0.0 for law in scene.contact), default=0.0),
        skin_adapts=scene.run.skin == "auto" and scene.run.list_distance is None,
        keep_within=scene.run.list_distance or 0.0,
        periodic=scene.cell.periodic if scene.cell else (False, False, False),
        cell_size=scene.cell.size if scene.cell else (),
        solid_volume=_solid_volume(placement, shapes),
        trees=trees,
        gauges=gauges(device, plan),
        room=room_of(scene, placement, polyhedra, geometry, device, contacts=features.contacts),
    )
    cell = cell_of(scene, placement, polyhedra, features, device)
    state = allocate_state(device, features, len(mass), arms, cell)
    still = placement.fixed & (model.inertia.driven.numpy() == 0)
    state.bodies.sleep = sleep_of(scene, features, still, device)
    drives = allocate_drives(device, plan, features, state.clock)
    state = replace(state, drives=drives)
    _start(state, placement, mass, moment)
    if interfaces is not None:
        bonding = Bonding(scene, placement, polyhedra, interfaces, features, device, plan=plan)
        state = replace(state, bonding=bonding)
    return model, state


def _solid_volume(placement: Placement, shapes: list[Polyhedron]) -> float:
    volume = np.array([shape.volume for shape in shapes])[placement.shape] * placement.scale**3
    return float(volume[~placement.fixed].sum())


def _skin(scene: Scene, bound: FloatArray) -> float:
    if scene.run.skin != "auto":
        return float(scene.run.skin)
    typical = SKIN * float(np.median(bound)) if len(bound) else 1.0
    return max(typical, scene.run.list_distance or 0.0)


def _body_arrays(
    geometry: Geometry,
    placement: Placement,
    shapes: list[Polyhedron],
    bound: FloatArray,
    large: np.ndarray,
    device: Any,
) -> int:
    """Fill the body-to-shape table; returns the number of vertices of all bodies."""
    counts = np.array([len(shape.vertices) for shape in shapes])[placement.shape]
    starts = np.concatenate([[0], np.cumsum(counts)])
    radius = np.array([shape.radius for shape in shapes])[placement.shape] * placement.scale
    geometry.shape = on(device, placement.shape.astype(np.int32), wp.int32)
    geometry.scale = on(device, placement.scale, real)
    geometry.radius = on(device, radius, real)
    geometry.bound = on(device, bound, wide)
    geometry.arm_start = on(device, starts[:-1].astype(np.int32), wp.int32)
    geometry.group = on(device, placement.group.astype(np.int32), wp.int32)
    geometry.rank = on(device, ranks(placement, shapes), wp.int32)
    geometry.large = on(device, large.astype(np.int32), wp.int32)
    return int(starts[-1])


def _inertia(plan: Plan, mass: FloatArray, moment: FloatArray, device: Any) -> Inertia:
    inertia = Inertia()
    driven = np.zeros(len(mass), np.int32)
    driven[plan.bodies] = 1 + np.arange(len(plan.bodies))
    inertia.mass = on(device, np.where(np.isfinite(mass), mass, 0.0), wide)
    inertia.inverse_mass = on(device, 1.0 / mass, wide)
    inertia.moment = on(device, np.where(np.isfinite(moment), moment, 0.0), wide3)
    inertia.inverse_moment = on(device, 1.0 / moment, wide3)
    inertia.driven = on(device, driven, wp.int32)
    return inertia


def _start(state: State, placement: Placement, mass: FloatArray, moment: FloatArray) -> None:
    """Positions and momenta at time zero."""
    bodies = state.bodies
    q = placement.orientation
    fixed = placement.fixed
    with np.errstate(invalid="ignore"):
        momentum = np.where(fixed[:, None], 0.0, mass[:, None] * placement.velocity)
        body_spin = rotate_back(q, placement.spin)
        turned = np.where(fixed[:, None], 0.0, moment * body_spin)
    bodies.position.assign(placement.position)
    bodies.orientation.assign(q[:, [1, 2, 3, 0]])
    bodies.momentum.assign(momentum)
    bodies.angular_momentum.assign(rotate(q, turned))
    bodies.velocity.assign(placement.velocity)
    bodies.spin.assign(placement.spin)
    bodies.velocity_end.assign(placement.velocity)
    bodies.spin_end.assign(placement.spin)


def rotate(q: FloatArray, v: FloatArray) -> FloatArray:
    """Vectors turned by unit quaternions w, x, y, z; shapes [n, 4], [n, 3]."""
    t = 2.0 * np.cross(q[:, 1:], v)
    return v + q[:, :1] * t + np.cross(q[:, 1:], t)


def rotate_back(q: FloatArray, v: FloatArray) -> FloatArray:
    """Vectors turned by the inverses of unit quaternions."""
    return rotate(q * np.array([1.0, -1.0, -1.0, -1.0]), v)
