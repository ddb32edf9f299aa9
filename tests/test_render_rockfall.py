"""Rockfall drawn in space, off-screen."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import pyvista

TOOL = Path(__file__).resolve().parents[1] / "tools" / "render_rockfall.py"
SCENE = """
[run]
method = "nonsmooth"
duration = 0.5
[terrain]
file = "slope.asc"
class = "hard"
[[forest]]
density = "open"
height = 5.0
polygon = [[12, 2], [18, 2], [18, 18], [12, 18]]
[[tree]]
position = [8, 10]
diameter = 0.5
height = 4.0
mu = 0.4
[[barrier]]
name = "net"
line = [[10, 4], [10, 16]]
height = 2.0
capacity = 1e4
[[barrier]]
name = "line"
line = [[18, 4], [18, 16]]
[[rock]]
name = "block"
kind = "builder"
form = "equant"
volume = 0.2
density = 2700.0
[[release]]
rocks = ["block"]
kind = "points"
points = [[3, 10], [3, 12]]
height = 0.5
[output]
trajectories = 2
"""


def command(*words):
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slope")
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    rows = "\n".join(" ".join(str(20 - column) for column in range(20)) for _ in range(20))
    header = "ncols 20\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
    (folder / "slope.asc").write_text(header + rows + "\n", encoding="utf-8")
    made = command("-m", "warpdem", str(folder / "scene.toml"), "--out", str(folder / "run"))
    assert made.returncode == 0, made.stderr
    return folder / "run"


def test_a_picture_shows_slope_paths_and_what_stands(run, tmp_path):
    file = tmp_path / "picture.png"
    done = command(str(TOOL), str(run), "--size", "160", "100", "-o", str(file))
    assert done.returncode == 0, done.stderr
    pixels = np.asarray(pyvista.read(file).point_data["PNGImage"])
    assert pixels.shape[0] == 160 * 100
    assert len(np.unique(pixels, axis=0)) > 50


def test_another_folder_and_a_lost_scene_are_told_without_a_traceback(run, tmp_path):
    wrong = command(str(TOOL), str(tmp_path), "-o", str(tmp_path / "picture.png"))
    assert (wrong.returncode, "holds no trajectories.vtu" in wrong.stderr) == (2, True)
    lost = command(str(TOOL), str(run), "--scene", "lost.toml", "-o", str(tmp_path / "p.png"))
    assert (lost.returncode, "say where it is by --scene" in lost.stderr) == (2, True)
