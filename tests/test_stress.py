"""The scenes of tools/stress, each with fewer steps."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    figures = tmp_path_factory.mktemp("stress") / "figures.json"
    command = [sys.executable, str(ROOT / "tools" / "stress" / "run.py"), "--short"]
    run = subprocess.run(
        [*command, "--json", str(figures)], capture_output=True, text=True, check=False
    )
    assert figures.exists(), run.stderr
    found = json.loads(figures.read_text())["rows"]
    passes = all(figure["passes"] for row in found for figure in row["figures"])
    assert run.returncode == (0 if passes else 1)
    return found


def test_every_stress_scene_stays_within_its_gates(rows):
    beyond = [
        f"{row['name']}: {figure['metric']} = {figure['value']:.3g}, gate {figure['gate']:.3g}"
        for row in rows
        for figure in row["figures"]
        if not figure["passes"]
    ]
    assert beyond == []


def test_every_stress_scene_has_a_figure_and_none_is_left_out(rows):
    assert all(row["figures"] for row in rows)
    assert len(rows) == 22
