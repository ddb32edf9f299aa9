"""Which time step comes next: powers of two times the first one."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.timestep import (
    LARGEST_ADVANCE,
    LARGEST_TURN,
    SHARE_OF_BOUND,
    STEPS_IN_CONTACT,
    contact_time,
    foreseen,
    masses,
)
from warpdem.driving.rates import period_limit

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.driving.plan import Plan
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

ROOM = 0.9
"""A step twice as long must be below so much of its limit, lest it comes and goes."""

QUIET = 1e-4
"""Overlap that a pair's speed amounts to, in bounding radii of the smaller, below which contacts
need be stable only, not resolved in time: what is at rest is there at any step."""

EVERY = 1024
"""Steps after which lists are renewed to choose the step, counted from the start, where it adapts:
what is at rest would keep them for ever."""

AHEAD = 2.0
"""Lists are renewed so many steps before a body has gone as far as they reach."""


class Pacing:
    """Chooses the next step when lists have been renewed.

    By default the step never grows: under ``dt = "auto"`` it is halved where contacts or speeds ask
    for that. With ``run.adaptive_dt`` it also grows while nothing in the lists is as quick to
    respond as what it was chosen for; nothing touches in a step that is longer than its own
    contacts allow, as lists then are renewed a step or two early.

    Args:
        scene, placement, polyhedra, plan: What is simulated.
        base: The first step [s].
        contacts: Bodies can touch; where none can no step changes.
    """

    def __init__(
        self,
        scene: Scene,
        placement: Placement,
        polyhedra: Mapping[str, Polyhedron],
        plan: Plan,
        base: float,
        *,
        contacts: bool,
    ) -> None:
        self._scene, self._base = scene, base
        self.adapts = scene.run.adaptive_dt and contacts
        self.lowers = scene.run.dt == "auto" or self.adapts
        self._share = SHARE_OF_BOUND if scene.run.dt == "auto" else 1.0
        self.listed = np.zeros(0)
        if self.adapts:
            self._own = SHARE_OF_BOUND * foreseen(scene, placement, polyhedra)
            self._mass = masses(placement, polyhedra)[0]
            self._stiffness = _stiffness(scene, placement)
            self._group = placement.group
            self._longest = min(scene.frame_interval, period_limit(plan, scene.run.duration))
            self._turns = _turning(placement, polyhedra)
            self._fall = float(np.linalg.norm(scene.gravity.vector))

    def left(self, step: int, most: int) -> int:
        """Steps until lists have to be renewed, ``most`` at the most."""
        return min(most, EVERY - step % EVERY) if self.adapts else most

    def due(self, step: int) -> bool:
        """Whether they have to be after so many steps."""
        return self.adapts and step % EVERY == 0

    def next(self, dt: float, limit: float) -> float:
        """The step after ``dt`` that no contact and no speed forbids: ``limit`` [s]."""
        while self.lowers and dt > limit:
            dt *= 0.5
        return dt

    def contact_limit(self, bound: float) -> float:
        """Longest step for contacts of which ``bound`` is the stability bound [s]."""
        return self._share * bound if self.lowers else inf

    def grown(self, dt: float, limit: float, model: Model, state: State, lists: Lists) -> float:
        """The next step, which may be longer, and ``reach`` for it.

        Args:
            dt: The next step, as far as ``limit`` is concerned [s].
            limit: What the contacts that touch, and speeds, allow [s].
            model: Of the bodies.
            state: Theirs, at this instant.
            lists: Just made.
        """
        reach = state.bodies.reach.numpy()
        pace = _pace(model, state)
        fastest = pace + np.sqrt(2.0 * self._fall * np.where(np.isfinite(reach), reach, 0.0))
        far, near = self._far(model, state, reach, fastest), self._near(lists, model, state)
        while dt > max(self._base, min(limit, far, near)):
            dt *= 0.5
        if 2.0 * dt <= min(ROOM * limit, ROOM * far, near) or (
            dt < self._base and 2.0 * dt <= ROOM * limit
        ):
            dt *= 2.0
        self.listed = reach.copy()
        if dt > self._base:
            early = np.maximum(reach - AHEAD * fastest * dt, 0.0)
            state.bodies.reach.assign(np.where(model.free, early, reach))
        return dt

    def _far(self, model: Model, state: State, reach: FloatArray, fastest: FloatArray) -> float:
        """Longest step of bodies that nothing touches [s]."""
        free = model.free
        speed = np.linalg.norm(state.bodies.velocity.numpy(), axis=1)[free]
        turn = np.linalg.norm(state.bodies.spin.numpy(), axis=1)[free & self._turns]
        with np.errstate(divide="ignore", invalid="ignore"):
            seen = np.nan_to_num(reach / (2.0 * AHEAD * fastest), nan=inf, posinf=inf)
            ahead = LARGEST_ADVANCE * model.bound[free] / speed
        turned = LARGEST_TURN / turn.max(initial=1e-300)
        least = min(seen[free].min(initial=inf), ahead.min(initial=inf))
        return float(min(self._longest, turned, least))

    def _near(self, lists: Lists, model: Model, state: State) -> float:
        """Longest step for contacts that may come before the lists are renewed [s]."""
        n = lists.pair_count
        start = lists.pairs.start.numpy()[: n + 1]
        near = np.flatnonzero(np.diff(start) > 0)
        if not len(near):
            return inf
        i, j = lists.pairs.owner.numpy()[near], lists.pairs.partner.numpy()[near]
        effective = 1.0 / (1.0 / self._mass[i] + 1.0 / self._mass[j])
        softness = effective / self._stiffness[self._group[i], self._group[j]]
        velocity, turning = state.bodies.velocity.numpy(), _turning_speed(model, state)
        towards = np.linalg.norm(velocity[i] - velocity[j], axis=1) + turning[i] + turning[j]
        overlap = towards * np.sqrt(softness)
        loud = softness[overlap > QUIET * np.minimum(model.bound[i], model.bound[j])]
        shortest = contact_time(1.0, float(loud.min(initial=inf))) / STEPS_IN_CONTACT
        return float(min(shortest, self._own[i].min(), self._own[j].min()))


def _pace(model: Model, state: State) -> FloatArray:
    """Speed of the farthest point of each body [m/s]."""
    speed = np.linalg.norm(state.bodies.velocity.numpy(), axis=1)
    return speed + _turning_speed(model, state)


def _turning_speed(model: Model, state: State) -> FloatArray:
    """Speed of the farthest point of each body about its centre [m/s]."""
    return model.bound * np.linalg.norm(state.bodies.spin.numpy(), axis=1)


def _turning(placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> BoolArray:
    """Bodies whose turning has to be followed: all but those with a ball's inertia."""
    moments = [shape.inertia_over_mass for shape in polyhedra.values()]
    turns = [bool(np.ptp(own) > 1e-9 * own[0]) for own in moments]
    return np.array(turns, dtype=bool)[placement.shape]


def _stiffness(scene: Scene, placement: Placement) -> FloatArray:
    """Normal stiffness of each two groups [N/m], shape [group_count, group_count]."""
    groups = placement.groups
    stiffness = np.zeros((len(groups), len(groups)))
    for (a, b), law in scene.contact_table(groups).items():
        stiffness[groups.index(a), groups.index(b)] = law.kn
    return np.where(stiffness > 0.0, stiffness, 1e-300)
