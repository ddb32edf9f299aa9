"""Runs cycles of stages: a recorded loop of steps for each host thread."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.kernels.cell import CHUNKS
from warpdem.stages import Stage, cycle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import Share, State

# steps between two looks at the clock where a device cannot loop by itself
BATCH = 16
# a pair costs about as much as so many of its candidates
PAIR_COST = 8


class Stepper:
    """Moves the state over whole cycles; host threads each take a share of every stage.

    What a share computes does not depend on where it is cut, so the result does not depend on the
    number of threads. On CUDA there is one share, the whole.
    """

    def __init__(
        self, model: Model, state: State, lists: Lists, shares: Sequence[Share], dt: float
    ) -> None:
        self._model = model
        self._lists = lists
        self._interface_count = len(state.bonding) if state.bonding else 0
        self._shares = shares
        self._stages = [cycle(model, state, lists, share, dt) for share in shares]
        self._graphs: list[Any] = []
        self._generation = -1
        # the device goes on by itself, with no look from the host, until it is done or halts
        self._loops = model.device.is_cpu or wp.is_conditional_graph_supported()
        self._pool = ThreadPoolExecutor(len(shares)) if len(shares) > 1 else None
        self.prepare()

    def prepare(self) -> None:
        """Cut new lists into shares of equal work; forget graphs whose arrays were replaced."""
        lists = self._lists
        cuts = self._cuts()
        for share, first, last in zip(self._shares, cuts[:-1], cuts[1:], strict=True):
            share.pairs.assign(np.array([first, last], dtype=np.int32))
            share.clock.halted.zero_()
        if lists.generation != self._generation:
            self._graphs = []
            self._generation = lists.generation

    def _cuts(self) -> np.ndarray:
        """Where the shares of the pair kernel begin and end: in pairs, or in their owners."""
        lists, members = self._lists, len(self._shares)
        single = self._model.features.single
        count = self._model.body_count if single else lists.pair_count
        if members == 1 or not lists.pair_count:
            return np.array([0, *[count] * members])
        if single:
            work = np.concatenate([[0], lists.ends.numpy()])
        else:
            work = lists.pairs.start.numpy()[: count + 1]
        cost = work + PAIR_COST * np.arange(count + 1)
        cuts = np.searchsorted(cost, np.linspace(0, cost[-1], members + 1))
        cuts[0], cuts[-1] = 0, count
        return cuts

    @property
    def steps(self) -> int:
        """Number of steps done so far, by whomever."""
        return int(self._shares[0].clock.steps.numpy()[0])

    def __len__(self) -> int:
        """Number of host threads."""
        return len(self._shares)

    def cycles(self, count: int) -> bool:
        """Run ``count`` cycles, or fewer where the clock halts: then False."""
        halted = self._shares[0].clock.halted
        while count > 0 and not halted.numpy()[0]:
            turns = count if self._loops else min(count, BATCH)
            self._set_clocks(turns)
            self._graphs = self._graphs or [
                self._record(stages, share)
                for stages, share in zip(self._stages, self._shares, strict=True)
            ]
            each = 1 if self._loops else turns
            if self._pool is None:
                repeat(self._graphs[0], each)
            else:
                list(self._pool.map(repeat, self._graphs, [each] * len(self._graphs)))
            count -= turns
        return not halted.numpy()[0]

    def _set_clocks(self, turns: int) -> None:
        """All threads count from the same step, as many cycles as they are to do."""
        steps = self._shares[0].clock.steps.numpy()[0]
        for share in self._shares:
            share.clock.steps.fill_(steps)
            share.clock.left.fill_(turns)
            share.clock.going.fill_(1)

    def close(self) -> None:
        """Let the host threads go."""
        if self._pool is not None:
            self._pool.shutdown()

    def _record(self, stages: Sequence[Stage], share: Share) -> Any:
        """Graph of a loop over the stages, or of one turn of it."""

        def turn() -> None:
            for stage in stages:
                self._launch(stage, stage.over)

        with wp.ScopedCapture(device=self._model.device, force_module_load=False) as capture:
            if self._loops:
                wp.capture_while(share.clock.going, turn)
            else:
                turn()
        return capture.graph

    def _launch(self, stage: Stage, over: str) -> None:
        model = self._model
        room = {"bodies": model.body_count, "pairs": self._lists.pair_room}
        room |= {"interfaces": self._interface_count, "gauges": len(model.gauges)}
        room |= {"chunks": CHUNKS, "one": 1}
        launch(stage, room[over], model.device)


def repeat(graph: Any, count: int) -> None:
    """Launch a graph so many times."""
    for _ in range(count):
        wp.capture_launch(graph)


def launch(stage: Stage, count: int, device: Any) -> None:
    """Launch a stage; threads beyond its share return at once."""
    if count:
        wp.launch(stage.kernel, dim=count, inputs=list(stage.arguments), device=device)
