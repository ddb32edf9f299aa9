"""Watches that the energy of a run does not grow."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import UnstableError
from warpdem.observe import balance_of, pair_energies, stored_by

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray
    from warpdem.guards import Instant
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

# energies are looked at after every so many steps, counted from the start
EVERY = 64


class EnergyGuard:
    """Holds the energy against its lowest value so far; does nothing where no scene asks for it.

    When it looks goes by the number of steps since the start, not by lists, threads or pauses.
    """

    def __init__(
        self, scene: Scene, names: Sequence[str], model: Model, state: State, lists: Lists
    ) -> None:
        self._chosen, self._names = scene.run.energy_guard, names
        self._parts = (model, state, lists)
        self._lowest, self._scale, self._told = inf, 0.0, 0.0
        self._own: FloatArray = np.zeros(model.body_count)

    def left(self, step: int, most: int) -> int:
        """Steps until it looks, ``most`` at the most."""
        return min(most, EVERY - step % EVERY) if self._chosen else most

    def look(self, now: Instant) -> list[str]:
        """A note, once, that the energy has grown, at the end of a whole step.

        Raises:
            UnstableError: It has, and the run is to stop then.
        """
        if not self._chosen or now.step % EVERY:
            return []
        moving, level = balance_of(*self._parts)
        self._scale = max(self._scale, moving)
        grown = level - self._lowest
        if grown <= 0.0:
            self._lowest, self._own = level, stored_by(*self._parts[:2])
        if self._told or not grown > self._chosen.growth * self._scale:
            return []
        self._told = 1.0
        body, words = self._who()
        told = (
            f"energy has grown by {grown:.3g} J, {grown / self._scale:.2g} of the largest kinetic "
            f"and elastic energy so far, at {now}; {words} gained most: lower run.dt (now "
            f"{now.dt:.3g} s), or raise run.energy_guard.growth"
        )
        if self._chosen.action == "note":
            return [told]
        raise UnstableError(told, body=body, time=now.time)

    def _who(self) -> tuple[str, str]:
        """The body that has gained most since the lowest energy, and what it presses on most."""
        model, state, lists = self._parts
        body = int(np.argmax(np.where(model.free, stored_by(model, state) - self._own, -inf)))
        name = self._names[body]
        owner, elastic = pair_energies(model, state, lists)
        partner = lists.pairs.partner.numpy()[: len(owner)]
        mine = np.flatnonzero(((owner == body) | (partner == body)) & (elastic > 0.0))
        if not len(mine):
            return name, f'body "{name}"'
        pair = mine[np.argmax(elastic[mine])]
        other = self._names[int(owner[pair] + partner[pair] - body)]
        return name, f'body "{name}", against "{other}",'

    def checkpoint(self) -> dict[str, np.ndarray]:
        """What it remembers; nothing where it does nothing."""
        if not self._chosen:
            return {}
        facts = np.array([self._lowest, self._scale, self._told])
        return {"energy_guard": facts, "energy_guard_own": self._own.copy()}

    def restore(self, saved: dict[str, np.ndarray]) -> None:
        """Take up what ``checkpoint`` gave."""
        if self._chosen:
            self._lowest, self._scale, self._told = map(float, saved["energy_guard"])
            self._own = saved["energy_guard_own"].copy()
