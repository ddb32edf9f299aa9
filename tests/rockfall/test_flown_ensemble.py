"""Real trajectories from a scene to their results, however they are spread."""

import os

import numpy as np
import pytest

from warpdem.errors import SceneError
from warpdem.input import decode
from warpdem.rockfall.share import Shard, Share
from warpdem.running import runner

SCENE = """
title = "slope"
run = {method = "nonsmooth", duration = 3.0, seed = 1, device = "cpu"}
terrain = {file = "slope.asc", class = "medium"}
rock = [{name = "block", kind = "builder", form = "flat", volume = 0.2, density = 2700.0}]
barrier = [{name = "line", line = [[0.0, 25.0], [60.0, 25.0]]}]
ensemble = {count = 24}
output = {trajectories = 2, compression = "none"}
[[release]]
rocks = ["block"]
kind = "line"
line = [[20.0, 40.0], [40.0, 40.0]]
height = 0.5
velocity = [0.0, -3.0, 0.0]
"""

BEYOND = '{rocks = ["block"], kind = "area", polygon = [[20.0, 40.0], [400.0, 40.0], [20.0, 50.0]]}'


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a slope, and the results of one thread and one chunk."""
    folder = tmp_path_factory.mktemp("slope")
    rows = np.repeat(0.6 * np.arange(30)[::-1, None] * 2.0, 30, axis=1)
    head = "ncols 30\nnrows 30\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9999\n"
    lines = (" ".join(f"{height:.3f}" for height in row) for row in rows)
    (folder / "slope.asc").write_text(head + "\n".join(lines) + "\n")
    (folder / "slope.toml").write_text(SCENE)
    assert run(folder, "whole", threads=1) == 0
    return folder


def run(folder, name, *overrides, **options):
    scene = decode.load(folder / "slope.toml", overrides)
    return runner.run(scene, folder / name, quiet=True, **options)


def results(folder):
    names = {path.name for path in folder.iterdir()} - {"chunks", "summary.json"}
    return {name: (folder / name).read_bytes() for name in sorted(names)}


def test_results_depend_on_neither_threads_nor_chunks_nor_shards(folder):
    whole = results(folder / "whole")
    assert {"deposits.csv", "barriers.csv", "energy_q95.asc", "trajectories.vtu"} <= whole.keys()
    assert run(folder, "threads", "ensemble.chunk=5", threads=2) == 0
    assert results(folder / "threads") == whole
    for number in (2, 1):
        share = Share(Shard(number, 2))
        assert run(folder, "shards", "ensemble.chunk=4", threads=1, share=share) == 0
    assert results(folder / "shards") == whole


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (f"release=[{BEYOND}]", "keep the area on the terrain"),
        ('output.formats=["tif"]', r"pip install 'warpdem\[geo\]'"),
    ],
)
def test_a_scene_that_cannot_be_flown_leaves_older_results(folder, monkeypatch, wrong, told):
    monkeypatch.setattr("warpdem.rockfall.prepare.find_spec", lambda name: None)
    before = results(folder / "whole")
    with pytest.raises(SceneError, match=told):
        run(folder, "whole", wrong, threads=1, force=True)
    assert results(folder / "whole") == before


def test_a_lost_chunk_comes_back_as_it_was(folder):
    run(folder, "lost", "ensemble.chunk=8", threads=1)
    before = results(folder / "lost")
    chunk = folder / "lost" / "chunks" / "chunk_000001.npz"
    kept = chunk.read_bytes()
    os.truncate(chunk, 1000)
    assert run(folder, "lost", threads=2, resume=True) == 0
    assert chunk.read_bytes() == kept
    assert results(folder / "lost") == before == results(folder / "whole")


@pytest.mark.filterwarnings("ignore::ResourceWarning")
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_results_of_worker_processes_are_those_of_threads(folder):
    pytest.importorskip("distributed")
    share = Share(workers="dask")
    assert run(folder, "workers", "ensemble.chunk=6", threads=2, share=share) == 0
    assert results(folder / "workers") == results(folder / "whole")
