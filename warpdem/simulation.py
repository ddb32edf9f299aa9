"""A simulation: the clock and the only loop that steps."""

from __future__ import annotations

import os
import time
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem import local_origin, observe, resume
from warpdem.bonds.creation import bonds_of
from warpdem.build import build
from warpdem.checks.check import build_shapes
from warpdem.checks.custom_laws import check_custom_laws
from warpdem.checks.timestep import automatic_step
from warpdem.compile import load
from warpdem.crews import Crews
from warpdem.devices import find_device
from warpdem.drives import Blocks
from warpdem.driving.plan import plan_of
from warpdem.energy_guard import EnergyGuard
from warpdem.features import features_of, stage_names
from warpdem.filling.placement import place
from warpdem.first_forces import first_forces, orient_all
from warpdem.guards import Guards, Instant
from warpdem.kernels.cell import CHUNKS
from warpdem.lists import Lists
from warpdem.opening import admit
from warpdem.pacing import Pacing
from warpdem.relaxing import relaxed
from warpdem.sleeping import Sleeping, note_of
from warpdem.stages import Stage, advance, after_drift, cell_drift, halt
from warpdem.state import cut
from warpdem.step_bound import step_bound
from warpdem.stepper import Stepper, launch

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.input.scene import Scene
    from warpdem.model import Model
    from warpdem.snapshot import Snapshot
    from warpdem.state import State

# bodies a host thread must have for the meetings to pay: two a step, about 2 us each
CREW_BODIES = 50
# seconds between two questions whether to stop
PATIENCE = 0.2


class Simulation:
    """The bodies of a scene in motion.

    Args:
        scene: What to simulate.
        device: Overrides ``run.device``: "auto", "cpu", "cuda" or "cuda:N".
        threads: Host threads on the CPU, default all cores; the result does not depend on them.
        progress: Told in a few words what takes time before the first step.

    Raises:
        WarpdemError: The scene does not fit together, or the device does not exist.

    Attributes:
        scene, polyhedra, placement, features, plan: What the simulation was built from.
        guards: What ends it where it is no longer physical.
        notes: Repairs and warnings, in words.
    """

    # what takes the steps
    stepper: Callable[..., Stepper] = Stepper

    def __init__(
        self,
        scene: Scene,
        *,
        device: str | None = None,
        threads: int | None = None,
        progress: Callable[[str], None] | None = None,
    ) -> None:
        admit(scene)
        self.scene = scene
        tell = progress or (lambda _: None)
        tell("shapes")
        check_custom_laws(scene)
        self.polyhedra = build_shapes(scene)
        tell("places of bodies")
        self.placement = place(scene, self.polyhedra)
        if scene.run.relax:
            tell("overlaps at the start")
            own = (self.placement, self.polyhedra)
            self.placement = relaxed(Simulation, scene, *own, device=device, threads=threads)
        self._origin = local_origin.of(scene, self.placement)
        placed = (*local_origin.moved(scene, self.placement, self._origin), self.polyhedra)
        tell("bonds, time step, drivers")
        self.features = features_of(*placed)
        interfaces = bonds_of(*placed)
        step = automatic_step(*placed, interfaces)
        self.notes = [*self.placement.notes, *note_of(scene), *filter(None, [step.message])]
        self.dt = self._next_dt = step.dt
        self.device = find_device(device or scene.run.device)
        self._threads = threads or os.cpu_count() or 1
        self.plan = plan_of(*placed)
        tell("arrays")
        self._model, self._state = build(
            *placed, self.features, self.device, plan=self.plan, interfaces=interfaces
        )
        self._blocks = Blocks(self.plan, self.features, self._state.drives)
        self._lists = Lists(self._model, self._state)
        self._sleeping = Sleeping(self._model, self._state, self._lists)
        count = self.body_count
        self._whole = cut(self._state, count, 1, self.device)[0]
        sizes = sorted({1, self._crew_size()})
        self._crews = [cut(self._state, count, size, self.device) for size in sizes]
        self._pacing = Pacing(*placed, self.plan, self.dt, contacts=self.features.contacts)
        self._kept: dict[float, tuple[tuple[Stage, ...], tuple[Stage, ...], Crews]] = {}
        self._time, self._time_steps, self._changes = 0.0, 0, 0
        self._warned = False
        watched = (scene, self.placement.names, self._model, self._state, self._lists)
        self.guards, self._energies = Guards(*watched), EnergyGuard(*watched)
        self._chunk = 1
        self.loop_seconds = 0.0
        self._compile(tell)
        tell("first forces")
        self._first_forces()
        self._guard()
        self._energy_start = observe.total_energy(self._model, self._state, self._lists)

    @property
    def body_count(self) -> int:
        """Number of bodies, fixed ones included."""
        return self._model.body_count

    @property
    def parts(self) -> tuple[Model, State, Lists]:
        """What lies on the device: the model, the state, and the lists."""
        return self._model, self._state, self._lists

    @property
    def step_count(self) -> int:
        """Number of steps done."""
        return int(self._state.clock.steps.numpy()[0])

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self._time + (self.step_count - self._time_steps) * self.dt

    def advance(self, until: float, *, stop: Callable[[], bool] | None = None) -> None:
        """Go to the step nearest ``until`` [s]; return early where ``stop`` says so.

        Raises:
            UnstableError: A body flew off or became NaN.
        """
        begin = time.perf_counter()
        try:
            while (left := self._steps_to(until)) > 0 and not (stop is not None and stop()):
                since = time.perf_counter()
                most = min(left, self._chunk)
                for part in (self._energies, self._pacing, self._sleeping):
                    most = part.left(self.step_count, most)
                self._run(most)
                self._sleeping.settle(self.step_count, self.dt)
                self.notes += self._energies.look(self._instant())
                spent = time.perf_counter() - since
                if spent < PATIENCE:
                    self._chunk = min(2 * self._chunk, 1 << 20)
                elif self._chunk > 1:
                    self._chunk = max(self._chunk // 2, 1)
        finally:
            self.loop_seconds += time.perf_counter() - begin
        self._guard()

    def snapshot(self, *, contacts: bool = False) -> Snapshot:
        """The state now, on the host."""
        shot = observe.snapshot(
            self._model,
            self._state,
            self._lists,
            time=self.time,
            step=self.step_count,
            dt=self.dt,
            energy_start=self._energy_start,
            contacts=contacts,
        )
        return local_origin.shown(shot, self._origin, self._model)

    def pair_energies(self) -> tuple[np.ndarray, np.ndarray]:
        """Owner of each body pair in the lists, and the elastic energy of its contacts [J].

        Shapes [pair_count]; zero where the scene keeps no account of energies.
        """
        return observe.pair_energies(self._model, self._state, self._lists)

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Everything that a later ``restore`` needs to go on bitwise."""
        clock = np.array([self._time, self.dt, self._next_dt, self._energy_start])
        counts = np.array([self._time_steps, self.step_count, self._lists.rebuilds])
        kept = resume.arrays(self._state, self._lists) | self._energies.checkpoint()
        if self._pacing.adapts:
            kept["reach_listed"] = self._pacing.listed
        return {"clock": clock, "counts": counts, **kept}

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Take up the state of a checkpoint of the same scene."""
        self._time, self.dt, self._next_dt, self._energy_start = map(float, arrays["clock"])
        self._time_steps = int(arrays["counts"][0])
        contacts, turned = self.features.contacts, partial(orient_all, self._model, self._state)
        resume.put_back(self._state, self._lists, arrays, orient=turned, contacts=contacts)
        self._lists.rebuilds = int(arrays["counts"][2])
        self._state.clock.steps.fill_(int(arrays["counts"][1]))
        self._blocks.forget()
        self._energies.restore(arrays)
        self._make_stages()

    def report(self) -> dict[str, Any]:
        """What was built, and what it cost so far."""
        return {
            "bodies": self.body_count,
            "steps": self.step_count,
            "dt": self.dt,
            "dt_changes": self._changes,
            "loop_seconds": self.loop_seconds,
            "compile_seconds": self.compile_seconds,
            **self._lists.facts(),
            "device": str(self.device),
            "threads": self._stepper.best,
            "cycles_by_threads": self._stepper.done,
            "precision": self.scene.run.precision,
            "features": [k for k, v in vars(self.features).items() if v],
            "stages": list(stage_names(self.features)),
            **self._sleeping.facts(),
        }

    def _crew_size(self) -> int:
        if not self.device.is_cpu:
            return 1
        # more threads than cores would spin for one another
        most = min(self._threads, os.cpu_count() or 1)
        return max(1, min(most, self.body_count // CREW_BODIES))

    def _compile(self, progress: Callable[[str], None]) -> None:
        share = self._crews[-1][0]
        self.compile_seconds = load(self._model, self._state, self._lists, share, progress)

    def _make_stages(self) -> None:
        """The stages of a step of ``dt``, and who takes them: those of each dt are kept."""
        if self.dt not in self._kept:
            self._kept[self.dt] = self._stages_of(self.dt)
        self._drift, self._after, self._stepper = self._kept[self.dt]
        self._stepper.prepare()

    def _stages_of(self, dt: float) -> tuple[tuple[Stage, ...], tuple[Stage, ...], Crews]:
        model, state, lists, whole = self._model, self._state, self._lists, self._whole
        drift = (
            *cell_drift(model, state, whole, dt),
            advance(model, state, lists, whole, dt, kicks=False, drifts=True),
            halt(whole),
        )
        crews = [self.stepper(model, state, lists, shares, dt) for shares in self._crews]
        return drift, after_drift(model, state, lists, whole, dt), Crews(crews)

    def _launch(self, *stages: Stage) -> None:
        owners = self.body_count if self.features.single else self._lists.pair_count
        self._whole.pairs.assign([0, owners])
        for stage in stages:
            bonding = self._state.bonding
            count = {"bodies": self.body_count, "pairs": self._lists.pair_count}
            count |= {"interfaces": len(bonding) if bonding else 0, "chunks": CHUNKS}
            count |= {"gauges": len(self._model.gauges), "one": 1}
            launch(stage, count[stage.over], self.device)

    def _first_forces(self) -> None:
        """Forces at time zero, and the first step."""
        parts = (self._model, self._state, self._lists, self._whole, self._blocks)
        if first_forces(*parts, dt=self.dt, launch=self._launch):
            self._pace(self._examine_step())
            self._change_clock()
        self._make_stages()

    def _steps_to(self, until: float) -> int:
        """Steps left to the one nearest ``until``.

        Counted from the last change of dt: rounding must not make it depend on where a run paused.
        """
        goal = self._time_steps + int(np.ceil((until - self._time) / self.dt - 0.5))
        return goal - self.step_count

    def _run(self, count: int) -> None:
        """``count`` whole steps, fewer when the step size has to change."""
        if self._pacing.due(self.step_count):
            self._state.clock.moved.fill_(1)
        self._rows_left()
        self._launch(*self._drift)
        self._resolve()
        left = count - 1
        while left > 0 and self._next_dt == self.dt:
            before = self.step_count
            self._stepper.cycles(min(left, self._rows_left()))
            left -= self.step_count - before
            self._resolve()
        self._launch(*self._after)
        self._lists.locate()
        if self._next_dt != self.dt:
            self._change_step()

    def _rows_left(self) -> int:
        """Steps for which the motion of drivers is on the device now, one at least."""
        since = self._time_steps
        return self._blocks.left(self.step_count, since=since, time=self._time, dt=self.dt)

    def _resolve(self) -> None:
        """Act on what the clock says: name what flew off, renew the lists."""
        clock = self._state.clock
        if clock.fault.numpy()[0]:
            self.guards.name_fault(self._instant())
        if not clock.moved.numpy()[0]:
            return
        self._lists.locate()
        self._guard()
        bound = self._examine_step()
        self._lists.rebuild(self.dt)
        self._pace(bound)
        if bonding := self._state.bonding:
            yielded = self.time - self.dt
            bonding.resolve(self._model, self._state, self._lists, dt=self.dt, time=yielded)
        self._stepper.prepare()

    def _instant(self) -> Instant:
        return Instant(self.time, self.step_count, self.dt)

    def _guard(self) -> None:
        """Look at the numbers and at the depths of the contacts of the last force pass."""
        self.notes += self.guards.look(self._instant())

    def _pace(self, bound: float) -> None:
        """Choose the next step: ``bound`` is of the contacts, speeds are those in the new lists."""
        pacing = self._pacing
        rush = self.guards.step_limit(self._instant(), may_lower=pacing.lowers)
        limit = min(pacing.contact_limit(bound), rush)
        self._next_dt = pacing.next(self._next_dt, limit)
        if pacing.adapts:
            self._next_dt = pacing.grown(
                self._next_dt, limit, self._model, self._state, self._lists
            )

    def _examine_step(self) -> float:
        """Bound of the step by the contacts that the old lists saw [s]; told where it is passed."""
        bound = self.step_bound()
        if self.dt > bound and not (self._warned or self._pacing.lowers):
            self._warned = True
            self.notes.append(
                f"dt = {self.dt:.4g} s is above the stability bound {bound:.4g} s of the contacts "
                f"at t = {self.time:.4g} s"
            )
        return bound

    def step_bound(self) -> float:
        """Largest stable step for the contacts that touch now [s]; infinite without any."""
        return step_bound(self._model, self._state, self._lists)

    def _change_clock(self) -> None:
        if self._next_dt == self.dt:
            return
        if not self._pacing.adapts:
            self.notes.append(
                f"dt lowered from {self.dt:.4g} to {self._next_dt:.4g} s at t = {self.time:.4g} s: "
                f"more contacts share a body than foreseen, or bodies are faster"
            )
        self._time, self._time_steps = self.time, self.step_count
        self._lists.change_step(self.dt, self._next_dt)
        self.dt = self._next_dt
        self._blocks.forget()

    def _change_step(self) -> None:
        self._change_clock()
        self._changes += 1
        self._make_stages()
