"""Sleep of bodies at rest: who falls asleep at which steps, and what sleepers keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.kernels.falling_asleep import (
    carry_wrenches,
    choose_sleepers,
    deepen,
    end_powers,
    fall_asleep,
)
from warpdem.kernels.gathering import gather
from warpdem.kernels.precision import wide, wide3
from warpdem.kernels.views import Candidates, Pairs, Sleep

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.features import Features
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

# who falls asleep is asked after every so many steps: one, and whole batches of the stepper
EVERY = 129
# of a body, all that a run needs to go on
KEPT = ("asleep", "slow", "force", "torque", "allowed", "woken", "taken")


def sleep_of(scene: Scene, features: Features, still: np.ndarray, device: Any) -> Sleep:
    """Everybody awake; ``still``: fixed and not driven, shape [body_count] bool."""
    sleep = Sleep()
    chosen = scene.run.sleep
    if chosen is None or not features.sleeps:
        return sleep
    sleep.speed, sleep.after, sleep.tolerance = chosen.speed, chosen.after, chosen.tolerance
    count = len(still)
    sleep.asleep = wp.array(still.astype(np.int32), dtype=wp.int32, device=device)
    sleep.woken = wp.zeros(count, dtype=wp.int32, device=device)
    sleep.deep = wp.zeros(count, dtype=wp.int32, device=device)
    sleep.slow = wp.zeros(count, dtype=wide, device=device)
    sleep.taken = wp.zeros(count, dtype=wide, device=device)
    sleep.allowed = wp.full(count, -1.0, dtype=wide, device=device)
    sleep.force = wp.zeros(count, dtype=wide3, device=device)
    sleep.torque = wp.zeros(count, dtype=wide3, device=device)
    return sleep


def sleep_kernels(features: Features) -> dict[str, wp.Kernel]:
    """Kernels that work between steps, where bodies may sleep."""
    if not features.sleeps:
        return {}
    return {
        "choose sleepers": choose_sleepers,
        "fall asleep": _fall_asleep(features),
        "deepen": deepen,
        "end powers": end_powers,
        "carry wrenches": _carry_wrenches(features),
    }


def _fall_asleep(has: Features) -> wp.Kernel:
    return fall_asleep(gather(summed=has.single), acted=has.acted)


def _carry_wrenches(has: Features) -> wp.Kernel:
    return carry_wrenches(packed=not has.single, account=has.account)


class Sleeping:
    """Has bodies fall asleep; does nothing where the scene lets none.

    When it is asked goes by the number of steps since the start, not by lists, threads or pauses.
    """

    def __init__(self, model: Model, state: State, lists: Lists) -> None:
        self._model, self._state, self._lists = model, state, lists
        self._may = model.features.sleeps

    def left(self, step: int, most: int) -> int:
        """Steps until somebody may fall asleep, ``most`` at the most."""
        return min(most, EVERY - step % EVERY) if self._may else most

    def settle(self, step: int, dt: float) -> None:
        """At the end of a whole step: let fall asleep who may."""
        if not self._may or step % EVERY:
            return
        model, state, lists = self._model, self._state, self._lists
        moved = [state.bodies]
        known = [lists.pairs, lists.incidence]
        choice = [model.geometry, model.inertia, wide3(*model.gravity), *known]
        self._launch(choose_sleepers, model.body_count, choice, moved)
        told = [*moved, state.account]
        self._launch(_fall_asleep(model.features), model.body_count, [model.inertia, *known], told)
        self._launch(deepen, model.body_count, [1, *known], moved)
        if model.features.account and lists.pair_count:
            ended = [dt, lists.pairs, *moved]
            self._launch(end_powers, lists.pair_count, ended, [state.account])

    def facts(self) -> dict[str, Any]:
        """How many free bodies sleep, how often one was woken, kinetic energy taken [J]."""
        if not self._may:
            return {}
        sleep = self._state.bodies.sleep
        return {
            "asleep": int(sleep.asleep.numpy()[self._model.free].sum()),
            "woken": int(sleep.woken.numpy().sum()),
            "energy_taken_by_sleep": float(sleep.taken.numpy().sum()),
        }

    def _launch(self, kernel: wp.Kernel, count: int, inputs: list[Any], outputs: list[Any]) -> None:
        wp.launch(kernel, dim=count, inputs=inputs, outputs=outputs, device=self._model.device)


def keep_wrenches(model: Model, state: State, lists: Lists) -> Callable[[], None]:
    """Copy what pairs exert now; what is returned lays it into lists made since."""
    has, count, length = model.features, lists.pair_count, lists.candidate_count
    if not has.sleeps:
        return lambda: None
    old, before = Pairs(), Candidates()
    names = ["partner", "touching", "force", "torque_partner"]
    if not has.single:
        names += ["torque", "start"]
        for name in ("code", "which", "normal", "point", "gap"):
            setattr(before, name, _copy(getattr(lists.candidates, name), length))
    for name in names:
        setattr(old, name, _copy(getattr(lists.pairs, name), count))
    known = [wp.clone(lists.ends), old, before, wp.clone(state.account.pair), state.bodies]

    def carry() -> None:
        now = [lists.pairs, lists.candidates, state.account]
        kernel, device = _carry_wrenches(has), model.device
        wp.launch(kernel, dim=lists.pair_count, inputs=known, outputs=now, device=device)
        inputs = [0, lists.pairs, lists.incidence]
        wp.launch(
            deepen, dim=model.body_count, inputs=inputs, outputs=[state.bodies], device=device
        )

    return carry


def _copy(values: Any, count: int) -> wp.array:
    """Copy of the first ``count``, one at least."""
    return wp.clone(values[: max(count, 1)])


def note_of(scene: Scene) -> list[str]:
    """What sleep neglects, in words."""
    if scene.run.sleep is None:
        return []
    chosen = scene.run.sleep
    note = (
        f"run.sleep neglects motion below {chosen.speed:.3g} m/s that lasts {chosen.after:.3g} s, "
        f"and changes of contact forces by less than {chosen.tolerance:.3g} of a body's weight or "
        "largest contact force; the kinetic energy it takes counts as lost in dashpots"
    )
    return [note]
