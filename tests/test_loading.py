"""Kernels made ready: which modules, in which order, and what compilers lend to one another."""

import subprocess
import sys

import pytest
import warp as wp
from colliding import heap, scene
from warpdem.kernels.variant import variant

from warpdem import loading
from warpdem.compile import QUICK, SLOW, kernels_of
from warpdem.simulation import Simulation

HEAVY = ("vtkmodules", "pyvista", "scipy", "matplotlib", "meshio", "rasterio")


def filling(value):
    @variant
    def fill(numbers: wp.array(dtype=wp.float64)):
        numbers[wp.tid()] = wp.static(value)

    return fill


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """Headers kept in one folder, and the compiler's own in another."""
    own = tmp_path / "own"
    own.mkdir()
    monkeypatch.setattr(loading, "_own_folder", lambda: own)
    monkeypatch.setattr(wp.config, "kernel_cache_dir", str(tmp_path))
    return loading.Headers(), own


def test_a_module_is_loaded_once_and_the_last_one_first():
    first, second = filling(wp.float64(1.0)), filling(wp.float64(2.0))
    told = []

    loading.load_kernels(
        [("one", first), ("one again", first), ("two", second)], "cpu", told.append
    )

    assert told == ["kernels 1/2", "kernels 2/2: one"]
    numbers = wp.zeros(1, dtype=wp.float64, device="cpu")
    wp.launch(second, dim=1, inputs=[numbers], device="cpu")
    assert numbers.numpy()[0] == 2.0


def test_a_kernel_that_cannot_be_built_is_a_fault():
    @variant
    def wrong(numbers: wp.array(dtype=wp.float64)):
        numbers[wp.tid()] = "word"

    with pytest.raises(Exception, match="wrong"):
        loading.load_kernels([("wrong", wrong), ("right", filling(wp.float64(3.0)))], "cpu")


def test_headers_read_once_are_lent_to_other_compilers(shelf):
    headers, own = shelf
    (own / "builtin_a.pch").write_bytes(b"read")
    headers.keep()
    (own / "builtin_a.pch").unlink()
    headers.lend()

    assert (own / "builtin_a.pch").read_bytes() == b"read"


def test_headers_that_cannot_be_kept_are_no_fault(shelf, tmp_path, monkeypatch):
    _, own = shelf
    (own / "builtin_a.pch").write_bytes(b"read")
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(wp.config, "kernel_cache_dir", str(tmp_path / "file"))
    headers = loading.Headers()
    headers.keep()
    headers.lend()

    assert [file.name for file in own.iterdir()] == ["builtin_a.pch"]


def test_a_scene_needs_few_modules():
    simulation = Simulation(scene([*heap()]), device="cpu")
    kernels = kernels_of(simulation._model, simulation._state, simulation._lists, simulation._whole)

    assert len({kernel.module for kernel in kernels.values()}) <= 13
    assert {*QUICK} <= {*kernels}
    assert {*SLOW} & {*kernels}


def test_a_run_without_surfaces_loads_no_library_that_draws_or_reads_meshes(tmp_path):
    code = f"""
import sys
from warpdem.__main__ import main
main(["scenes/drum.toml", "--out", {str(tmp_path / "run")!r}, "--quiet", "--set",
      "output.surface=false", "--set", "run.duration=1e-4"])
print([name for name in {HEAVY} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout.strip() == "[]"
