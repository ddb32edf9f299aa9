"""What ends a run that has ceased to be physical: numbers that are none, bodies that go through."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import warp as wp

from warpdem.errors import Problem, SceneError, UnstableError
from warpdem.kernels.guarding import find_unsound, measure_depths, measure_rush
from warpdem.kernels.precision import wide
from warpdem.periodic import flow

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.arrays import FloatArray
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

THROUGH = 0.75
"""Part of the way to the middle of the other from which a body is taken to go through it."""

AT_START = 0.5
"""The same of bodies that overlap before anything has moved."""

STRIDE = 0.25
"""Longest way of two bodies towards each other in a step, in parts of that way."""

SLOWEST = 1e-12
"""Part of the duration below which a step is not lowered any more."""

AWAY = 'move them apart, let [run.relax] do it, or set run.overlap = "note"'
"""What to do about bodies that overlap at the start."""

QUANTITIES = {
    "position": "position",
    "orientation": "orientation of length one",
    "velocity": "velocity",
    "spin": "spin",
    "momentum": "momentum",
    "angular_momentum": "angular momentum",
    "force": "force",
    "torque": "torque",
}
"""What a body has, in words."""


class Instant(NamedTuple):
    """When a guard looks.

    Attributes:
        time: Simulated time [s].
        step: Number of steps done.
        dt: Time step [s].
    """

    time: float
    step: int
    dt: float

    def __str__(self) -> str:
        return f"t = {self.time:.9g} s (step {self.step})"


class Guards:
    """Looks at a simulation when its lists are renewed, and at the ends of its stretches.

    Args:
        scene: What is simulated.
        names: Of the bodies.
        model, state, lists: What it looks at.
    """

    def __init__(
        self, scene: Scene, names: Sequence[str], model: Model, state: State, lists: Lists
    ) -> None:
        self._scene, self._names = scene, names
        self._model, self._state, self._lists = model, state, lists
        self._told: set[tuple[int, int]] = set()
        self._unsound = wp.zeros(1, dtype=wp.int32, device=model.device)

    def look(self, now: Instant) -> list[str]:
        """Notes on cores that have met, each pair once.

        Raises:
            UnstableError: A state is no number; or bodies go through each other.
            SceneError: They overlap so far before the first step.
        """
        self._look_at_numbers(now)
        depths = measured_depths(self._model, self._lists)
        if len(depths):
            self._look_at_depths(depths[:, 0], now)
        return [self._sunk(pair, now) for pair in self._untold(depths)]

    def step_limit(self, now: Instant, *, may_lower: bool) -> float:
        """Longest step in which nobody goes far into what the lists say it may meet [s].

        Raises:
            UnstableError: The step is longer, and given; or none is short enough.
        """
        rush = self._rush()
        pair = int(np.argmax(rush)) if len(rush) else 0
        if not len(rush) or rush[pair] * now.dt <= STRIDE:
            return inf
        limit = STRIDE / float(rush[pair])
        if may_lower and limit > SLOWEST * self._scene.run.duration:
            return limit
        if self._scene.run.overlap == "note":
            return inf
        first, second = self._pair(pair)
        raise UnstableError(
            f'bodies "{first}" and "{second}" move towards each other by '
            f"{rush[pair] * now.dt:.3g} times the way to the middle of the thinner in one step at "
            f"{now}, and may go through each other: lower run.dt (now {now.dt:.3g} s) to "
            f'{0.99 * limit:.2g} s, or set it to "auto"; run.overlap = "note" goes on',
            body=first,
            time=now.time,
        )

    def name_fault(self, now: Instant) -> None:
        """Raise that a body flew off, or has no velocity, with its name."""
        self._look_at_numbers(now)
        model, bodies = self._model, self._state.bodies
        speed = np.linalg.norm(bodies.velocity.numpy() - flow(model, self._state), axis=1)
        turn = np.linalg.norm(bodies.spin.numpy(), axis=1)
        reach = np.where(model.free, (speed + 0.3 * turn * model.bound) * now.dt / model.bound, 0.0)
        body = int(np.argmax(reach))
        self._stop(body, f"moves {reach[body]:.3g} times its own size in one step", now)

    def _stop(self, body: int, what: str, now: Instant) -> None:
        name = self._names[body]
        raise UnstableError(
            f'body "{name}" {what} at {now}; '
            f"lower run.dt (now {now.dt:.3g} s) or the stiffness, or look for bodies that overlap "
            f"at the start",
            body=name,
            time=now.time,
        )

    def _look_at_numbers(self, now: Instant) -> None:
        self._unsound.zero_()
        inputs, outputs = [self._state.bodies], [self._unsound]
        _launch(find_unsound, self._model.body_count, inputs, outputs, self._model.device)
        if not self._model.body_count or not self._unsound.numpy()[0]:
            return
        bodies = self._state.bodies
        for name, words in QUANTITIES.items():
            values = getattr(bodies, name).numpy()
            with np.errstate(all="ignore"):
                bad = ~np.isfinite(np.abs(values).sum(axis=1))
                if name == "orientation":
                    bad |= ~(np.abs((values**2).sum(axis=1) - 1.0) <= 1e-6)
            if bad.any():
                self._stop(int(np.argmax(bad)), f"has no finite {words} (NaN)", now)

    def _look_at_depths(self, depths: FloatArray, now: Instant) -> None:
        limit = THROUGH if now.step else AT_START
        deep = np.flatnonzero(depths > limit)
        if not len(deep) or self._scene.run.overlap == "note":
            return
        deep = deep[np.argsort(-depths[deep], kind="stable")].tolist()
        if not now.step:
            self.refuse(depths, limit, AWAY)
        first, second = self._pair(deep[0])
        raise UnstableError(
            f'bodies "{first}" and "{second}" overlap by {self._overlap(deep[0]):.3g} m, '
            f"{depths[deep[0]]:.2g} of the way to the middle of the thinner, at {now}: they go "
            f"through each other; raise kn of their contact, lower their speeds, or make the "
            f'thinner one thicker; run.overlap = "note" goes on',
            body=first,
            time=now.time,
        )

    @property
    def _file(self) -> str:
        return str(self._scene.source or "scene")

    def _overlapping(self, pair: int, way: str = AWAY) -> Problem:
        first, second = self._pair(pair)
        rule = f'"{first}" and "{second}" overlap by {self._overlap(pair):.3g} m at the start'
        return Problem(self._file, "", f"{rule}: {way}")

    def refuse(self, depths: FloatArray, limit: float, way: str) -> None:
        """Raise that bodies overlap by more than ``limit`` of their room, the deepest first."""
        deep = np.flatnonzero(depths > limit)
        deep = deep[np.argsort(-depths[deep], kind="stable")].tolist()
        raise SceneError(self._file, [self._overlapping(pair, way) for pair in deep])

    def _untold(self, depths: FloatArray) -> Iterator[int]:
        met = np.flatnonzero(depths[:, 1] > 0.0) if len(depths) else np.zeros(0, int)
        for pair in met.tolist():
            key = self._bodies(pair)
            if key not in self._told:
                self._told.add(key)
                yield pair

    def _sunk(self, pair: int, now: Instant) -> str:
        first, second = self._pair(pair)
        mend = "raise kn, or the rounding" if now.step else "move them apart"
        return (
            f'bodies "{first}" and "{second}" overlap by {self._overlap(pair):.3g} m at '
            f"t = {now.time:.4g} s, more than their roundings: {mend}"
        )

    def _bodies(self, pair: int) -> tuple[int, int]:
        pairs = self._lists.pairs
        return int(pairs.owner.numpy()[pair]), int(pairs.partner.numpy()[pair])

    def _pair(self, pair: int) -> tuple[str, str]:
        owner, partner = self._bodies(pair)
        return self._names[owner], self._names[partner]

    def _overlap(self, pair: int) -> float:
        pairs = self._lists.pairs
        start, count = (int(values.numpy()[pair]) for values in (pairs.start, pairs.touching))
        return float(-self._lists.candidates.gap.numpy()[start : start + count].min(initial=0.0))

    def _rush(self) -> FloatArray:
        """Speed of each pair over its room [1/s], shape [pair_count]."""
        lists, model, state = self._lists, self._model, self._state
        count = lists.pair_count
        found = wp.empty(count, dtype=wide, device=model.device)
        inputs = [model.geometry, model.room, state.bodies, lists.pairs, state.cell]
        kernel = measure_rush(periodic=model.features.periodic)
        _launch(kernel, count, inputs, [found], model.device)
        return np.asarray(found.numpy(), dtype=float)


def measured_depths(model: Model, lists: Lists) -> FloatArray:
    """Depth of each pair over its room, and less its roundings [m], shape [pair_count, 2]."""
    count = lists.pair_count
    kind: Any = wp.vec2d
    found = wp.empty(count, dtype=kind, device=model.device)
    inputs = [model.geometry, model.room, lists.pairs, lists.candidates]
    _launch(measure_depths, count, inputs, [found], model.device)
    return np.asarray(found.numpy(), dtype=float).reshape(count, 2)


def _launch(
    kernel: wp.Kernel, count: int, inputs: list[Any], outputs: list[Any], device: Any
) -> None:
    if count:
        wp.launch(kernel, dim=count, inputs=inputs, outputs=outputs, device=device)
