"""The forces at time zero: the stages of a step with dt = 0."""

from __future__ import annotations

from typing import TYPE_CHECKING

import warp as wp

from warpdem.kernels.integrate import orient
from warpdem.stages import Stage, acting, advance, after_drift, areas, bonds, cell

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.drives import Blocks
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State


def orient_all(model: Model, state: State) -> None:
    """Rotation matrices and vertices of all bodies from their orientations."""
    wp.launch(
        orient,
        dim=model.body_count,
        inputs=[model.geometry],
        outputs=[state.bodies],
        device=model.device,
    )


def first_forces(
    model: Model,
    state: State,
    lists: Lists,
    whole: Share,
    blocks: Blocks,
    *,
    dt: float,
    launch: Callable[..., None],
) -> bool:
    """Make the first lists and forces; ``launch`` runs stages. Whether contacts acted."""
    orient_all(model, state)
    wp.copy(state.bodies.listed_position, state.bodies.position)
    wp.copy(state.bodies.listed_orientation, state.bodies.orientation)
    blocks.at_rest()
    launch(advance(model, state, lists, whole, 0.0, kicks=False, drifts=True))
    if len(model.gauges):
        launch(areas(model, state, whole))
    contacts, first = model.features.contacts, model.features.first_step
    if contacts:
        lists.rebuild(dt)
    else:
        state.bodies.reach.fill_(float("inf"))
    if not contacts or first == "gravity":
        _without_contacts(model, state, lists, whole, launch)
        return False
    if first == "forces":
        # exaDEM's friction springs are already one step old at time zero
        launch(*acting(model, state, lists, whole, dt))
        launch(advance(model, state, lists, whole, 0.0, kicks=True, drifts=False))
        state.bodies.torque.zero_()
    else:
        launch(*after_drift(model, state, lists, whole, 0.0))
        lists.change_step(0.0, dt)
    lists.locate()
    return True


def _without_contacts(
    model: Model, state: State, lists: Lists, whole: Share, launch: Callable[..., None]
) -> None:
    launch(*cell(model, state, lists, whole, 0.0, onward=False))
    alone: Stage = advance(
        model, state, lists, whole, 0.0, kicks=True, drifts=False, contacts=False
    )
    launch(*bonds(model, state, whole, 0.0), alone)
