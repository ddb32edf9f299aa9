"""The program as a person meets it: what it prints, which files it leaves, how it ends."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
from falling import SCENE, Falling
from test_output import files_at_most
from test_runner import at_step, contents, summary

import warpdem
from warpdem.__main__ import main
from warpdem.errors import UnstableError

ROOT = Path(__file__).resolve().parents[1]
CUBES = """
title = "cubes on a plate"
run = {duration = 0.3, device = "cpu"}
shape = [
    {name = "cube", kind = "box", size = [0.1, 0.1, 0.1], rounding = 0.01},
    {name = "plate", kind = "box", size = [1.0, 1.0, 0.1]},
]
body = [
    {shape = "plate", group = "wall", position = [0.0, 0.0, -0.05], fixed = true},
    {shape = "cube", group = "rock", position = [0.0, 0.0, 0.06], spin = [0.0, 2.0, 0.0]},
    {shape = "cube", group = "rock", position = [0.04, 0.0, 0.19], velocity = [0.0, 0.1, -1.0]},
]
group = [{name = "rock", density = 2500.0}]
contact = [
    {groups = ["rock", "rock"], kn = 1e5, kt = 8e4, en2 = 0.1, mu = 0.5},
    {groups = ["rock", "wall"], kn = 1e5, kt = 8e4, en2 = 0.1, mu = 0.5},
]
output = {every = 0.02, table = true, contacts = true}
"""


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """A scene in an empty working directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cubes.toml").write_text(CUBES)
    return "cubes.toml"


@pytest.fixture
def falling(monkeypatch, scene):
    """A scene whose simulation is the stand-in of falling.py, for faults that are hard to cause."""

    class Simulation(Falling):
        pass

    Path("falling.toml").write_text(SCENE)
    module = SimpleNamespace(Simulation=Simulation)
    monkeypatch.setitem(sys.modules, "warpdem.simulation", module)
    return Simulation


def start(*arguments, **options):
    command = [sys.executable, "-m", "warpdem", *map(str, arguments)]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True, **options)


def fault(capsys, *arguments):
    """Exit status and standard error of a command that goes wrong."""
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as end:
        status = end.code
    text = capsys.readouterr().err
    assert "Traceback" not in text
    return status, text


def test_a_scene_runs_end_to_end(scene):
    assert main([scene, "--quiet"]) == 0
    run = Path("runs/cubes")
    facts = summary(run)
    assert (facts["status"], facts["bodies"], facts["frames"]) == ("finished", 3, 16)
    table = np.loadtxt(run / "trajectory.csv", delimiter=",", skiprows=1)
    last = table[table[:, 0] == facts["time"]]
    assert last[:, 1].tolist() == [1, 2]
    reader = pyvista.PVDReader(run / "bodies.pvd")
    assert reader.time_values[-1] == facts["time"]
    reader.set_active_time_point(15)
    grid = reader.read()[0]
    for body, centre in zip((1, 2), last[:, 2:5], strict=True):
        drawn = grid.extract_cells(grid.cell_data["body"] == body)
        middle = np.mean(np.reshape(drawn.bounds, (3, 2)), axis=1)
        assert middle == pytest.approx(centre, abs=1e-6)
    energy = np.genfromtxt(run / "energy.csv", delimiter=",", names=True)
    assert energy["contacts"].max() >= 4
    assert abs(energy["balance"]).max() < 0.1 * energy["kinetic"].max()
    contacts = pyvista.read(run / "contacts_000015.vtu")
    assert contacts.n_points == energy["contacts"][-1]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_stopped_and_resumed_run_equals_one_that_was_not(scene, number):
    longer = ["--set", "run.duration=2.0"]
    assert main([scene, *longer, "--out", "whole", "--quiet"]) == 0
    process = start(scene, *longer, "--out", "run", "--quiet")
    while not Path("run/bodies_000002.vtu").exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(number)
    process.send_signal(number)
    _, text = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert "Traceback" not in text
    assert summary(Path("run"))["status"] == "interrupted"
    assert main([scene, *longer, "--out", "run", "--resume", "--quiet"]) == 0
    assert contents(Path("run")) == contents(Path("whole"))


def test_checking_a_scene_loads_neither_warp_nor_vtk(scene):
    code = (
        "import sys, warpdem; from warpdem.__main__ import main\n"
        f"status = main(['check', {scene!r}])\n"
        "assert not {'warp', 'vtkmodules', 'pyvista'} & sys.modules.keys(), sys.modules.keys()\n"
        "sys.exit(status)"
    )
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "cubes on a plate" in done.stdout
    assert not Path("runs").exists()


def test_check_and_run_take_overrides(scene, capsys):
    assert main(["check", scene, "--set", "title=other"]) == 0
    assert "other" in capsys.readouterr().out
    status, text = fault(capsys, scene, "--set", "contact.0.fricton=0.3")
    assert status == 2
    assert "fricton" in text


def test_the_schema_is_json(capsys):
    assert main(["schema"]) == 0
    assert "contact" in json.loads(capsys.readouterr().out)["properties"]


def test_a_reader_that_goes_away_is_no_fault(scene):
    process = start("schema", stdout=subprocess.PIPE)
    process.stdout.close()
    _, text = process.communicate(timeout=60)
    assert (process.returncode, text) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "the following arguments are required: SCENE.toml"),
        (["absent.toml"], "absent.toml"),
        (["."], "cannot be read"),
        (["chekc", "cubes.toml"], 'chekc: neither a command nor a file; did you mean "check"?'),
        (["run", "cubes.toml"], "run: neither a command nor a file"),
        (["cubes.toml", "--device", "gpu"], "'gpu' is not one of auto, cpu, cuda, cuda:N"),
        (["cubes.toml", "--threads", "0"], "'0' is not a whole number of at least 1"),
        (["cubes.toml", "--threads", "two"], "'two' is not a whole number of at least 1"),
        (["cubes.toml", "--resume", "--force"], "not allowed with argument"),
        (["cubes.toml", "--resume"], "runs/cubes: holds no checkpoint to resume from"),
        (["cubes.toml", "--shard", "1/2"], "are for ensembles of trajectories"),
        (["cubes.toml", "--workers", "dask"], "are for ensembles of trajectories"),
        (["cubes.toml", "--shard", "3/2"], "'3/2' is not a shard such as 2/4"),
        (["cubes.toml", "--workers", "ray"], "invalid choice: 'ray'"),
        (["cubes.toml", "--scheduler", "tcp://a:1"], "only with --workers dask"),
        (["cubes.toml", "--out", "cubes.toml"], "is a file; results need a folder"),
        (["cubes.toml", "--device", "cuda:77"], "no such device"),
        (["check"], "the following arguments are required: SCENE.toml"),
        (["check", "absent.toml"], "absent.toml"),
        (["schema", "more"], "unrecognized arguments: more"),
    ],
)
def test_a_mistake_is_told_without_a_traceback(scene, capsys, arguments, message):
    status, text = fault(capsys, *arguments)
    assert status == 2
    assert message in text
    assert not Path("runs/cubes").exists()


def test_a_folder_that_cannot_be_written_is_told_in_one_line(scene, capsys):
    status, text = fault(capsys, scene, "--out", f"{scene}/run")
    assert status == 74
    assert text == f"{scene}/run: Not a directory\n"


def test_a_full_disk_ends_with_74_and_one_line(falling, capsys):
    with files_at_most(20_000):
        status, text = fault(capsys, "falling.toml", "--set", "output.every=0.01", "--quiet")
    assert status == 74
    assert text.count("\n") == 1
    assert "the last checkpoint is good" in text


def test_an_unstable_run_ends_with_3_and_names_the_body(falling, capsys):
    def blow_up():
        raise UnstableError('body "cube" flew off at t = 0.4 s', body="cube", time=0.4)

    falling.on_step = at_step(40, blow_up)
    status, text = fault(capsys, "falling.toml", "--quiet")
    assert (status, text) == (3, 'body "cube" flew off at t = 0.4 s\n')


def test_a_signal_before_the_first_step_is_told(falling, capsys):
    def build(self, scene, **options):
        os.kill(os.getpid(), signal.SIGTERM)

    falling.__init__ = build
    status, text = fault(capsys, "falling.toml", "--quiet")
    assert (status, text) == (143, "stopped before the first step; nothing was written\n")


def test_the_last_line_says_where_the_results_are(falling, capsys):
    assert main(["falling.toml", "--out", "here"]) == 0
    text = capsys.readouterr().err
    assert text.endswith("finished at t = 1 s after 100 steps; results in here\n")


def test_public_names_are_there_and_loading_the_package_is_light():
    assert set(warpdem.__all__) <= set(dir(warpdem))
    for name in warpdem.__all__:
        assert getattr(warpdem, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'simulate'"):
        _ = warpdem.simulate
    light = "import sys, warpdem; sys.exit(bool({'warp', 'numpy', 'pydantic'} & set(sys.modules)))"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    subprocess.run([sys.executable, "-c", light], env=environment, check=True)


def test_the_version_is_that_of_the_package():
    assert f'\nversion = "{warpdem.__version__}"\n' in (ROOT / "pyproject.toml").read_text()
