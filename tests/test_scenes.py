"""Every scene of the gallery checks clean and runs a few steps."""

import json
from pathlib import Path

import pytest

from warpdem import load
from warpdem.__main__ import main
from warpdem.checks.check import check

SCENES = sorted((Path(__file__).resolve().parents[1] / "scenes").glob("*.toml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_checks_without_warnings(path):
    report = check(load(path))

    assert list(report.problems) == []
    assert list(report.warnings) == []


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_runs_a_few_steps(path, tmp_path):
    out = tmp_path / "run"
    sets = ["--set", "run.duration=0.004", "--set", "output.every=0.002"]

    assert main([str(path), "--out", str(out), "--quiet", *sets]) == 0
    assert json.loads((out / "summary.json").read_text())["status"] == "finished"
    assert (out / "bodies.pvd").stat().st_size > 0
