"""Pictures of frames, drawn off-screen."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista
from falling import cube, placement, snapshot

from warpdem.output import vtu
from warpdem.output.series import Series
from warpdem.output.surfaces import Surfaces

RENDER = Path(__file__).resolve().parents[1] / "tools" / "render.py"


@pytest.fixture
def run(tmp_path):
    """A folder with one frame: a moving cube above a fixed one."""
    at = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]]
    surfaces = Surfaces({"cube": cube()}, placement(at, fixed=[True, False]))
    grid = surfaces.grid(snapshot(at), ("body", "speed", "mass"))
    Series(tmp_path, "bodies").append(0.0, lambda part: vtu.write(part, grid, "lz4"))
    return tmp_path


def render(run, *arguments):
    command = [sys.executable, RENDER, run, "--size", "160", "100", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_picture_shows_the_bodies(run):
    done = render(run, "-o", run / "picture.png")
    assert done.returncode == 0, done.stderr
    pixels = np.asarray(pyvista.read(run / "picture.png").point_data["PNGImage"])
    assert pixels.shape[0] == 160 * 100
    assert len(np.unique(pixels, axis=0)) > 50


@pytest.mark.parametrize(
    ("arguments", "message"),
    [(["--frame", "3"], "holds frames 0 to 0"), (["--color", "hue"], "no field hue")],
)
def test_what_is_not_there_is_told_without_a_traceback(run, arguments, message):
    done = render(run, *arguments, "-o", run / "picture.png")
    assert done.returncode == 2
    assert message in done.stderr
    assert "Traceback" not in done.stderr
