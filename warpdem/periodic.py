"""The periodic cell on the host: its arrays at the start, and what a snapshot shows of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.allocation import allocate
from warpdem.checks.cell import cell_control, spanning_axes
from warpdem.kernels.cell import CHUNKS
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.views import Cell
from warpdem.snapshot import CellState

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import FloatArray
    from warpdem.features import Features
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

# what a step of the cell depends on
KEPT = (
    "edges",
    "rate",
    "acceleration",
    "jump",
    "gradient",
    "time",
    "listed",
    "lattice",
    "power",
    "work",
)


def cell_of(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    features: Features,
    device: Any,
) -> Cell:
    """The cell of a scene at time zero; without arrays where there is none."""
    cell = Cell()
    given = scene.cell
    if given is None:
        return cell

    def one(value: Any, dtype: Any) -> wp.array:
        return wp.array(np.asarray(value, float)[None], dtype=dtype, device=device)

    edges, still = np.diag(given.size), np.zeros((3, 3))
    rate = np.array(given.strain_rate)
    flow = rate if given.start == 0.0 else still
    control = cell_control(scene, placement, polyhedra)
    tensors = {
        "edges": edges,
        "listed": edges,
        "rate": flow @ edges,
        "rate_end": flow @ edges,
        "gradient": flow,
        "given": rate,
        "held": control.held,
        "target": control.target,
        "since": np.eye(3),
        "lattice": np.eye(3),
        "acceleration": still,
        "jump": still,
    }
    for name, value in tensors.items():
        setattr(cell, name, one(value, wide33))
    numbers = {
        "inertia": control.inertia,
        "damping": control.damping,
        "start": given.start,
        "stop": np.inf if given.stop is None else given.stop,
        "time": 0.0,
        "stretch": 0.0,
        "power": 0.0,
        "work": 0.0,
    }
    for name, value in numbers.items():
        setattr(cell, name, one(value, wide))
    cell.centre = one(given.centre, wide3)
    allocate(cell, "cell", "chunk", CHUNKS, features, device)
    spanning = spanning_axes(scene, placement, polyhedra)
    cell.spanning = wp.array(spanning.astype(np.int32), dtype=wp.vec3i, device=device)
    return cell


def flow(model: Model, state: State) -> FloatArray:
    """Velocity of the homogeneous flow at each body [m/s], shape [body_count, 3]."""
    position = state.bodies.position.numpy()
    if not model.features.deforming:
        return np.zeros_like(position)
    cell = state.cell
    return (position - cell.centre.numpy()[0]) @ cell.gradient.numpy()[0].T


def shifts(state: State, lists: Lists, pair: Any) -> FloatArray:
    """Where the images of partners lie from the partners themselves [m], shape [n, 3]."""
    if not lists.has_images:
        return np.zeros((len(pair), 3))
    return lists.pairs.image.numpy()[pair] @ state.cell.edges.numpy()[0].T


def cell_state(model: Model, state: State, lists: Lists, velocity: FloatArray) -> CellState | None:
    """The cell now: its shape, how it deforms, and the mean stress in it."""
    if not model.features.periodic:
        return None
    edges = state.cell.edges.numpy()[0].copy()
    volume = float(np.linalg.det(edges))
    c = (velocity - flow(model, state))[model.free]
    mass = model.mass[model.free]
    return CellState(
        centre=state.cell.centre.numpy()[0].copy(),
        edges=edges,
        periodic=model.periodic,
        velocity_gradient=state.cell.gradient.numpy()[0].copy(),
        deformation=edges @ np.linalg.inv(np.diag(model.cell_size) @ state.cell.lattice.numpy()[0]),
        volume=volume,
        solid_fraction=model.solid_volume / volume,
        contact_stress=_moment(model, state, lists) / volume,
        kinetic_stress=np.einsum("b,bi,bj->ij", mass, c, c) / volume,
    )


def _moment(model: Model, state: State, lists: Lists) -> FloatArray:
    """Sum of f (x) d; against a fixed body the branch goes from the contact to the free one."""
    n = lists.pair_count
    pairs = lists.pairs
    on = np.flatnonzero(pairs.touching.numpy()[:n])
    owner, partner = pairs.owner.numpy()[on], pairs.partner.numpy()[on]
    position = state.bodies.position.numpy()
    branch = position[owner] - position[partner] - shifts(state, lists, on)
    walls = np.flatnonzero(~(model.free[owner] & model.free[partner]))
    for k in walls:
        first = lists.pairs.start.numpy()[on[k]]
        slots = slice(first, first + lists.pairs.touching.numpy()[on[k]])
        which = lists.candidates.which.numpy()[slots]
        weight = np.maximum(lists.candidates.past.numpy()[which, 3], 0.0)
        weight = weight if weight.any() else np.ones(len(which))
        point = weight @ lists.candidates.point.numpy()[slots] / weight.sum()
        branch[k] = branch[k] - point if model.free[owner[k]] else point
    total = np.einsum("pi,pj->ij", pairs.force.numpy()[on], branch)
    if state.bonding:
        total = total + _bonded_moment(model, state)
    return total


def _bonded_moment(model: Model, state: State) -> FloatArray:
    """Sum of f (x) d over the interfaces; to a fixed body from the middle of the bonds."""
    assert state.bonding
    bonds, made = state.bonding.bonds, state.bonding.made
    force = bonds.force.numpy() * (bonds.state.numpy() != 0)[:, None]
    owner, partner = made.bodies.T
    position = state.bodies.position.numpy()
    branch = position[owner] - position[partner]
    starts = np.cumsum(made.counts) - made.counts
    middle = np.add.reduceat(bonds.point.numpy(), starts) / made.counts[:, None]
    one = (model.free[owner] & ~model.free[partner])[:, None]
    other = (~model.free[owner] & model.free[partner])[:, None]
    branch = np.where(one, branch - middle, np.where(other, middle, branch))
    return np.einsum("pi,pj->ij", force, branch)
