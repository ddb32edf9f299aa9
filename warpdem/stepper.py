"""Runs the stages: one recorded graph of many steps, or host threads that share each stage."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import warp as wp

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.lists import Lists
    from warpdem.stages import Stage
    from warpdem.state import State

# steps in one recorded graph; those after a halt cost a launch that returns at once
BATCH = 16


class Stepper(Protocol):
    """Moves the state over whole cycles of stages."""

    def prepare(self) -> None:
        """Take note of new lists."""

    def cycles(self, count: int) -> None:
        """Run up to ``count`` cycles; fewer when the clock halts."""


def launch(stage: Stage, count: int, device: Any) -> None:
    """Launch a stage over all its threads."""
    if count:
        wp.launch(stage.kernel, dim=count, inputs=list(stage.arguments), device=device)


class Recorded:
    """One launch a stage, recorded: the CPU's default for small scenes, and CUDA's only way."""

    def __init__(
        self, stages: Sequence[Stage], lists: Lists, state: State, body_count: int, device: Any
    ) -> None:
        self._stages = stages
        self._lists = lists
        self._state = state
        self._body_count = body_count
        self._device = device
        self._graphs: dict[int, Any] = {}
        self._recorded = (-1, -1)

    def prepare(self) -> None:
        """Forget graphs whose arrays were replaced or whose room for pairs no longer fits."""
        room = self._lists.pairs.owner.shape[0]
        key = (self._lists.generation, room)
        if key != self._recorded:
            self._graphs.clear()
            self._recorded = key

    def cycles(self, count: int) -> None:
        """Replay batches of cycles."""
        while count > 0 and not self._state.clock.halted.numpy()[0]:
            batch = BATCH if count >= BATCH else 1
            wp.capture_launch(self._graph(batch))
            count -= batch

    def _graph(self, batch: int) -> Any:
        if batch not in self._graphs:
            with wp.ScopedCapture(device=self._device, force_module_load=False) as capture:
                for _ in range(batch):
                    for stage in self._stages:
                        launch(stage, self._extent(stage), self._device)
            self._graphs[batch] = capture.graph
        return self._graphs[batch]

    def _extent(self, stage: Stage) -> int:
        if stage.over == "bodies":
            return self._body_count
        return self._recorded[1] if stage.over == "pairs" else 1


class Crew:
    """Host threads that each take a range of every stage and meet between stages.

    A thread takes the same bodies in every stage, so no barrier is needed between two stages over
    bodies. What a range computes does not depend on where it is cut.
    """

    def __init__(
        self, stages: Sequence[Stage], lists: Lists, state: State, body_count: int, threads: int
    ) -> None:
        self._stages = [stage for stage in stages if stage.over != "one"]
        self._lists = lists
        self._state = state
        self._threads = threads
        self._barrier = threading.Barrier(threads)
        bodies = np.linspace(0, body_count, threads + 1).astype(int)
        self._cuts = {"bodies": bodies, "pairs": np.zeros(threads + 1, dtype=int)}
        self._commands: list[list[Any]] = []

    def prepare(self) -> None:
        """Cut the pairs into ranges of equal numbers of candidates, and record the launches."""
        lists = self._lists
        starts = lists.pairs.start.numpy()[: lists.pair_count + 1]
        # a pair costs about as much as eight of its candidates
        cost = starts + 8 * np.arange(len(starts))
        targets = np.linspace(0, cost[-1], self._threads + 1)
        self._cuts["pairs"] = np.searchsorted(cost, targets).clip(0, lists.pair_count)
        self._cuts["pairs"][-1] = lists.pair_count
        self._commands = [self._record(k) for k in range(self._threads)]

    def _record(self, thread: int) -> list[Any]:
        commands = []
        for stage in self._stages:
            cuts = self._cuts[stage.over]
            first, last = int(cuts[thread]), int(cuts[thread + 1])
            if first == last:
                commands.append(None)
                continue
            arguments = list(stage.arguments)
            arguments[stage.first] = first
            command = wp.launch(
                stage.kernel, dim=last - first, inputs=arguments, device="cpu", record_cmd=True
            )
            commands.append(command)
        return commands

    def cycles(self, count: int) -> None:
        """Run cycles in all threads until done or a body left its skin."""
        done = [0] * self._threads
        failures: list[BaseException] = []

        def work(thread: int) -> None:
            try:
                done[thread] = self._work(self._commands[thread], count)
            except threading.BrokenBarrierError:
                pass
            except BaseException as failure:  # noqa: BLE001  # handed to the caller
                failures.append(failure)
                self._barrier.abort()

        others = [threading.Thread(target=work, args=(k,)) for k in range(1, self._threads)]
        for other in others:
            other.start()
        work(0)
        for other in others:
            other.join()
        if failures:
            raise failures[0]
        clock = self._state.clock
        clock.steps.numpy()[0] += done[0]
        if clock.moved.numpy()[0] or clock.fault.numpy()[0]:
            clock.halted.fill_(1)

    def _work(self, commands: list[Any], count: int) -> int:
        """One thread's part of the cycles; returns how many were run."""
        flags = self._state.clock.moved.numpy(), self._state.clock.fault.numpy()
        kinds = [stage.over for stage in self._stages]
        # after a stage over pairs its readers wait, after the last stage the next cycle does
        waits = [kind == "pairs" or k == len(kinds) - 1 for k, kind in enumerate(kinds)]
        for cycle in range(count):
            for command, wait in zip(commands, waits, strict=True):
                if command is not None:
                    command.launch()
                if wait:
                    self._barrier.wait()
            if flags[0][0] or flags[1][0]:
                return cycle + 1
        return count
