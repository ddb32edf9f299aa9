"""Neighbour lists: who could touch whom before the next rebuild. They grow, they never drop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.kernels.candidates import find_candidates
from warpdem.kernels.matching import carry_history
from warpdem.kernels.neighbours import find_partners, incidence_keys, incidence_starts
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.views import Bonds, Candidates, Incidence, Pairs

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.model import Model
    from warpdem.state import State

# head room of a list that has to grow
GROWTH = 1.3
# the skin grows where lists last fewer steps than the first number, unless there are more
# candidates a body than the second one; it shrinks where they last longer than the third
FEW_STEPS, MANY_CANDIDATES, MANY_STEPS = 25, 40, 100
# by this factor, and never beyond these parts of the first skin
SKIN_STEP, SKIN_LEAST, SKIN_MOST = 1.25, 0.3, 8.0


class Lists:
    """Body pairs, their candidates and each body's pairs.

    Attributes:
        pairs, candidates, incidence: The lists (see kernels.views).
        pair_count, candidate_count: Their lengths now.
        pair_room: Pairs for which there is room.
        rebuilds: How often they were made.
        born: Step at which they were made.
        generation: Changes whenever an array was replaced by a larger one.
        skin: Distance within which feature pairs are listed now [m].
        ends: Where the pairs of each owner end, shape [body_count].
        spent: Energy lost in dashpots, friction, rolling by pairs of earlier lists [J].
    """

    def __init__(self, model: Model, state: State) -> None:
        self._model = model
        self._state = state
        device = model.device
        self.pairs = Pairs()
        self.candidates = Candidates()
        self.incidence = Incidence()
        self.pair_count = 0
        self.candidate_count = 0
        self.rebuilds = 0
        self.generation = 0
        self.skin = model.skin
        self.born = 0
        self.spent = np.zeros(3)
        self.pair_room = 0
        self._candidate_room = 0
        count = model.body_count
        self.incidence.start = wp.zeros(count + 1, dtype=wp.int32, device=device)
        self.ends = wp.zeros(count, dtype=wp.int32, device=device)
        self._grid_bound = float(model.bound[~model.large].max(initial=0.0))
        self._grid = self._hash_grid()
        self._tree: wp.Bvh | None = None
        self._tree_body = wp.array(np.flatnonzero(model.large), dtype=wp.int32, device=device)
        self._grow_pairs(1)
        self._grow_candidates(1)

    def rebuild(self, *, adapt: bool = True) -> None:
        """Make all lists anew at the present positions; contacts keep what they remember.

        Without ``adapt`` the skin stays as it is.
        """
        state = self._state
        wp.copy(state.bodies.listed_position, state.bodies.position)
        wp.copy(state.bodies.listed_orientation, state.bodies.orientation)
        self.settle()
        old = self._keep_old()
        if adapt:
            self._adapt_skin()
        self._find_pairs()
        self._find_candidates()
        self._carry(old)
        state.clock.reach.fill_(0.5 * self.skin)
        state.clock.moved.zero_()
        state.clock.halted.zero_()
        self.rebuilds += 1

    def _adapt_skin(self) -> None:
        """A wider skin where bodies are fast and few, a narrower one where slow and many."""
        step = int(self._state.clock.steps.numpy()[0])
        lasted, self.born = step - self.born, step
        if not self._model.skin_adapts or self.rebuilds == 0:
            return
        crowded = self.candidate_count > MANY_CANDIDATES * self._model.body_count
        factor = 1.0
        if lasted > (FEW_STEPS if crowded else MANY_STEPS):
            factor = 1.0 / SKIN_STEP
        elif lasted < FEW_STEPS and not crowded:
            factor = SKIN_STEP
        least, most = SKIN_LEAST * self._model.skin, SKIN_MOST * self._model.skin
        self.skin = min(max(self.skin * factor, least), most)

    def settle(self) -> None:
        """Add what the pairs have dissipated to ``spent``, and start them at zero."""
        if self._model.features.account and self.pair_count:
            self.spent = self.spent + self.since()
            self._state.account.pair.zero_()

    def since(self) -> FloatArray:
        """Energy lost in dashpots, friction, rolling since these lists were made [J], shape [3]."""
        if not (self._model.features.account and self.pair_count):
            return np.zeros(3)
        return self._state.account.pair.numpy()[: self.pair_count, 1:].sum(axis=0)

    def _hash_grid(self) -> Any:
        free = max(int(np.count_nonzero(~self._model.large)), 1)
        side = int(np.clip(2 ** np.ceil(np.log2(free ** (1 / 3)) + 1), 8, 128))
        return wp.HashGrid(side, side, side, device=self._model.device, dtype=wp.float64)

    def _grow_pairs(self, room: int) -> None:
        if room <= self.pair_room:
            return
        room = int(room * GROWTH) + 64
        device = self._model.device
        pairs = self.pairs
        for name in ("owner", "partner", "material", "touching"):
            setattr(pairs, name, wp.zeros(room, dtype=wp.int32, device=device))
        pairs.start = wp.zeros(room + 1, dtype=wp.int32, device=device)
        pairs.force = wp.zeros(room, dtype=vec3, device=device)
        pairs.torque = wp.zeros(room, dtype=vec3, device=device)
        pairs.torque_partner = wp.zeros(room, dtype=vec3, device=device)
        self.incidence.pair = wp.zeros(4 * room, dtype=wp.int32, device=device)
        self._keys = wp.zeros(4 * room, dtype=wp.int32, device=device)
        if self._model.features.account:
            self._state.account.pair = wp.zeros(room, dtype=vec4, device=device)
        self.pair_room = room
        self.generation += 1

    def _grow_candidates(self, room: int) -> None:
        if room <= self._candidate_room:
            return
        room = int(room * GROWTH) + 256
        device = self._model.device
        candidates = self.candidates
        candidates.code = wp.zeros(room, dtype=wp.int64, device=device)
        candidates.past = wp.zeros(room, dtype=vec4, device=device)
        rolled = room if self._model.features.rolling else 1
        candidates.rolled = wp.zeros(rolled, dtype=vec4, device=device)
        candidates.which = wp.zeros(room, dtype=wp.int32, device=device)
        candidates.normal = wp.zeros(room, dtype=vec3, device=device)
        candidates.point = wp.zeros(room, dtype=vec3, device=device)
        candidates.gap = wp.zeros(room, dtype=real, device=device)
        self._candidate_room = room
        self.generation += 1

    def _keep_old(self) -> tuple[wp.array, ...]:
        """Copies of the lists that the new ones take their history from."""
        pairs, candidates = self.pairs, self.candidates
        count, length = self.pair_count, self.candidate_count
        return (
            wp.clone(self.ends),
            wp.clone(pairs.partner[: max(count, 1)]),
            wp.clone(pairs.start[: count + 1]),
            wp.clone(candidates.code[: max(length, 1)]),
            wp.clone(candidates.past[: max(length, 1)]),
            wp.clone(candidates.rolled[: max(length, 1)])
            if self._model.features.rolling
            else candidates.rolled,
        )

    def _find_pairs(self) -> None:
        model, bodies = self._model, self._state.bodies
        cell = max(2.0 * self._grid_bound + self.skin, 1e-30)
        self._grid.build(bodies.position, cell)
        tree = self._large_tree()
        large = tree is not None
        bonding = self._state.bonding

        def launch(owner: wp.array, partner: wp.array, *, fill: bool) -> None:
            wp.launch(
                find_partners(fill=fill, large=large, bonds=bonding is not None),
                dim=model.body_count,
                inputs=[
                    model.geometry,
                    model.inertia,
                    self._grid.id,
                    self._grid_bound,
                    tree.id if tree is not None else 0,
                    self._tree_body,
                    self.skin,
                    bodies,
                    bonding.bonds if bonding else Bonds(),
                ],
                outputs=[self.ends, owner, partner],
                device=model.device,
            )

        launch(self.pairs.owner, self.pairs.partner, fill=False)
        wp.utils.array_scan(self.ends, self.ends, inclusive=True)
        self.pair_count = int(self.ends[-1:].numpy()[0])
        self._grow_pairs(self.pair_count)
        if self.pair_count:
            launch(self.pairs.owner, self.pairs.partner, fill=True)
        self._link()

    def _large_tree(self) -> wp.Bvh | None:
        """Tree over the boxes of the large bodies; made once when they stand still."""
        model = self._model
        large = np.flatnonzero(model.large)
        if len(large) == 0:
            return None
        still = not (model.free[large].any() or model.features.driven)
        if self._tree is None or not still:
            low, high = self._boxes(large)
            slack = 1e-6 * np.maximum(np.abs(low), np.abs(high))
            self._tree = wp.Bvh(
                wp.array((low - slack).astype(np.float32), dtype=wp.vec3, device=model.device),
                wp.array((high + slack).astype(np.float32), dtype=wp.vec3, device=model.device),
            )
        return self._tree

    def _boxes(self, large: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """World boxes of bodies, rounding included [m], shapes [count, 3]."""
        geometry = self._model.geometry
        bodies = self._state.bodies
        shape = geometry.shape.numpy()[large]
        scale = geometry.scale.numpy()[large][:, None]
        rotation = bodies.rotation.numpy()[large]
        middle = geometry.core_middle.numpy()[shape] * scale
        half = geometry.core_half.numpy()[shape] * scale
        centre = bodies.position.numpy()[large] + np.einsum("bij,bj->bi", rotation, middle)
        extent = np.einsum("bij,bj->bi", np.abs(rotation), half)
        extent = extent + geometry.radius.numpy()[large][:, None]
        return centre - extent, centre + extent

    def _link(self) -> None:
        """Each body's pairs, in ascending order of pair."""
        model, count = self._model, self.pair_count
        if count:
            wp.launch(
                incidence_keys,
                dim=count,
                inputs=[model.geometry, model.group_count, self.pairs],
                outputs=[self._keys, self.incidence.pair],
                device=model.device,
            )
            wp.utils.radix_sort_pairs(self._keys, self.incidence.pair, 2 * count)
        wp.launch(
            incidence_starts,
            dim=model.body_count + 1,
            inputs=[self._keys, 2 * count],
            outputs=[self.incidence],
            device=model.device,
        )

    def _find_candidates(self) -> None:
        model, count = self._model, self.pair_count
        self.candidate_count = 0
        if count == 0:
            return
        has = model.features

        def launch(ends: wp.array, *, fill: bool) -> None:
            wp.launch(
                find_candidates(fill=fill, polyhedra=has.polyhedra, trees=has.trees),
                dim=count,
                inputs=[model.geometry, self.skin, self._state.bodies, self.pairs],
                outputs=[self.candidates.code, ends],
                device=model.device,
            )

        ends = self.pairs.start[1 : count + 1]
        launch(ends, fill=False)
        wp.utils.array_scan(ends, ends, inclusive=True)
        self.candidate_count = int(ends[-1:].numpy()[0])
        self._grow_candidates(self.candidate_count)
        launch(ends, fill=True)

    def _carry(self, old: tuple[wp.array, ...]) -> None:
        if self.pair_count:
            wp.launch(
                carry_history(rolling=self._model.features.rolling),
                dim=self.pair_count,
                inputs=[*old, self.pairs],
                outputs=[self.candidates],
                device=self._model.device,
            )
