"""Pushes bodies that overlap apart, before a run."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.checks.timestep import SHARE_OF_BOUND, automatic_step
from warpdem.guards import measured_depths
from warpdem.input.scene import Gravity

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.checks.timestep import TimeStep
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.simulation import Simulation
    from warpdem.state import State

STILL = {"velocity": (0.0, 0.0, 0.0), "spin": (0.0, 0.0, 0.0)}
SPRINGS = {
    "law": "default",
    "kt": 0.0,
    "mu": 0.0,
    "en2": 1.0,
    "damping_ratio": None,
    "kr": 0.0,
    "mur": 0.0,
    "fc": 0.0,
    "dncut": None,
    "gamma": 0.0,
    "file": None,
    "normal": None,
    "parameters": (),
}
"""What is left of the contact laws."""
NEARLY = 0.2
"""Cores count as met from this part of the roundings before they do."""
OFF = {"sleep": None, "relax": None, "energy_guard": None, "adaptive_dt": False, "overlap": "note"}


STUCK = 100
"""Steps without progress after which pairs that overlap too far are pushed along their centres."""


def relaxed(
    make: Callable[..., Simulation],
    scene: Scene,
    placement: Placement,
    polyhedra: dict[str, Polyhedron],
    **options: Any,
) -> Placement:
    """The bodies of a scene when they have been pushed apart, with the velocities of the scene.

    Each step begins at rest, follows the forces of the springs, and moves no body farther than
    ``run.relax.stride``. Bodies whose cores have met are pushed along their centres.

    Args:
        make: Makes a simulation of a scene.
        scene: With a section [run.relax].
        placement: Its bodies.
        polyhedra: Its shapes.
        options: Of ``make``.

    Raises:
        SceneError: Bodies still overlap after ``run.relax.steps``; lists them.
    """
    chosen = scene.run.relax
    assert chosen
    step = automatic_step(_springs(scene, "auto"), placement, polyhedra)
    if not np.isfinite(step.bound):
        return placement
    simulation = make(_springs(scene, _half(step)), **options)
    model, _, lists = simulation.parts
    met = np.zeros(0, dtype=np.int64)
    depths = measured_depths(model, lists)
    least, since = np.inf, 0
    while (deepest := depths[:, 0].max(initial=0.0)) > chosen.overlap:
        if deepest < 0.99 * least:
            least, since = deepest, simulation.step_count
        elif simulation.step_count - since > STUCK:
            # features that hold one another: centres part them
            met = np.union1d(met, _keys(model, lists)[depths[:, 0] > chosen.overlap])
            since = simulation.step_count
        if simulation.step_count >= chosen.steps:
            way = f"still after {chosen.steps} steps of [run.relax]; give more steps or room"
            simulation.guards.refuse(depths[:, 0], chosen.overlap, way)
        met = _calm(*simulation.parts, depths, met, chosen.stride * model.bound, simulation.dt)
        simulation.advance(simulation.time + simulation.dt)
        depths = measured_depths(model, lists)
    now, count = simulation.snapshot(), simulation.step_count
    note = f"bodies pushed apart in {count} steps"
    notes = (*placement.notes, *([note] if count else []))
    return replace(placement, position=now.position, orientation=now.orientation, notes=notes)


def _half(step: TimeStep) -> float:
    return SHARE_OF_BOUND * step.bound


def _springs(scene: Scene, dt: float | str) -> Scene:
    """The scene at rest, with nothing but the springs of its contacts."""
    run = scene.run.model_copy(update={**OFF, "dt": dt, "duration": 1e30})
    return scene.model_copy(
        update={
            "run": run,
            "gravity": Gravity(vector=(0.0, 0.0, 0.0)),
            "driver": (),
            "force": (),
            "body": tuple(body.model_copy(update=STILL) for body in scene.body),
            "fill": tuple(fill.model_copy(update=STILL) for fill in scene.fill),
            "contact": tuple(law.model_copy(update=SPRINGS) for law in scene.contact),
            "output": scene.output.model_copy(update={"energy": False, "orientation": True}),
        }
    )


def _calm(  # noqa: PLR0917 - the parts of a simulation
    model: Model,
    state: State,
    lists: Lists,
    depths: FloatArray,
    met: IntArray,
    most: FloatArray,
    dt: float,
) -> IntArray:
    """Stop all bodies, and weaken forces that would move one farther than ``most``.

    ``met`` are keys of pairs whose cores had met, and still touch; those of now are returned.
    """
    bodies = state.bodies
    bodies.momentum.zero_()
    bodies.angular_momentum.zero_()
    force, torque = bodies.force.numpy().copy(), bodies.torque.numpy().copy()
    if not model.features.single:
        pairs, keys = _met(model, lists, depths, met)
        _part(model, state, lists, pairs, depths[pairs, 1], force, torque)
        met = keys[pairs]
    way = 0.5 * dt * dt * _acceleration(model, force, torque)
    weaker = np.where(way > most, most / np.maximum(way, 1e-300), 1.0)[:, None]
    bodies.force.assign(force * weaker)
    bodies.torque.assign(torque * weaker)
    return met


def _met(
    model: Model, lists: Lists, depths: FloatArray, before: IntArray
) -> tuple[IntArray, IntArray]:
    """Pairs whose cores meet, or have met and still touch; and the keys of all pairs."""
    n = lists.pair_count
    i, j = lists.pairs.owner.numpy()[:n], lists.pairs.partner.numpy()[:n]
    keys = _keys(model, lists)
    radius = model.geometry.radius.numpy()
    near = depths[:, 1] > -NEARLY * (radius[i] + radius[j])
    touching = lists.pairs.touching.numpy()[:n] > 0
    small = ~model.large[i] & ~model.large[j]
    return np.flatnonzero(small & touching & (near | np.isin(keys, before))), keys


def _keys(model: Model, lists: Lists) -> IntArray:
    """A number for each pair of bodies, whatever the lists, shape [pair_count]."""
    n = lists.pair_count
    owner, partner = lists.pairs.owner.numpy()[:n], lists.pairs.partner.numpy()[:n]
    return owner.astype(np.int64) * model.body_count + partner


def _part(  # noqa: PLR0917 - the same
    model: Model,
    state: State,
    lists: Lists,
    met: IntArray,
    beyond: FloatArray,
    force: FloatArray,
    torque: FloatArray,
) -> None:
    """Push bodies whose cores have met along their centres: their features lead nowhere."""
    pairs = lists.pairs
    i, j = pairs.owner.numpy()[met], pairs.partner.numpy()[met]
    position, radius = state.bodies.position.numpy(), model.geometry.radius.numpy()
    apart = position[i] - position[j]
    apart[~apart.any(axis=1)] = (0.0, 0.0, 1.0)
    apart /= np.linalg.norm(apart, axis=1)[:, None]
    laws: Any = model.materials.numpy()
    stiffness = laws["kn"][pairs.material.numpy()[met]]
    push = (stiffness * (beyond + radius[i] + radius[j]))[:, None] * apart
    instead = push - pairs.force.numpy()[met]
    np.add.at(force, i, instead)
    np.subtract.at(force, j, instead)
    torque[i] = 0.0
    torque[j] = 0.0


def _acceleration(model: Model, force: FloatArray, torque: FloatArray) -> FloatArray:
    """That of the farthest point of each body from rest, or more [m/s^2], shape [body_count]."""
    turning = np.linalg.norm(torque, axis=1) / model.moment.min(axis=1)
    return np.linalg.norm(force, axis=1) / model.mass + model.bound * turning
