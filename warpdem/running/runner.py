"""Runs a scene into a folder, from the folder's claim to the summary."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from warpdem.errors import WarpdemError
from warpdem.output import checkpoint as checkpoints
from warpdem.output.folder import claimed
from warpdem.output.scene_keys import flat_scene, refuse_differing
from warpdem.precision import bind
from warpdem.running.interrupts import Interrupts
from warpdem.running.profile import profile_text, span_of
from warpdem.running.progress import Progress
from warpdem.running.session import Session, frames

if TYPE_CHECKING:
    from warpdem.input.scene import Scene
    from warpdem.output.checkpoint import Checkpoint
    from warpdem.output.folder import RunFolder
    from warpdem.rockfall.share import Share
    from warpdem.running.profile import Profile
    from warpdem.simulation import Simulation


def run(  # noqa: PLR0913 - options of the command line
    scene: Scene,
    directory: str | Path,
    *,
    device: str | None = None,
    threads: int | None = None,
    resume: bool = False,
    force: bool = False,
    quiet: bool = False,
    share: Share | None = None,
    profile: Profile | None = None,
) -> int:
    """Simulate a scene and write its results.

    Args:
        scene: What to simulate.
        directory: Folder of the results, made if need be.
        device: ``auto``, ``cpu``, ``cuda`` or ``cuda:N``; default: the scene's.
        threads: Host threads; default: all cores. Results do not depend on it.
        resume: Go on from the checkpoint in the folder; the files end up as though the run had
            never stopped.
        force: Replace the results in the folder. Files of other origin stay.
        quiet: Say nothing on standard error.
        share: Which part of an ensemble is flown, and on what; only with ``run.method``
            "nonsmooth".
        profile: Times the stages of a smooth run, prints them at the end, and adds them to the
            summary.

    Returns:
        Exit status: 0, or 130 and 143 when SIGINT or SIGTERM ended it after a checkpoint.

    Raises:
        WarpdemError: The folder, the scene or the device does not allow it.
        UnstableError: The motion blew up; what was written before stays.
        OutputError: Results cannot be written; the last checkpoint is good.
        Interrupted: A signal came before the first step; nothing was written.
    """
    if scene.run.method == "nonsmooth":
        if profile:
            raise WarpdemError(
                'run.method = "nonsmooth": --profile times the stages of method "smooth"; what an '
                "ensemble takes is in its summary.json"
            )
        from warpdem.rockfall.ensemble import WHOLE, run_rockfall  # noqa: PLC0415 - only there

        return run_rockfall(
            scene,
            directory,
            device=device,
            threads=threads,
            resume=resume,
            force=force,
            quiet=quiet,
            share=share or WHOLE,
        )
    if share:
        raise WarpdemError(
            f'run.method = "{scene.run.method}": --shard and --workers are for ensembles of '
            'trajectories, run.method = "nonsmooth"'
        )
    return _run_smooth(
        scene,
        Path(directory),
        device=device,
        threads=threads,
        resume=resume,
        force=force,
        progress=Progress(quiet=quiet),
        profile=profile,
    )


def _run_smooth(
    scene: Scene,
    directory: Path,
    *,
    device: str | None,
    threads: int | None,
    resume: bool,
    force: bool,
    progress: Progress,
    profile: Profile | None,
) -> int:
    """Simulate deformable contacts, as of ``run``."""
    with Interrupts() as signals, claimed(directory, resume=resume, force=force) as folder:
        start = _resumable(scene, folder) if resume else None
        if start and frames(scene, start).done:
            progress.tell(_nothing_left(folder, start))
            return 0
        with span_of(profile, "start-up"):
            simulation = _simulation(scene, start, device, threads, progress, profile)
        if not start:
            folder.clear()
        folder.clear_parts()
        session = Session(scene, simulation, folder, progress, signals, start, profile)
        status = session.run()
        if profile:
            print(profile_text(session.profiled()))
        return status


def _resumable(scene: Scene, folder: RunFolder) -> Checkpoint:
    """The folder's checkpoint, if it is one of this scene."""
    start = checkpoints.load(folder.checkpoint)
    refuse_differing(folder.path, checkpoints.changed_keys(start.scene, flat_scene(scene)))
    return start


def _nothing_left(folder: RunFolder, start: Checkpoint) -> str:
    way_on = "to go on, raise run.duration"
    return f"{folder.path}: already finished at t = {start.time:.6g} s; {way_on}"


def _simulation(
    scene: Scene,
    start: Checkpoint | None,
    device: str | None,
    threads: int | None,
    progress: Progress,
    profile: Profile | None,
) -> Simulation:
    """The scene ready to run, from its checkpoint on if there is one."""
    bind(scene.run.precision)
    with span_of(profile, "imports"):
        from warpdem.simulation import Simulation  # noqa: PLC0415 - loads Warp
    options = {"device": device, "threads": threads, "progress": progress.work}
    if profile:
        from warpdem.profiled import ProfiledSimulation  # noqa: PLC0415 - the same

        simulation = ProfiledSimulation(scene, profile=profile, **options)
    else:
        simulation = Simulation(scene, **options)
    if start:
        simulation.restore(start.state)
    return simulation
