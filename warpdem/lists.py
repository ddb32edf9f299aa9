"""Neighbour lists: who could touch whom before the next rebuild. They grow, they never drop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.allocation import allocate, allocated
from warpdem.images import Images, shorten
from warpdem.kernels.matching import carry_history
from warpdem.kernels.neighbours import (
    find_partners,
    incidence_keys,
    incidence_starts,
    set_reach,
)
from warpdem.kernels.sphere_forces import locate_contacts
from warpdem.kernels.views import Bonds, Candidates, Incidence, Pairs
from warpdem.memory import grid_side, grown
from warpdem.search import Search
from warpdem.sleeping import keep_wrenches
from warpdem.stages import laws

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.features import Features
    from warpdem.model import Model
    from warpdem.state import State

# each body may go as far as it would in so many steps before the lists are renewed, within these
# parts of half the first skin: by measurement, tools/design/0007
AHEAD = 120
REACH_LEAST, REACH_MOST = 0.3, 6.0


class Lists:
    """Body pairs, their candidates and each body's pairs.

    Attributes:
        pairs, candidates, incidence: The lists (see kernels.views).
        pair_count, candidate_count: Their lengths now.
        pair_room: Pairs for which there is room.
        rebuilds: How often they were made.
        generation: Changes whenever an array was replaced by a larger one.
        has_images: Pairs have images of a periodic cell.
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
        self.spent = np.zeros(3)
        self.has_images = model.features.periodic
        self._images = Images(model, state) if self.has_images else None
        self.pair_room = 0
        self._candidate_room = 0
        count = model.body_count
        allocate(self.incidence, "incidence", "body", count, model.features, device)
        own = allocated("lists", "body", count, model.features, device)
        self.ends, self._few = own["ends"], own["few"]
        self.incidence.ends = self.ends
        self._grid_bound = float(model.bound[~model.large].max(initial=0.0))
        self._grid = self._hash_grid()
        self._tree: wp.Bvh | None = None
        self._in_tree = np.flatnonzero(model.large & ~model.surface)
        self._tree_body = wp.array(self._in_tree, dtype=wp.int32, device=device)
        surfaces = np.flatnonzero(model.surface)
        self._surface_body = wp.array(surfaces, dtype=wp.int32, device=device)
        self._search = Search(model, state)
        self._grow_pairs(1)
        self._grow_candidates(1)

    def rebuild(self, dt: float = 0.0, *, again: bool = False) -> None:
        """Make all lists anew at the present positions; contacts keep what they remember.

        ``dt`` is the time step [s]; ``again``: each body's reach stays as it is.
        """
        state = self._state
        wp.copy(state.bodies.listed_position, state.bodies.position)
        wp.copy(state.bodies.listed_orientation, state.bodies.orientation)
        if self._model.features.deforming:
            shorten(state, self.pairs, self.pair_count, self._model.periodic)
            wp.copy(state.cell.listed, state.cell.edges)
        carry_wrenches = keep_wrenches(self._model, state, self)
        self.settle()
        old = self._keep_old()
        if not again:
            self._set_reach(dt)
        if self._model.features.surfaces and self._model.features.driven:
            self._measure_surfaces()
        self._find_pairs()
        self.candidate_count = self._search.find(
            self.pairs, self.pair_count, self.candidates, self._grow_candidates
        )
        self._carry(old)
        carry_wrenches()
        state.bodies.path.zero_()
        state.clock.moved.zero_()
        state.clock.halted.zero_()
        self.rebuilds += 1

    def facts(self) -> dict[str, int]:
        """How often they were made, and how long they are."""
        return {
            "rebuilds": self.rebuilds,
            "pairs": self.pair_count,
            "candidates": self.candidate_count,
        }

    def locate(self) -> None:
        """Write where spheres touch; for others the pair kernel does."""
        model, state = self._model, self._state
        if model.features.single and self.pair_count:
            wp.launch(
                locate_contacts(laws(model.features)),
                dim=self.pair_count,
                inputs=[model.geometry, state.bodies, self.pairs, state.cell],
                outputs=[self.candidates],
                device=model.device,
            )

    def _set_reach(self, dt: float) -> None:
        """Let fast bodies go farther before the lists are renewed than slow ones."""
        model, half = self._model, 0.5 * self._model.skin
        least, most = half, half
        if model.skin_adapts and not model.features.deforming:
            least, most = REACH_LEAST * half, REACH_MOST * half
        wp.launch(
            set_reach,
            dim=model.body_count,
            inputs=[
                model.geometry,
                model.inertia,
                model.room,
                dt,
                AHEAD * dt,
                least,
                most,
                int(model.features.polyhedra),
            ],
            outputs=[self._state.bodies],
            device=model.device,
        )

    def settle(self) -> None:
        """Add what the pairs have dissipated to ``spent``, and start them at zero."""
        if self._model.features.account and self.pair_count:
            self.spent = self.spent + self.since()
            self._state.account.pair.zero_()
            self._state.account.power.zero_()

    def since(self) -> FloatArray:
        """Energy lost in dashpots, friction, rolling since these lists were made [J], shape [3]."""
        if not (self._model.features.account and self.pair_count):
            return np.zeros(3)
        return self._state.account.pair.numpy()[: self.pair_count, 1:].sum(axis=0)

    def power(self) -> FloatArray:
        """What dashpots, friction, rolling take at this instant [W], shape [3]."""
        if not (self._model.features.account and self.pair_count):
            return np.zeros(3)
        return self._state.account.power.numpy()[: self.pair_count, 1:].sum(axis=0)

    def change_step(self, before: float, now: float) -> None:
        """Half of each power has been counted ahead for a step ``before``, which is ``now`` [s]."""
        self.spent = self.spent + 0.5 * (now - before) * self.power()

    def _hash_grid(self) -> Any:
        free = max(int(np.count_nonzero(~self._model.large)), 1)
        side = grid_side(free)
        return wp.HashGrid(side, side, side, device=self._model.device, dtype=wp.float64)

    def _grow_pairs(self, room: int) -> None:
        if room <= self.pair_room:
            return
        room, has, device = grown(room), self._model.features, self._model.device
        allocate(self.pairs, "pairs", "pair", room, has, device)
        allocate(self.incidence, "incidence", "pair", room, has, device)
        allocate(self._state.account, "account", "pair", room, has, device)
        self._keys = allocated("lists", "pair", room, has, device)["keys"]
        self.pair_room = room
        self.generation += 1

    def _grow_candidates(self, room: int) -> None:
        if room <= self._candidate_room:
            return
        room, has, device = grown(room), self._model.features, self._model.device
        allocate(self.candidates, "candidates", "candidate", room, has, device)
        self._candidate_room = room
        self.generation += 1

    def _keep_old(self) -> tuple[wp.array, ...]:
        """Copies of the lists that the new ones take their history from."""
        pairs, candidates = self.pairs, self.candidates
        count, length = self.pair_count, self.candidate_count
        kept = (candidates.code, candidates.past, *self._memory())
        return (
            wp.clone(self.ends),
            _copy(pairs.partner, count),
            _copy(pairs.image, count),
            _copy(pairs.start, count + 1),
            *(_copy(values, length) for values in kept),
            _copy(pairs.looked, count),
            _copy(pairs.fastest, count),
        )

    def _memory(self) -> tuple[wp.array, ...]:
        """What some laws remember of a contact; of length 1 where the scene has none of them."""
        return self.candidates.rolled, self.candidates.share, self.candidates.last

    def _measure_surfaces(self) -> None:
        """Distances of the farthest bodies from the surfaces: what moves there as these turn."""
        model = self._model
        position = self._state.bodies.position.numpy()
        free = model.free
        bound = model.geometry.bound.numpy().copy()
        for surface in np.flatnonzero(model.surface):
            away = np.linalg.norm(position[free] - position[surface], axis=1) + bound[free]
            bound[surface] = away.max(initial=0.0) + REACH_MOST * model.skin
        model.geometry.bound.assign(bound)

    def _find_pairs(self) -> None:
        model, bodies = self._model, self._state.bodies
        widest = float(bodies.reach.numpy().max(initial=0.0))
        cell = max(2.0 * (self._grid_bound + widest) + model.reach, 1e-30)
        places = bodies.position
        if self._images is not None:
            self._images.wrap(cell)
            places = self._images.wrapped
        self._grid.build(places, cell)
        tree = self._large_tree()
        large = tree is not None
        tree_id = tree.id if tree is not None else 0
        bonding = self._state.bonding
        glue = bonding.bonds if bonding else Bonds()

        def launch(*, fill: bool) -> None:
            outputs = [self.ends, self.pairs.owner, self.pairs.partner]
            if self._images is not None:
                search = (self._grid.id, self._grid_bound, tree_id, self._tree_body)
                outputs.append(self.pairs.image)
                self._images.find(search, widest, glue, outputs, fill=fill, large=large)
                return
            wp.launch(
                find_partners(
                    fill=fill,
                    large=large,
                    surfaces=model.features.surfaces,
                    bonds=model.features.bonds,
                ),
                dim=model.body_count,
                inputs=[
                    model.geometry,
                    model.inertia,
                    self._grid.id,
                    self._grid_bound,
                    tree_id,
                    self._tree_body,
                    self._surface_body,
                    model.reach,
                    widest,
                    bodies,
                    glue,
                    self._few,
                ],
                outputs=outputs,
                device=model.device,
            )

        launch(fill=False)
        wp.utils.array_scan(self.ends, self.ends, inclusive=True)
        self.pair_count = int(self.ends[-1:].numpy()[0])
        self._grow_pairs(self.pair_count)
        if self.pair_count:
            launch(fill=True)
        self._link()

    def _large_tree(self) -> wp.Bvh | None:
        """Tree over the boxes of the large bodies; made once when they stand still."""
        model = self._model
        large = self._in_tree
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
        places = bodies.position if self._images is None else self._images.wrapped
        centre = places.numpy()[large] + np.einsum("bij,bj->bi", rotation, middle)
        extent = np.einsum("bij,bj->bi", np.abs(rotation), half)
        extent = extent + geometry.radius.numpy()[large][:, None]
        return centre - extent, centre + extent

    def _link(self) -> None:
        """The pairs in which each body is the partner, in ascending order."""
        model, count = self._model, self.pair_count
        if count:
            wp.launch(
                incidence_keys,
                dim=count,
                inputs=[model.geometry, model.group_count, self.pairs],
                outputs=[self._keys, self.incidence.pair],
                device=model.device,
            )
            wp.utils.radix_sort_pairs(self._keys, self.incidence.pair, count)
        wp.launch(
            incidence_starts,
            dim=count + 1,
            inputs=[model.body_count, self._keys, count],
            outputs=[self.incidence],
            device=model.device,
        )

    def _carry(self, old: tuple[wp.array, ...]) -> None:
        if self.pair_count:
            wp.launch(
                history_kernel(self._model.features),
                dim=self.pair_count,
                inputs=[*old, self.pairs, self._state.cell],
                outputs=[self.candidates],
                device=self._model.device,
            )


def _copy(values: Any, count: int) -> wp.array:
    """Copy of the first ``count``; of at least one, and of no more than there are."""
    return wp.clone(values[: min(max(count, 1), len(values))])


def history_kernel(has: Features) -> wp.Kernel:
    """Kernel that carries what the contacts of a scene remember into new lists."""
    return carry_history(
        rolling=has.rolling,
        shares=has.partnership not in {"once", "sum"},
        last=has.avalanche,
        periodic=has.periodic,
        hot=has.hot_lists,
        braking=has.braking,
    )
