"""Runs cycles of stages: recorded graphs of many steps, one for each host thread."""

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

# steps between two looks at the clock; those after a halt cost launches that return at once
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
        self._graphs: dict[int, list[Any]] = {}
        self._generation = -1
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
            self._graphs.clear()
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

    def __len__(self) -> int:
        """Number of host threads."""
        return len(self._shares)

    def cycles(self, count: int) -> bool:
        """Run ``count`` cycles, or fewer where the clock halts: then False."""
        halted = self._shares[0].clock.halted
        while count > 0 and not halted.numpy()[0]:
            batch = BATCH if count >= BATCH else 1
            # on the CPU a launch takes 1 to 3 ms to record, and a graph 1 us more to launch
            recorded = 1 if self._model.device.is_cpu else batch
            graphs = self._graphs_of(recorded)
            if self._pool is None:
                repeat(graphs[0], batch // recorded)
            else:
                list(self._pool.map(repeat, graphs, [batch // recorded] * len(graphs)))
            count -= batch
        return not halted.numpy()[0]

    def close(self) -> None:
        """Let the host threads go."""
        if self._pool is not None:
            self._pool.shutdown()

    def _graphs_of(self, batch: int) -> list[Any]:
        if batch not in self._graphs:
            self._graphs[batch] = [self._record(stages, batch) for stages in self._stages]
        return self._graphs[batch]

    def _record(self, stages: Sequence[Stage], batch: int) -> Any:
        device = self._model.device
        with wp.ScopedCapture(device=device, force_module_load=False) as capture:
            for _ in range(batch):
                for stage in stages:
                    self._launch(stage, stage.over)
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
