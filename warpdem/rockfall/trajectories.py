"""Flies bundles of trajectories on a device: many passes a launch, then compaction and refill."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import warp as wp

from warpdem.devices import find_device
from warpdem.kernels.fall_views import (
    Contact,
    Crossing,
    Iterates,
    Motion,
    Visit,
    Window,
)
from warpdem.kernels.fall_views import Flights as Slots
from warpdem.kernels.launching import begin, pack
from warpdem.kernels.precision import quat, wide, wide3
from warpdem.kernels.trajectory import advance
from warpdem.loading import load_kernels
from warpdem.rockfall.device import TRAVEL_CELLS, place_of
from warpdem.rockfall.endings import Endings
from warpdem.rockfall.flights import COUNTS, MEASURES, Fate
from warpdem.rockfall.samples import Sample, split

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from warpdem.arrays import IntArray
    from warpdem.rockfall.flights import Flights, Method, Starts
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site

CONTACT_ROOM = 16
"""Closed contacts a rock can have at once; of more the deepest, and the others are counted."""

PASSES = 512
"""Passes of a launch: some ten milliseconds for the slots of a host thread."""

VISIT_ROOM = 64
"""Visits that a launch may end before it stops; one pass may add ``PASS_VISITS`` more."""

PASS_VISITS = 2 * TRAVEL_CELLS + 8

CROSSING_ROOM = 16
"""The same for crossings; one pass may add one of each piece of a barrier."""

MOST_PIECES = 240
"""Pieces that one pass can cross; beyond that its crossings are counted as dropped."""


class Stopped(Exception):  # noqa: N818 - it is no fault
    """A bundle was given up because somebody asked for it."""


class Trajectories:
    """The trajectories of a site's rocks; one instance a host thread.

    Args:
        site: What they fall on.
        rocks: The rocks, in the order that ``Starts.rock`` counts.
        method: How they are stepped.
        device: A Warp device or its name.
        slots: Rocks in motion at once; results do not depend on it.
        passes: Of a launch; results do not depend on it either.
        visits: Whether to record the cells passed.
        fused: Whether multiplications and additions are fused on the CPU, which makes it a third
            faster. Without, what a site lacks does not change a bit of the motion; with, it rounds
            differently.
    """

    def __init__(
        self,
        site: Site,
        rocks: Sequence[Rock],
        method: Method,
        *,
        device: Any = "cpu",
        slots: int = 128,
        passes: int = PASSES,
        visits: bool = True,
        fused: bool = True,
    ) -> None:
        self.device = find_device(device) if isinstance(device, str) else device
        self._place = place_of(site, rocks, method, self.device, visits=visits, fused=fused)
        self._passes = passes
        self._room = slots
        self._slots = self._allocate(slots)
        ground = self._place.parts.ground
        self._begin, self._advance = begin(ground), advance(self._place.parts)

    def twin(self) -> Self:
        """Another one for another host thread, over the same site on the device."""
        other = copy.copy(self)
        other._slots = self._allocate(self._room)  # noqa: SLF001 - one of its own
        return other

    def load(self) -> None:
        """Load the kernels, compiling what the cache lacks."""
        slow_first = (self._advance, *reversed(self.kernels()))
        load_kernels(((kernel.key, kernel) for kernel in slow_first), self.device)

    def kernels(self) -> list[wp.Kernel]:
        """The kernels that trajectories over this site launch."""
        parts = self._place.parts
        packs = [pack(Visit)] * parts.visits + [pack(Crossing)] * parts.screens
        return [self._begin, self._advance, *packs]

    def fly(self, starts: Starts, *, stop: Callable[[], bool] | None = None) -> Flights:
        """Trajectories from their starts to their ends.

        Args:
            starts: The rocks; any number.
            stop: Asked between launches whether to give up.

        Raises:
            Stopped: ``stop`` said so.
            UnstableError: The motion of a rock ceased to be finite.
        """
        count = len(starts.id)
        ended = Endings(count, *(kind.numpy_dtype() for kind in (Motion, Visit, Crossing)))
        queue = np.arange(count)
        owner = np.full(self._room, -1)  # row of ``starts`` in each slot
        while True:
            free = np.flatnonzero(owner < 0)[: len(queue)]
            if len(free):
                owner[free] = queue[: len(free)]
                queue = queue[len(free) :]
                self._begin_in(free, starts, owner[free])
            active = np.flatnonzero(owner >= 0)
            if not len(active):
                return ended.flights(starts)
            if stop and stop():
                raise Stopped
            self._launch(active, self._passes)
            self._collect(active, owner, ended)

    def follow(self, starts: Starts, every: float) -> list[Sample]:
        """The ways of a few rocks, in samples at least ``every`` [s] apart, ends included."""
        rows = np.arange(len(starts.id))
        bundles = [rows[first : first + self._room] for first in range(0, len(rows), self._room)]
        return [sample for bundle in bundles for sample in self._follow(starts, bundle, every)]

    def _follow(self, starts: Starts, rows: IntArray, every: float) -> list[Sample]:
        """Samples of as many rocks as there are slots, pass by pass."""
        active = np.arange(len(rows))
        self._begin_in(active, starts, rows)
        kept, owner = [self._motion()[active].copy()], [active]
        last = np.zeros(len(rows))
        while len(active):
            self._launch(active, 1)
            self._slots.visit_count.zero_()
            self._slots.crossing_count.zero_()
            now = self._motion()[active]
            moving = self._slots.fate.numpy()[active] == Fate.MOVING
            due = ~moving | (now["time"] - last[active] >= every)
            last[active[due]] = now["time"][due]
            kept.append(now[due].copy())
            owner.append(active[due])
            active = active[moving]
        return split(np.concatenate(kept), np.concatenate(owner), len(rows))

    def _motion(self) -> np.ndarray:
        return self._slots.motion.numpy()

    def _allocate(self, slots: int) -> Slots:
        view, place = Slots(), self._place
        crossings = CROSSING_ROOM + min(place.piece_count, MOST_PIECES)
        shapes: dict[str, tuple[Any, tuple[int, ...]]] = {
            "rock": (wp.int32, (slots,)),
            "fate": (wp.int32, (slots,)),
            "motion": (Motion, (slots,)),
            "window": (Window, (slots,)),
            "count": (wp.int32, (slots, len(COUNTS))),
            "measure": (wide, (slots, len(MEASURES))),
            "percussion": (wide3, (slots, place.vertex_room)),
            "contact": (Contact, (slots, CONTACT_ROOM)),
            "iterates": (Iterates, (slots, CONTACT_ROOM)),
            "here": (Visit, (slots,)),
            "visit_count": (wp.int32, (slots,)),
            "crossing_count": (wp.int32, (slots,)),
        }
        if place.parts.visits:
            shapes["visit"] = (Visit, (slots, VISIT_ROOM + PASS_VISITS))
        if place.parts.screens:
            shapes["crossing"] = (Crossing, (slots, crossings))
        for name, (kind, shape) in shapes.items():
            setattr(view, name, wp.zeros(shape, dtype=kind, device=self.device))
        return view

    def _begin_in(self, slots: IntArray, starts: Starts, rows: IntArray) -> None:
        place, device = self._place, self.device
        orientation = starts.orientation[rows][:, [1, 2, 3, 0]]
        given = (
            wp.array(slots.astype(np.int32), dtype=wp.int32, device=device),
            wp.array(starts.rock[rows].astype(np.int32), dtype=wp.int32, device=device),
            wp.array(starts.position[rows], dtype=wide3, device=device),
            wp.array(orientation, dtype=quat, device=device),
            wp.array(starts.velocity[rows], dtype=wide3, device=device),
            wp.array(starts.spin[rows], dtype=wide3, device=device),
        )
        shared = (place.terrain, place.rocks, place.rules, place.grid)
        self._run(self._begin, len(slots), (*shared, *given, self._slots))

    def _launch(self, active: IntArray, passes: int) -> None:
        place = self._place
        self._active = wp.array(active.astype(np.int32), dtype=wp.int32, device=self.device)
        shared = (place.terrain, place.rocks, place.classes, place.obstacles, place.rules)
        given = (place.grid, passes, VISIT_ROOM, CROSSING_ROOM, self._active, self._slots)
        self._run(self._advance, len(active), (*shared, *given))

    def _collect(self, active: IntArray, owner: IntArray, ended: Endings) -> None:
        """Take what the rocks passed, and those that ended, off their slots."""
        if self._place.parts.visits:
            ended.visits.append(self._packed(Visit, "visit", active, owner))
        if self._place.parts.screens:
            ended.crossings.append(self._packed(Crossing, "crossing", active, owner))
        fate = self._slots.fate.numpy()
        done = active[fate[active] != Fate.MOVING]
        if len(done):
            rows = owner[done]
            ended.fate[rows] = fate[done]
            ended.motion[rows] = self._motion()[done]
            ended.count[rows] = self._slots.count.numpy()[done]
            ended.measure[rows] = self._slots.measure.numpy()[done]
            owner[done] = -1

    def _packed(
        self, kind: type, name: str, active: IntArray, owner: IntArray
    ) -> tuple[IntArray, np.ndarray]:
        """Rows of ``starts`` and the records of one kind of the last launch."""
        buffer, filled = getattr(self._slots, name), getattr(self._slots, f"{name}_count")
        counts = filled.numpy()[active]
        start = np.concatenate([[0], np.cumsum(counts)])
        total = int(start[-1])
        slot = wp.zeros(total, dtype=wp.int32, device=self.device)
        packed = wp.empty(total, dtype=kind, device=self.device)
        if total:
            first = wp.array(start[:-1].astype(np.int32), dtype=wp.int32, device=self.device)
            given = (self._active, first, buffer, filled, slot, packed)
            self._run(pack(kind), len(active), given)
        return owner[np.asarray(slot.numpy(), np.int64)], np.asarray(packed.numpy()).copy()

    def _run(self, kernel: wp.Kernel, count: int, arguments: tuple[Any, ...]) -> None:
        wp.launch(kernel, dim=count, inputs=list(arguments), device=self.device)
