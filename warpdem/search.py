"""Finds the candidates of the body pairs: near features, their tests, the codes of the hits."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import warp as wp

from warpdem.allocation import allocated
from warpdem.kernels.candidates import find_candidates, find_near, single_candidates
from warpdem.memory import grown

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.features import Features
    from warpdem.kernels.views import Candidates, Pairs
    from warpdem.model import Model
    from warpdem.state import State


class Search:
    """Writes the candidates of body pairs; its arrays grow, they never shrink."""

    def __init__(self, model: Model, state: State) -> None:
        self._model = model
        self._state = state
        has, device = model.features, model.device
        of_pairs = allocated("search", "pair", grown(1), has, device)
        self._near, self._rows = of_pairs["near"], of_pairs["rows"]
        self._hits = allocated("search", "row", grown(1), has, device)["hits"]

    def find(
        self,
        pairs: Pairs,
        count: int,
        candidates: Candidates,
        grow: Callable[[int], None],
    ) -> int:
        """Write where each pair's candidates begin, and their codes.

        Args:
            pairs: Body pairs.
            count: Their number.
            candidates: Whose ``code`` is written.
            grow: Makes room for so many candidates.

        Returns:
            The number of candidates.
        """
        if count == 0:
            return 0
        model = self._model
        launch = partial(wp.launch, dim=count, device=model.device)
        if not model.features.polyhedra:
            grow(count)
            (single,) = candidate_kernels(model.features)
            launch(single, inputs=[model.geometry, pairs], outputs=[candidates.code])
            return count
        near, test, write = candidate_kernels(model.features)
        inputs = [model.geometry, model.reach, self._state.bodies, pairs, self._state.cell]
        self._near = _at_least(self._near, count)
        self._rows = _at_least(self._rows, count)
        launch(near, inputs=inputs, outputs=[self._near, self._rows])
        self._hits = _at_least(self._hits, _summed(self._rows[:count]))
        inputs += [self._near, self._rows, self._hits]
        ends = pairs.start[1 : count + 1]
        launch(test, inputs=inputs, outputs=[candidates.code, ends])
        total = _summed(ends)
        grow(total)
        launch(write, inputs=inputs, outputs=[candidates.code, ends])
        return total


def candidate_kernels(has: Features) -> tuple[wp.Kernel, ...]:
    """Kernels that find near features, test them and write candidates; one if all are spheres."""
    if not has.polyhedra:
        return (single_candidates(surfaces=has.surfaces),)
    find = partial(find_candidates, trees=has.trees, surfaces=has.surfaces, periodic=has.periodic)
    return find_near(periodic=has.periodic), find(fill=False), find(fill=True)


def _summed(counts: Any) -> int:
    """Replace counts by their running sum; returns the last."""
    wp.utils.array_scan(counts, counts, inclusive=True)
    return int(counts[-1:].numpy()[0])


def _at_least(values: wp.array, room: int) -> wp.array:
    """The array, or a longer one with head room; contents are lost."""
    if room <= len(values):
        return values
    return wp.zeros(grown(room), dtype=values.dtype, device=values.device)
