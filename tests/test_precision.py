"""Mixed precision: chosen by the scene, bound once a process, near to double precision."""

import json
import subprocess
import sys

import numpy as np
import pytest
from warpdem.kernels.precision import NARROW

from warpdem import Simulation
from warpdem.checks.check import check
from warpdem.errors import SceneError, WarpdemError
from warpdem.input.decode import load, loads

OTHER = "float64" if NARROW else "mixed"
SCENE = """
title = "cubes and a ball fall on a plate"
run = {duration = 0.1, dt = 1e-4, device = "cpu"}
shape = [
    {name = "cube", kind = "box", size = [0.1, 0.1, 0.1], rounding = 0.01},
    {name = "ball", kind = "sphere", radius = 0.05},
    {name = "floor", kind = "plane"},
]
body = [
    {shape = "floor", group = "wall", position = [0.0, 0.0, 0.0], fixed = true},
    {shape = "cube", group = "rock", position = [0.0, 0.0, 0.0501], spin = [0.0, 2.0, 0.0]},
    {shape = "cube", group = "rock", position = [0.04, 0.0, 0.16], velocity = [0.0, 0.1, -1.0]},
    {shape = "ball", group = "rock", position = [0.01, 0.02, 0.27], velocity = [0.2, 0.0, -1.0]},
]
group = [{name = "rock", density = 2500.0}]
contact = [
    {groups = ["rock", "rock"], kn = 1e6, kt = 8e5, en2 = 0.1, mu = 0.5},
    {groups = ["rock", "wall"], kn = 1e6, kt = 8e5, en2 = 0.1, mu = 0.5},
]
output = {every = 0.05, table = true}
"""


def command(folder, *options):
    """Run the scene in ``folder`` by the command line, in a process of its own."""
    call = [sys.executable, "-m", "warpdem", "scene.toml", "--quiet", *options]
    return subprocess.run(call, cwd=folder, capture_output=True, text=True, check=False)


def states(folder):
    """Numbers of the table of a run's bodies."""
    return np.genfromtxt(folder / "trajectory.csv", delimiter=",", skip_header=1)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Folder of the scene run in both precisions, and in halves in mixed."""
    folder = tmp_path_factory.mktemp("precision")
    (folder / "scene.toml").write_text(SCENE)
    mixed = ("--set", 'run.precision="mixed"')
    for name, options in {"float64": (), "mixed": mixed}.items():
        assert command(folder, "--out", name, *options).returncode == 0
    half = ("--out", "halves", *mixed)
    assert command(folder, *half, "--set", "run.duration=0.05").returncode == 0
    assert command(folder, *half, "--resume").returncode == 0
    return folder


def test_mixed_precision_moves_bodies_as_double_does(runs):
    double, mixed = states(runs / "float64"), states(runs / "mixed")

    assert not np.array_equal(double, mixed)
    places = slice(2, 5)
    assert mixed[:, places] == pytest.approx(double[:, places], rel=0, abs=5e-6)
    assert mixed == pytest.approx(double, rel=0, abs=1e-3)


def test_a_mixed_run_that_stopped_goes_on_bitwise(runs):
    assert np.array_equal(states(runs / "mixed"), states(runs / "halves"))


def test_a_run_tells_its_precision(runs):
    told = [json.loads((runs / name / "summary.json").read_text()) for name in ("float64", "mixed")]

    assert [one["precision"] for one in told] == ["float64", "mixed"]


def test_a_run_is_not_resumed_in_another_precision(runs):
    ended = command(runs, "--out", "mixed", "--resume")

    assert ended.returncode == 2
    assert "run.precision" in ended.stderr


def test_a_process_has_one_precision():
    scene = loads(SCENE, overrides=[f'run.precision="{OTHER}"'])

    with pytest.raises(WarpdemError, match="a process of its own"):
        Simulation(scene)


def test_candidates_and_pairs_take_less_memory_in_mixed_precision():
    double, mixed = (
        check(loads(SCENE, overrides=[f'run.precision="{name}"'])).memory.sizes
        for name in ("float64", "mixed")
    )

    assert mixed["candidate"] < 0.85 * double["candidate"]
    assert mixed["pair"] < 0.85 * double["pair"]


def test_rockfall_is_in_double_precision(tmp_path):
    (tmp_path / "scene.toml").write_text(
        'run = {method = "nonsmooth", precision = "mixed", duration = 1.0}'
    )

    with pytest.raises(SceneError, match=r'precision.*only with run\.method = "smooth"'):
        load(tmp_path / "scene.toml")
