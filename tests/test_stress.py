"""The scenes of tools/stress, each with fewer steps."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
QUICK = (
    *("heavy", "stiff", "tower", "tower10", "creep", "bullet", "far", "top", "rotor", "bonds"),
    *("overlaps", "nonsense", "laws", "flight", "drum", "sizes", "slope"),
)
SLOW = ("needles", "limit", "packing", "meshes", "plane")


def run_short(names, folder):
    """What the command writes of some scenes in short."""
    figures = folder / "figures.json"
    command = [sys.executable, str(ROOT / "tools" / "stress" / "run.py"), *names, "--short"]
    run = subprocess.run(
        [*command, "--json", str(figures)], capture_output=True, text=True, check=False
    )
    assert figures.exists(), run.stderr
    rows = json.loads(figures.read_text())["rows"]
    passes = all(figure["passes"] for row in rows for figure in row["figures"])
    assert run.returncode == (0 if passes else 1)
    return rows


@pytest.mark.parametrize("names", [QUICK, pytest.param(SLOW, marks=pytest.mark.slow)])
def test_stress_scenes_stay_within_their_gates(names, tmp_path):
    rows = run_short(names, tmp_path)
    assert [row["name"] for row in rows] == [*names]
    assert all(row["figures"] for row in rows)
    beyond = [
        f"{row['name']}: {figure['metric']} = {figure['value']:.3g}, gate {figure['gate']:.3g}"
        for row in rows
        for figure in row["figures"]
        if not figure["passes"]
    ]
    assert beyond == []


def test_no_stress_scene_is_left_out():
    text = (ROOT / "tools" / "stress" / "run.py").read_text()
    named = {*QUICK, *SLOW}
    assert all(f'"{name}": ' in text for name in named)
    assert text.count(": ", text.index("ROWS: "), text.index("HEAD = ")) == len(named) + 1
