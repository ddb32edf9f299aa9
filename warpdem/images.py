"""Search for body pairs in a periodic cell: bodies wrapped into it, images within reach."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from warpdem.allocation import allocated
from warpdem.errors import UnstableError
from warpdem.kernels.images import find_images, wrap_bodies
from warpdem.kernels.precision import wide3

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.kernels.views import Bonds, Pairs
    from warpdem.model import Model
    from warpdem.state import State

# a cell narrower than this part of the distance at which two bodies may meet is refused
NARROWEST = 0.25


# an edge leans this far over another before one of that is taken off
LEAN = 0.5 + 1e-9


def shorter_edges(edges: FloatArray, periodic: tuple[bool, ...]) -> IntArray:
    """Integers U, of determinant 1, such that no edge of H U leans over half of another.

    H U repeats the same space: image n under H is image U^-1 n under H U. So a cell may shear on
    and on.
    """
    whole = np.eye(3, dtype=np.int64)
    pairs = [(a, b) for a in range(3) for b in range(3) if a != b and periodic[a] and periodic[b]]
    reduced, again = edges, True
    while again:
        again = False
        for a, b in pairs:
            lean = reduced[:, a] @ reduced[:, b] / (reduced[:, b] @ reduced[:, b])
            if abs(lean) > LEAN:
                whole[:, a] -= int(np.rint(lean)) * whole[:, b]
                reduced, again = edges @ whole, True
    return whole


def shorten(state: State, pairs: Pairs, count: int, periodic: tuple[bool, ...]) -> None:
    """Give the cell its shorter edges, and the images in the lists their new numbers."""
    cell = state.cell
    whole = shorter_edges(cell.edges.numpy()[0], periodic)
    if (whole == np.eye(3, dtype=np.int64)).all():
        return
    for each in (cell.edges, cell.rate, cell.rate_end, cell.lattice):
        each.assign(each.numpy() @ whole)
    back = np.rint(np.linalg.inv(whole)).astype(np.int32)
    if count:
        pairs.image[:count].assign(pairs.image.numpy()[:count] @ back.T)


class Images:
    """Homes and wrapped positions of the bodies.

    Attributes:
        home: The cell each body is in, shape [body_count].
        wrapped: Positions in the first cell [m], shape [body_count].
    """

    def __init__(self, model: Model, state: State) -> None:
        self._model, self._state = model, state
        own = allocated("images", "body", model.body_count, model.features, model.device)
        self.home, self.wrapped = own["home"], own["wrapped"]
        self._periodic = wp.vec3i(*map(int, model.periodic))
        self._tree_reach = wide3(*self._large_reach())
        surfaces = np.flatnonzero(model.surface)
        self._surface_body = wp.array(surfaces, dtype=wp.int32, device=model.device)

    def _large_reach(self) -> FloatArray:
        """How far large bodies that do not span the cell reach from their centres [m]."""
        model = self._model
        spanning = self._state.cell.spanning.numpy() != 0
        reach = np.where(
            (model.large & ~model.surface)[:, None] & ~spanning, model.bound[:, None], 0.0
        )
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
        widest: float,
        glue: Bonds,
        outputs: list[wp.array],
        *,
        fill: bool,
        large: bool,
    ) -> None:
        """Count or write the pairs; ``search``: grid, its largest radius, tree, bodies in it.

        ``widest`` is the farthest that a body may go before the next rebuild [m].
        """
        model, state = self._model, self._state
        wp.launch(
            find_images(
                fill=fill,
                large=large,
                surfaces=model.features.surfaces,
                bonds=model.features.bonds,
            ),
            dim=model.body_count,
            inputs=[
                model.geometry,
                model.inertia,
                self._periodic,
                *search,
                self._tree_reach,
                self._surface_body,
                model.reach,
                widest,
                state.bodies,
                glue,
                state.cell,
                self.home,
                self.wrapped,
            ],
            outputs=outputs,
            device=model.device,
        )
