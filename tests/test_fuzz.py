"""Samples of tools/fuzz, and what it once broke."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from warpdem.errors import GeometryError, SceneError
from warpdem.flow import FlowError, read_flow
from warpdem.geometry.polyhedron import build
from warpdem.geometry.shapes import read_mesh
from warpdem.input.decode import loads

RUN = Path(__file__).resolve().parents[1] / "tools" / "fuzz" / "run.py"
PLY = """ply
format ascii 1.0
element vertex 3
property double x
property double y
property double z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 2
"""


def fuzz(folder, *arguments):
    command = [sys.executable, str(RUN), *arguments, "--out", str(folder / "failures")]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_mutated_scenes_pass_or_are_refused(tmp_path):
    status, told = fuzz(tmp_path, "scenes", "--count", "60", "--commands", "1", "--seed", "20")
    assert status == 0, told
    assert "60 mutated scenes" in told


def test_feature_pairs_and_solids_are_as_far_apart_as_a_quadratic_programme_says(tmp_path):
    status, told = fuzz(tmp_path, "features", "--count", "1500")
    assert status == 0, told
    assert "1500 feature pairs (seed 0), 0 failures" in told


def test_mesh_whose_header_does_not_end_is_refused(tmp_path):
    path = tmp_path / "a.ply"
    path.write_text(PLY)
    assert len(read_mesh(path)[0]) == 3
    path.write_text(PLY[:40])
    with pytest.raises(GeometryError, match="has no end"):
        read_mesh(path)


@pytest.mark.parametrize("word", ["property double z\n", "element vertex 3\n", "0 1 0\n"])
def test_mesh_that_lacks_a_line_is_refused(tmp_path, word):
    path = tmp_path / "a.ply"
    path.write_text(PLY.replace(word, ""))
    with pytest.raises(GeometryError):
        build(*read_mesh(path), name="a", radius=0.1)


@pytest.mark.parametrize(
    ("vertex", "faces", "rule"),
    [
        (1e200, [[0, 1, 2]], "beyond 1e\\+15 m"),
        (1.0, [[]], "fewer than three"),
        (1.0, np.zeros((2, 0), int), "fewer than three"),
        (1.0, [[0, 1, 2**70]], "not among 0 to 2"),
    ],
)
def test_vertices_and_faces_beyond_measure_are_refused(vertex, faces, rule):
    vertices = [[0.0, 0.0, 0.0], [vertex, 0.0, 0.0], [0.0, 1.0, 0.0]]
    with pytest.raises(GeometryError, match=rule):
        build(vertices, faces, name="a", radius=0.1)


@pytest.mark.parametrize("name", ["a.npz", "a.vti"])
@pytest.mark.parametrize("content", [b"", b'<VTKFile type="ImageData"><', b"PK\x03\x04 broken"])
def test_broken_grid_of_velocities_is_refused_without_a_word_of_its_reader(
    tmp_path, capfd, name, content
):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FlowError):
        read_flow(tmp_path / name)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    "lines",
    [
        'cell = "x"',
        "forest = [{height = 1, polygon = [[nan, 0], [inf, 0], [0, -inf]]}]",
        "ground = [{polygon = [[1e300, 0], [0, 1e300], [-1e300, -1e300], [1e300, 1e300]]}]",
    ],
)
def test_values_without_meaning_are_refused(lines):
    with pytest.raises(SceneError):
        loads(f"run = {{duration = 1}}\n{lines}\n")
