"""One process's part of a run: frames, checkpoints, interruption and the summary."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from warpdem import __version__
from warpdem.errors import OutputError
from warpdem.output import summary
from warpdem.output.checkpoint import Checkpoint
from warpdem.output.recorder import Recorder
from warpdem.output.scene_keys import flat_scene
from warpdem.output.writer import Writer, told
from warpdem.running.failures import summarised
from warpdem.running.interrupts import SIGNALLED
from warpdem.running.progress import Progress, duration
from warpdem.running.schedule import Schedule

if TYPE_CHECKING:
    from warpdem.input.scene import Scene
    from warpdem.output.folder import RunFolder
    from warpdem.running.interrupts import Interrupts
    from warpdem.running.profile import Profile
    from warpdem.simulation import Simulation


@dataclass
class Session:
    """One process's part of a run.

    Attributes:
        scene: What is simulated.
        simulation: The bodies in motion, at ``start`` or at time 0.
        folder: Where results go.
        progress: Where it tells of itself.
        interrupts: The signals that end it.
        start: The checkpoint it resumes from.
        profile: Where it tells how long things take.
    """

    scene: Scene
    simulation: Simulation
    folder: RunFolder
    progress: Progress
    interrupts: Interrupts
    start: Checkpoint | None = None
    profile: Profile | None = None

    def __post_init__(self) -> None:
        self._frames = frames(self.scene, self.start)
        own_interval = self.scene.output.checkpoint_every
        last = self.start.checkpoint_due if self.start else -1.0
        self._saves = Schedule(own_interval, self._frames.end, last) if own_interval else None
        self._frame_count = self.start.frame_count if self.start else 0
        self._told = 0
        self._flat_scene = flat_scene(self.scene)
        self._began = time.monotonic()
        self._first_time, self._first_step = self.simulation.time, self.simulation.step_count

    def run(self) -> int:
        """Simulate to the end, or to an interruption.

        Returns:
            Exit status, as :func:`run`.

        Raises:
            UnstableError: The motion blew up.
            OutputError: Results cannot be written.
        """
        self.interrupts.patient = True
        self._tell_notes()
        with summarised(self.progress, self._summarise, self._way_on):
            self._simulate()
        return self._conclude()

    def _simulate(self) -> None:
        writer = Writer()
        simulation = self.simulation
        recorder = Recorder(
            self.folder,
            self.scene,
            simulation.polyhedra,
            simulation.placement,
            writer,
            self.start,
        )
        if self.profile:
            self.profile.watch(recorder, record="frames to the writer", _write="frames, tables")
            self.profile.watch(recorder, _save="checkpoints")
        try:
            with writer:
                while not self._frames.done:
                    self._advance(recorder)
                    if self.interrupts.received:
                        break
        finally:
            recorder.close()

    def _advance(self, recorder: Recorder) -> None:
        """Go on to what is due next and write it; an interruption writes a checkpoint too."""
        simulation = self.simulation
        now = simulation.time - 0.75 * simulation.dt  # what is due comes within half a step
        frame = self._frames.due(now)
        save = self._saves.due(now) if self._saves else frame
        simulation.advance(min(frame, save), stop=self._stop)
        self._tell_notes()
        if self._has_come(frame):
            recorder.record(simulation.snapshot(contacts=self.scene.output.contacts))
            self._frame_count += 1
            self._frames.last = frame
        is_due = self._has_come(save)
        if self._saves and is_due:
            self._saves.last = save
        if is_due or self.interrupts.received:
            recorder.checkpoint(self._checkpoint())

    def _has_come(self, due: float) -> bool:
        """Whether the simulation is at the step nearest to a time [s], or beyond."""
        return (due - self.simulation.time) / self.simulation.dt <= 0.5

    def _checkpoint(self) -> Checkpoint:
        return Checkpoint(
            scene=self._flat_scene,
            time=self.simulation.time,
            step=self.simulation.step_count,
            frame_due=self._frames.last,
            frame_count=self._frame_count,
            checkpoint_due=self._saves.last if self._saves else self._frames.last,
            frame_times={},
            table_lengths={},
            state=self.simulation.checkpoint(),
        )

    def _stop(self) -> bool:
        if self.progress.is_due():
            self.progress.show(self._line())
        return self.interrupts.received is not None

    def _line(self) -> str:
        """Where the run stands."""
        simulation, end = self.simulation, self._frames.end
        elapsed = max(time.monotonic() - self._began, 1e-9)
        rate = simulation.body_count * (simulation.step_count - self._first_step) / elapsed
        pace = (simulation.time - self._first_time) / elapsed
        left = duration((end - simulation.time) / pace) if pace > 0.0 else "?"
        return (
            f"t = {simulation.time:.4g} of {end:.4g} s ({simulation.time / end:.0%}), "
            f"{self._frame_count} frames, {rate:.3g} body-steps/s, {left} left"
        )

    def _conclude(self) -> int:
        """Write the summary and say how it ended."""
        received = self.interrupts.received if not self._frames.done else None
        self._summarise("interrupted" if received else "finished")
        how = "stopped" if received else "finished"
        onward = "; --resume goes on" if received else ""
        self.progress.tell(
            f"{how} at t = {self.simulation.time:.6g} s after {self.simulation.step_count} steps; "
            f"results in {self.folder.path}{onward}"
        )
        return SIGNALLED + received if received else 0

    def _notes(self) -> list[str]:
        """Repairs of the shapes, how the fills went, and what became of the time step."""
        shapes = self.simulation.polyhedra.values()
        repairs = [f'shape "{shape.name}": {note}' for shape in shapes for note in shape.notes]
        return [*repairs, *self.simulation.notes]

    def _tell_notes(self) -> None:
        notes = self._notes()
        for note in notes[self._told :]:
            self.progress.tell(note)
        self._told = len(notes)

    def _way_on(self) -> str:
        good = self.folder.checkpoint.exists()
        return "the last checkpoint is good, --resume goes on from it" if good else ""

    def _summarise(self, status: str, **more: str) -> None:
        facts = {"status": status, **more, **self._facts(), "notes": self._notes()}
        try:
            summary.save(self.folder.summary, facts)
        except OSError as fault:
            raise OutputError(told(fault)) from fault

    def profiled(self) -> dict[str, Any]:
        """What the profile says of this session."""
        assert self.profile
        simulation = self.simulation
        steps = simulation.step_count - self._first_step
        return self.profile.facts(simulation.features, simulation.body_count * steps)

    def _facts(self) -> dict[str, Any]:
        simulation, report = self.simulation, self.simulation.report()
        steps = simulation.step_count - self._first_step
        body_steps = simulation.body_count * steps
        return {
            "title": self.scene.title,
            "scene": str(self.scene.source or ""),
            "time": simulation.time,
            "duration": self.scene.run.duration,
            "resumed_from": self.start.time if self.start else None,
            "dt": simulation.dt,
            "steps": simulation.step_count,
            "steps_this_session": steps,
            "bodies": simulation.body_count,
            "groups": simulation.placement.groups,
            "frames": self._frame_count,
            "precision": self.scene.run.precision,
            "wall_seconds": time.monotonic() - self._began,
            "body_steps_per_s": body_steps / max(report["loop_seconds"], 1e-9),
            **report,
            **({"profile": self.profiled()} if self.profile else {}),
            "versions": summary.versions(__version__),
        }


def frames(scene: Scene, start: Checkpoint | None) -> Schedule:
    """When frames are due, after those of the checkpoint."""
    last = start.frame_due if start else -1.0
    return Schedule(scene.frame_interval, scene.run.duration, last)
