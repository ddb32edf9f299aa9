"""Every scene of the gallery checks clean and runs a few steps."""

import json
from pathlib import Path

import pytest

from warpdem import load
from warpdem.__main__ import main
from warpdem.checks.check import check

SCENES = sorted((Path(__file__).resolve().parents[1] / "scenes").glob("*.toml"))
ROCKFALL = [path for path in SCENES if path.stem.startswith("rockfall")]
SMOOTH = [path for path in SCENES if path not in ROCKFALL]


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_checks_without_warnings(path):
    report = check(load(path))

    assert list(report.problems) == []
    assert [text for text in report.warnings if not text.startswith("UNVERIFIED")] == []


@pytest.mark.parametrize("path", SMOOTH, ids=lambda path: path.stem)
def test_scene_runs_a_few_steps(path, tmp_path):
    out = tmp_path / "run"
    sets = ["--set", "run.duration=0.004", "--set", "output.every=0.002"]

    assert main([str(path), "--out", str(out), "--quiet", *sets]) == 0
    assert json.loads((out / "summary.json").read_text())["status"] == "finished"
    assert (out / "bodies.pvd").stat().st_size > 0


@pytest.mark.parametrize("path", ROCKFALL, ids=lambda path: path.stem)
def test_scene_flies_a_few_rocks(path, tmp_path):
    out = tmp_path / "run"
    sets = ["--set", "ensemble.count=24", "--set", "output.trajectories=3"]

    assert main([str(path), "--out", str(out), "--quiet", *sets]) == 0
    facts = json.loads((out / "summary.json").read_text())
    assert (facts["status"], facts["trajectories"]) == ("finished", 24)
    names = {file.name for file in out.iterdir()}
    assert {"deposits.csv", "energy_q95.asc", "trajectories.vtu", "map.png"} <= names
    assert {"barriers.csv", "barrier_statistics.csv"} <= names or "valley" not in path.stem
