"""A run's folder: what lies in it after an end, an interruption, a full disk and a resumption."""

import json
import os
import signal
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
from falling import SCENE, Falling
from test_output import files_at_most, tiny_disk

from warpdem.errors import OutputError, UnstableError, WarpdemError
from warpdem.input import decode
from warpdem.output import checkpoint as checkpoints
from warpdem.output.folder import claimed
from warpdem.running import runner
from warpdem.running.interrupts import Interrupted


@pytest.fixture(autouse=True)
def simulation(monkeypatch):
    """Stand in for the simulation; what a test sets on it is undone."""

    class Simulation(Falling):
        pass

    module = SimpleNamespace(Simulation=Simulation)
    monkeypatch.setitem(sys.modules, "warpdem.simulation", module)
    return Simulation


def scene(*overrides):
    return decode.loads(SCENE, overrides=overrides)


def run(folder, *overrides, **options):
    return runner.run(scene(*overrides), folder, quiet=True, **options)


def contents(folder):
    """Bytes of the files that a resumed run must reproduce."""
    names = {path.name for path in folder.iterdir()} - {"summary.json", "checkpoint.npz"}
    return {name: (folder / name).read_bytes() for name in sorted(names)}


def summary(folder):
    return json.loads((folder / "summary.json").read_text())


def at_step(number, action):
    def on_step(simulation):
        if simulation.step_count == number:
            action()

    return staticmethod(on_step)


def send(number):
    return lambda: os.kill(os.getpid(), number)


def test_a_run_leaves_frames_tables_and_a_summary(tmp_path):
    assert run(tmp_path / "run") == 0
    names = set(contents(tmp_path / "run"))
    frames = {f"{stem}_{n:06d}.vtu" for stem in ("bodies", "contacts") for n in range(11)}
    assert names == frames | {"bodies.pvd", "contacts.pvd", "trajectory.csv", "energy.csv"}
    reader = pyvista.PVDReader(tmp_path / "run" / "bodies.pvd")
    assert reader.time_values == pytest.approx(np.arange(11) / 10)
    table = np.loadtxt(tmp_path / "run" / "trajectory.csv", delimiter=",", skiprows=1)
    assert table.shape == (22, 15)  # the fixed body does not move: it has no rows
    assert len((tmp_path / "run" / "energy.csv").read_text().splitlines()) == 12
    facts = summary(tmp_path / "run")
    assert (facts["status"], facts["steps"], facts["frames"]) == ("finished", 100, 11)
    assert facts["body_steps_per_s"] == pytest.approx(3000.0)
    assert {"warpdem", "warp-lang", "numpy", "python"} <= facts["versions"].keys()


def test_what_is_not_asked_for_is_not_written(tmp_path):
    off = [f"output.{key}=false" for key in ("surface", "contacts", "table", "energy")]
    assert run(tmp_path / "run", *off) == 0
    assert contents(tmp_path / "run") == {}
    assert summary(tmp_path / "run")["frames"] == 11


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("step", [1, 30, 37])
def test_a_signal_ends_the_run_at_a_checkpoint_and_a_resumed_run_equals_a_whole_one(
    tmp_path, simulation, number, step
):
    run(tmp_path / "whole")
    simulation.on_step = at_step(step, send(number))
    assert run(tmp_path / "run") == 128 + number
    assert summary(tmp_path / "run")["status"] == "interrupted"
    assert checkpoints.load(tmp_path / "run" / "checkpoint.npz").step == step
    simulation.on_step = staticmethod(Falling.on_step)
    assert run(tmp_path / "run", resume=True) == 0
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_before_the_first_step_leaves_no_folder(tmp_path, simulation, number):
    def build(self, scene, **options):
        send(number)()

    simulation.__init__ = build
    with pytest.raises(Interrupted) as caught:
        run(tmp_path / "run")
    assert caught.value.number == number
    assert not (tmp_path / "run").exists()


def test_a_signal_at_the_first_moment_leaves_a_checkpoint(tmp_path, simulation):
    sent = []

    def notes(self):
        if not sent:
            sent.append(send(signal.SIGTERM)())
        return []

    simulation.notes = property(notes, lambda self, value: None)
    assert run(tmp_path / "run") == 143
    assert run(tmp_path / "run", resume=True) == 0


def test_further_signals_do_no_harm(tmp_path, simulation):
    def press_again(self):
        send(signal.SIGINT)()
        send(signal.SIGTERM)()
        return Falling.checkpoint(self)

    simulation.checkpoint = press_again
    simulation.on_step = at_step(5, send(signal.SIGTERM))
    assert run(tmp_path / "run", "output.checkpoint_every=1.0") in {130, 143}
    assert checkpoints.load(tmp_path / "run" / "checkpoint.npz").time >= 0.0


def test_signals_act_as_before_after_a_run(tmp_path):
    before = signal.getsignal(signal.SIGTERM)
    run(tmp_path / "run")
    assert signal.getsignal(signal.SIGTERM) is before


class PowerCutError(Exception):
    pass


@pytest.mark.parametrize("every", ["0.1", "0.25", "0.07"])
def test_a_run_killed_after_its_checkpoint_resumes_from_it(tmp_path, simulation, every):
    def cut():
        raise PowerCutError

    option = f"output.checkpoint_every={every}"
    run(tmp_path / "whole", option)
    simulation.on_step = at_step(68, cut)
    with pytest.raises(PowerCutError):
        run(tmp_path / "run", option)
    (tmp_path / "run" / "bodies_000099.vtu.part").write_text("half a frame")
    simulation.on_step = staticmethod(Falling.on_step)
    assert run(tmp_path / "run", option, resume=True) == 0
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")


def test_resuming_a_finished_run_says_so(tmp_path, capsys):
    run(tmp_path / "run")
    before = contents(tmp_path / "run")
    assert runner.run(scene(), tmp_path / "run", resume=True) == 0
    assert "already finished at t = 1 s" in capsys.readouterr().err
    assert contents(tmp_path / "run") == before


def test_a_finished_run_goes_on_when_its_duration_is_raised(tmp_path):
    run(tmp_path / "whole", "run.duration=1.5")
    run(tmp_path / "run")
    assert run(tmp_path / "run", "run.duration=1.5", resume=True) == 0
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")


def test_another_scene_is_not_resumed_and_the_changed_key_is_named(tmp_path):
    run(tmp_path / "run")
    with pytest.raises(WarpdemError, match=r"differs .* in contact\[0\]\.mu; give another"):
        run(tmp_path / "run", "contact.0.mu=0.4", resume=True)


def test_no_checkpoint_no_resumption(tmp_path):
    with pytest.raises(WarpdemError, match="no checkpoint to resume from"):
        run(tmp_path / "run", resume=True)
    assert not (tmp_path / "run").exists()


def test_a_folder_with_files_is_left_alone(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(WarpdemError, match="already holds files"):
        run(tmp_path)
    assert set(contents(tmp_path)) == {"notes.txt"}


def test_force_removes_what_a_run_wrote_and_nothing_else(tmp_path):
    run(tmp_path)
    others = ["notes.txt", "bodies_my.vtu", "bodies_0.vtu", "old_energy.csv", "energy.csv.bak"]
    for name in others:
        (tmp_path / name).write_text("mine")
    assert run(tmp_path, "output.every=0.5", "output.table=false", force=True) == 0
    own = {"bodies_000000.vtu", "bodies_000001.vtu", "bodies_000002.vtu"}
    assert set(contents(tmp_path)) == {
        *others,
        *own,
        *(name.replace("bodies", "contacts") for name in own),
        "bodies.pvd",
        "contacts.pvd",
        "energy.csv",
    }


def test_a_scene_that_cannot_be_built_leaves_no_folder_and_old_results_alone(tmp_path, simulation):
    run(tmp_path / "old")
    before = contents(tmp_path / "old")

    def refuse(self, scene, **options):
        raise WarpdemError("no such device")

    simulation.__init__ = refuse
    for folder, options in (("old", {"force": True}), ("new", {})):
        with pytest.raises(WarpdemError, match="no such device"):
            run(tmp_path / folder, **options)
    assert contents(tmp_path / "old") == before
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("folder", ["file", "file/below"])
def test_a_folder_that_cannot_be_made_is_told_in_one_line(tmp_path, folder):
    (tmp_path / "file").write_text("")
    with pytest.raises(WarpdemError) as caught:
        run(tmp_path / folder)
    assert "\n" not in str(caught.value)


def test_two_runs_do_not_share_a_folder(tmp_path):
    run(tmp_path)
    with (
        claimed(tmp_path, resume=True, force=False),
        pytest.raises(WarpdemError, match="another run"),
    ):
        run(tmp_path, resume=True)


def test_an_unstable_run_keeps_what_was_written(tmp_path, simulation):
    def blow_up():
        raise UnstableError('body "body[0]" flew off', body="body[0]", time=0.45)

    simulation.on_step = at_step(45, blow_up)
    with pytest.raises(UnstableError):
        run(tmp_path)
    assert summary(tmp_path)["status"] == "unstable"
    assert summary(tmp_path)["frames"] == 5
    assert checkpoints.load(tmp_path / "checkpoint.npz").step == 40


def test_a_full_disk_leaves_the_last_checkpoint_good(tmp_path):
    options = ["output.surface=false", "output.every=0.01"]
    run(tmp_path / "whole", *options)
    fault = r"trajectory\.csv: File too large; the last checkpoint is good"
    with files_at_most(20_000), pytest.raises(OutputError, match=fault):
        run(tmp_path / "run", *options)
    assert summary(tmp_path / "run")["status"] == "failed"
    assert 0 < checkpoints.load(tmp_path / "run" / "checkpoint.npz").step < 100
    assert not list((tmp_path / "run").glob("*.part"))
    assert run(tmp_path / "run", *options, resume=True) == 0
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")


def test_a_full_file_system_leaves_the_last_checkpoint_good(tmp_path):
    run(tmp_path / "whole")
    with tiny_disk(tmp_path / "disk", "72k") as disk:
        with pytest.raises(OutputError, match=r"No space left on device; the last checkpoint"):
            run(disk / "run")
        assert checkpoints.load(disk / "run" / "checkpoint.npz").step < 100
        assert not list((disk / "run").glob("*.part"))
        (disk / "run").rename(disk / "stopped")
        os.sync()
        for path in (disk / "stopped").iterdir():
            (tmp_path / "run").mkdir(exist_ok=True)
            (tmp_path / "run" / path.name).write_bytes(path.read_bytes())
    assert run(tmp_path / "run", resume=True) == 0
    assert contents(tmp_path / "run") == contents(tmp_path / "whole")


def test_the_end_is_a_frame_even_between_two_frames(tmp_path):
    run(tmp_path, "output.every=0.4")
    reader = pyvista.PVDReader(tmp_path / "bodies.pvd")
    assert reader.time_values == pytest.approx([0.0, 0.4, 0.8, 1.0])
