"""Search for body pairs in a periodic cell: bodies wrapped into it, images within reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from warpdem.errors import UnstableError
from warpdem.kernels.images import find_images, wrap_bodies
from warpdem.kernels.precision import vec3

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.model import Model
    from warpdem.state import State

# a cell narrower than this part of the distance at which two bodies may meet is refused
NARROWEST = 0.25


class Images:
    """Homes and wrapped positions of the bodies.

    Attributes:
        home: The cell each body is in, shape [body_count].
        wrapped: Positions in the first cell [m], shape [body_count].
    """

    def __init__(self, model: Model, state: State) -> None:
        self._model, self._state = model, state
        self.home = wp.zeros(model.body_count, dtype=wp.vec3i, device=model.device)
        self.wrapped = wp.zeros(model.body_count, dtype=vec3, device=model.device)
        self._periodic = wp.vec3i(*map(int, model.periodic))
        self._tree_reach = vec3(*self._large_reach())

    def _large_reach(self) -> FloatArray:
        """How far large bodies that do not span the cell reach from their centres [m]."""
        model = self._model
        spanning = self._state.cell.spanning.numpy() != 0
        reach = np.where(model.large[:, None] & ~spanning, model.bound[:, None], 0.0)
        return reach.max(axis=0, initial=0.0)

    def wrap(self, reach: float) -> None:
        """Find the homes of all bodies; ``reach`` is the farthest that two centres may meet at.

        Raises:
            UnstableError: The cell is far narrower than the bodies in it.
        """
        model, state = self._model, self._state
        edges = state.cell.edges.numpy()[0]
        heights = 1.0 / np.linalg.norm(np.linalg.inv(edges), axis=1)
        for axis in np.flatnonzero(model.periodic):
            if not heights[axis] > NARROWEST * reach:
                raise UnstableError(
                    f"the periodic cell is {heights[axis]:.4g} m wide along {'xyz'[axis]}, less "
                    f"than a quarter of the distance at which bodies may meet, {reach:.4g} m (two "
                    f"bounding radii and the skin): each would meet more than four images of "
                    f"another; take a larger cell, or deform it less"
                )
        wp.launch(
            wrap_bodies,
            dim=model.body_count,
            inputs=[self._periodic, state.bodies, state.cell],
            outputs=[self.home, self.wrapped],
            device=model.device,
        )

    def find(
        self,
        search: tuple[int, float, int, wp.array],
        skin: float,
        outputs: list[wp.array],
        *,
        fill: bool,
        large: bool,
    ) -> None:
        """Count or write the pairs; ``search``: grid, its largest radius, tree, bodies in it."""
        model, state = self._model, self._state
        wp.launch(
            find_images(fill=fill, large=large),
            dim=model.body_count,
            inputs=[
                model.geometry,
                model.inertia,
                self._periodic,
                *search,
                self._tree_reach,
                skin,
                state.bodies,
                state.cell,
                self.home,
                self.wrapped,
            ],
            outputs=outputs,
            device=model.device,
        )
