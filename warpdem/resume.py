"""Checkpoints: the arrays from which a run goes on bitwise, and putting them back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import warp as wp

from warpdem.observe import slots
from warpdem.periodic import KEPT
from warpdem.sleeping import KEPT as SLEEP

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.lists import Lists
    from warpdem.state import State

# of the bodies; the lists are made again where they were made, so that the next rebuild comes at
# the same step
BODIES = (
    "position",
    "orientation",
    "momentum",
    "angular_momentum",
    "force",
    "torque",
    "velocity",
    "spin",
    "velocity_end",
    "spin_end",
    "listed_position",
    "listed_orientation",
    "reach",
    "path",
    "braked",
)
# of the last force pass: of the pairs, and of the contacts that touched, packed
PAIRS = ("touching", "force", "torque", "torque_partner", "looked", "fastest")
TOUCHING = ("which", "normal", "point", "gap")
# of the contacts, where a law of the scene needs it
MEMORY = ("rolled", "share", "last")


def arrays(state: State, lists: Lists) -> dict[str, np.ndarray]:
    """Host copies of everything a step depends on."""
    saved = {name: getattr(state.bodies, name).numpy().copy() for name in BODIES}
    if state.cell.edges is not None:
        saved |= {f"cell_{name}": getattr(state.cell, name).numpy().copy() for name in KEPT}
    if state.bodies.sleep.asleep is not None:
        sleep = state.bodies.sleep
        saved |= {f"sleep_{name}": getattr(sleep, name).numpy().copy() for name in SLEEP}
    saved["drives_offset"] = state.drives.offset.numpy().copy()
    saved["drives_turn"] = state.drives.turn.numpy().copy()
    saved["work"] = state.account.work.numpy().copy()
    saved["body_power"] = state.account.body_power.numpy().copy()
    saved["spent"] = lists.spent.copy()
    n = lists.pair_count
    pairs, candidates = lists.pairs, lists.candidates
    saved["pair_owner"] = pairs.owner.numpy()[:n].copy()
    saved["pair_partner"] = pairs.partner.numpy()[:n].copy()
    saved["pair_account"] = state.account.pair.numpy()[:n].copy()
    saved["pair_power"] = state.account.power.numpy()[:n].copy()
    past = candidates.past.numpy()[: lists.candidate_count]
    kept = np.flatnonzero((past[:, 3] != -1.0) | past[:, :3].any(axis=1))
    start = pairs.start.numpy()[: n + 1]
    saved["contact_pair"] = (np.searchsorted(start, kept, side="right") - 1).astype(np.int64)
    saved["contact_code"] = candidates.code.numpy()[kept]
    saved["contact_past"] = past[kept]
    for name in MEMORY:
        kept_of = getattr(candidates, name).numpy()
        saved[f"contact_{name}"] = kept_of[kept] if len(kept_of) > 1 else kept_of[:0]
    for name in PAIRS:
        saved[f"pair_{name}"] = getattr(pairs, name).numpy()[:n].copy()  # torque: none of spheres
    place, _ = slots(lists)
    for name in TOUCHING:
        saved[f"touching_{name}"] = getattr(candidates, name).numpy()[place]
    return saved | (state.bonding.arrays() if state.bonding else {})


def put_back(
    state: State,
    lists: Lists,
    saved: dict[str, np.ndarray],
    *,
    orient: Callable[[], None],
    contacts: bool,
) -> None:
    """Restore what ``arrays`` gave, in a simulation of the same scene."""
    bodies = state.bodies
    for name in BODIES:
        getattr(bodies, name).assign(saved[name])
    if bodies.sleep.asleep is not None:
        for name in SLEEP:
            getattr(bodies.sleep, name).assign(saved[f"sleep_{name}"])
        bodies.sleep.deep.zero_()
    _restore_cell(state, saved, edges="cell_listed")
    state.drives.offset.assign(saved["drives_offset"])
    state.drives.turn.assign(saved["drives_turn"])
    state.account.work.assign(saved["work"])
    state.account.body_power.assign(saved["body_power"])
    if state.bonding:
        state.bonding.put_back_states(saved)
    if contacts:
        bodies.position.assign(saved["listed_position"])
        bodies.orientation.assign(saved["listed_orientation"])
        bodies.reach.assign(saved.get("reach_listed", saved["reach"]))
        orient()
        _relist(state, lists, saved)
        bodies.position.assign(saved["position"])
        bodies.orientation.assign(saved["orientation"])
        bodies.reach.assign(saved["reach"])
    _restore_cell(state, saved, edges="cell_edges")
    orient()
    if state.bonding and state.bonding.put_back(saved):
        state.clock.moved.fill_(1)


def _restore_cell(state: State, saved: dict[str, np.ndarray], *, edges: str) -> None:
    """Put back the periodic cell, if there is one, with the edges now or of the lists."""
    if "cell_edges" in saved:
        for name in KEPT:
            getattr(state.cell, name).assign(saved[f"cell_{name}"])
        state.cell.edges.assign(saved[edges])


def _relist(state: State, lists: Lists, saved: dict[str, np.ndarray]) -> None:
    """Make the lists where they were made, and lay into them what the contacts remember."""
    lists.rebuild(again=True)
    state.bodies.path.assign(saved["path"])
    _remember(lists, saved)
    _touch(lists, saved)
    lists.spent = saved["spent"].copy()
    n = lists.pair_count
    account = state.account
    for kept, values in ((account.pair, "pair_account"), (account.power, "pair_power")):
        if n and len(saved[values]) == n:
            wp.copy(kept, wp.array(saved[values], dtype=kept.dtype, device="cpu"))


def _touch(lists: Lists, saved: dict[str, np.ndarray]) -> None:
    """Put back what the last force pass found: it bounds the step, and shows in snapshots."""
    n = lists.pair_count
    if not n:
        return
    for name in PAIRS:
        values = saved[f"pair_{name}"]
        if len(values) == n:
            getattr(lists.pairs, name)[:n].assign(values)
    place, _ = slots(lists)
    for name in TOUCHING:
        values = getattr(lists.candidates, name)
        all_of = values.numpy().copy()
        all_of[place] = saved[f"touching_{name}"]
        values.assign(all_of)


def _remember(lists: Lists, saved: dict[str, np.ndarray]) -> None:
    """Lay the histories of the saved contacts into the new lists."""
    n = lists.pair_count
    count = lists.candidate_count
    if not count:
        return
    candidates = lists.candidates
    past = np.zeros((count, 4))
    past[:, 3] = -1.0
    start = lists.pairs.start.numpy()[: n + 1]
    code = candidates.code.numpy()[:count]
    place = np.empty(len(saved["contact_code"]), dtype=np.int64)
    for k, (pair, wanted) in enumerate(
        zip(saved["contact_pair"], saved["contact_code"], strict=True)
    ):
        first, last = start[pair], start[pair + 1]
        place[k] = first + np.searchsorted(code[first:last], wanted)
    past[place] = saved["contact_past"]
    candidates.past[:count].assign(past)
    for name in MEMORY:
        values = saved[f"contact_{name}"]
        if len(values):
            memory = np.zeros((count, *values.shape[1:]))
            memory[place] = values
            getattr(candidates, name)[:count].assign(memory)
