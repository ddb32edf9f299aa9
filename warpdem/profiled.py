"""A simulation that runs stage by stage and times each; what it computes is the same."""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

import warp as wp

from warpdem.simulation import Simulation
from warpdem.stepper import BATCH, Stepper

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from warpdem.input.scene import Scene
    from warpdem.running.profile import Profile
    from warpdem.snapshot import Snapshot
    from warpdem.stages import Stage
    from warpdem.state import Share


class ProfilingStepper(Stepper):
    """A stepper with a graph of each stage; host threads each time their own.

    The times of several threads are averaged, so that they add up to what has passed.
    """

    def __init__(self, profile: Profile, *given: Any) -> None:
        self._profile = profile
        super().__init__(*given)
        self._loops = False

    def cycles(self, count: int) -> bool:
        """Run ``count`` cycles, or fewer where the clock halts: then False."""
        halted = self._shares[0].clock.halted
        while count > 0 and not halted.numpy()[0]:
            batch = min(count, BATCH)
            self._set_clocks(batch)
            self._graphs = self._graphs or [
                self._record_each(stages, share)
                for stages, share in zip(self._stages, self._shares, strict=True)
            ]
            if self._pool is None:
                runs = [self._run(self._graphs[0], batch)]
            else:
                runs = list(self._pool.map(self._run, self._graphs, [batch] * len(self._graphs)))
            self._note(runs)
            count -= batch
        return not halted.numpy()[0]

    def _run(self, graphs: Sequence[Any], batch: int) -> tuple[int, list[float]]:
        """Cycles done, and seconds of each stage in them."""
        spent = [0.0] * len(graphs)
        halted = self._shares[0].clock.halted
        # threads meet in each cycle: none may stop before the others
        alone = self._pool is None
        for done in range(batch):
            if alone and halted.numpy()[0]:
                return done, spent
            before = time.perf_counter()
            for stage, graph in enumerate(graphs):
                wp.capture_launch(graph)
                self._profile.settle()
                now = time.perf_counter()
                spent[stage] += now - before
                before = now
        return batch, spent

    def _note(self, runs: Sequence[tuple[int, list[float]]]) -> None:
        members = len(self._shares)
        for member, (stages, (done, spent)) in enumerate(zip(self._stages, runs, strict=True)):
            for stage, seconds in zip(stages, spent, strict=True):
                self._profile.add(stage.name, seconds / members, 0 if member else done)

    def _record_each(self, stages: Sequence[Stage], share: Share) -> list[Any]:
        with self._profile.span("recording"):
            return [self._record([stage], share) for stage in stages]


class ProfiledSimulation(Simulation):
    """A simulation that tells a profile where its time goes."""

    def __init__(
        self,
        scene: Scene,
        *,
        profile: Profile,
        device: str | None = None,
        threads: int | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> None:
        self._profile = profile
        self.stepper = partial(ProfilingStepper, profile)

        def tell(text: str) -> None:
            profile.lap(text)
            if progress:
                progress(text)

        super().__init__(scene, device=device, threads=threads, progress=tell)
        profile.lap("")

    def advance(self, until: float, *, stop: Callable[[], bool] | None = None) -> None:
        """As of a simulation."""
        with self._profile.span("steps"):
            super().advance(until, stop=stop)
        self._profile.sample(self._counts())

    def snapshot(self, *, contacts: bool = False) -> Snapshot:
        """As of a simulation."""
        with self._profile.span("snapshots"):
            return super().snapshot(contacts=contacts)

    def checkpoint(self) -> dict[str, Any]:
        """As of a simulation."""
        with self._profile.span("checkpoints"):
            return super().checkpoint()

    def _compile(self, progress: Callable[[str], None]) -> None:
        profile, lists = self._profile, self._lists
        if not self.device.is_cpu:
            profile.settle = partial(wp.synchronize_device, self.device)
        profile.watch(lists, rebuild="rebuild", locate="places of contacts")
        profile.watch(lists, _keep_old="copies of the old lists", _set_reach="reach")
        profile.watch(lists, _find_pairs="pairs", _link="pairs of partners", _carry="history")
        profile.watch(lists._search, find="candidates")  # noqa: SLF001 - of these lists alone
        profile.watch(self, _examine_step="bound of the step", _guard="guards", _pace="next step")
        profile.watch(self, _rows_left="drivers")
        super()._compile(progress)

    def _launch(self, *stages: Stage) -> None:
        for stage in stages:
            with self._profile.span(stage.name):
                super()._launch(stage)

    def _counts(self) -> dict[str, int]:
        """How many pairs, candidates, hot and touching ones there are now."""
        lists = self._lists
        n, pairs = lists.pair_count, lists.pairs
        counts = {"pairs": n, "candidates": lists.candidate_count}
        if self.features.hot_lists:
            counts["hot"] = int((pairs.hot_end.numpy()[:n] - pairs.start.numpy()[:n]).sum())
        return counts | {"touching": int(pairs.touching.numpy()[:n].sum())}
