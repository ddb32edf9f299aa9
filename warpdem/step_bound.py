"""Largest stable step for the contacts that touch at an instant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import warp as wp

from warpdem.kernels.driving import wall_frequency
from warpdem.kernels.measures import frequency_bound
from warpdem.kernels.precision import real

if TYPE_CHECKING:
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State


def step_bound(model: Model, state: State, lists: Lists) -> float:
    """Largest stable step for the contacts that touch now [s]; infinite without any."""
    if not (lists.pair_count or state.bonding):
        return float("inf")
    has, device = model.features, model.device
    square = wp.zeros(model.body_count, dtype=real, device=device)
    touching = (state.bodies, lists.pairs, lists.candidates, lists.incidence)
    wp.launch(
        frequency_bound(has.partnership, periodic=has.periodic),
        dim=model.body_count,
        inputs=[model.inertia, model.materials, *touching, state.cell],
        outputs=[square],
        device=device,
    )
    if has.controlled:
        wp.launch(
            wall_frequency,
            dim=model.body_count,
            inputs=[model.inertia, model.materials, state.drives, *touching],
            outputs=[square],
            device=device,
        )
    if state.bonding:
        state.bonding.add_bound(model, state, square)
    highest = float(square.numpy().max())
    return 2.0 / highest**0.5 if highest > 0 else float("inf")
