"""The same code on a CUDA device: compiled everywhere, run where there is one."""

from pathlib import Path

import numpy as np
import pytest
import warp as wp

from warpdem import Simulation, load
from warpdem.compile import kernels_of
from warpdem.devices import start_warp
from warpdem.rockfall.flights import Fate
from warpdem.rockfall.task import prepared
from warpdem.rockfall.trajectories import Trajectories

SCENES = Path(__file__).resolve().parents[1] / "scenes"


HOPPER_GPU = 90  # compute capability


@pytest.fixture
def _device():
    start_warp()
    if not wp.is_cuda_available():
        pytest.skip("no CUDA device")


@pytest.mark.parametrize(
    "scene",
    [
        "tschamut_blocks",
        *(
            pytest.param(name, marks=pytest.mark.slow)
            for name in ("drum", "breakage", "periodic_shear", "triaxial", "winnow")
        ),
    ],
)
def test_every_kernel_compiles_for_cuda_without_a_device(scene, tmp_path):
    simulation = Simulation(load(SCENES / f"{scene}.toml"), device="cpu", threads=1)
    kernels = kernels_of(
        simulation._model, simulation._state, simulation._lists, simulation._crews[0][0]
    )

    for kernel in kernels.values():
        wp.compile_aot_module(kernel.module, arch=HOPPER_GPU, module_dir=tmp_path, use_ptx=True)

    assert len(list(tmp_path.glob("*.ptx"))) == len({kernel.module for kernel in kernels.values()})


@pytest.mark.parametrize(
    "scene",
    ["rockfall_tschamut", pytest.param("rockfall_valley", marks=pytest.mark.slow)],
)
def test_rockfall_compiles_for_cuda_without_a_device(scene, tmp_path):
    kernels = prepared(load(SCENES / f"{scene}.toml"), "cpu", "").work.flyer().kernels()

    for kernel in kernels:
        wp.compile_aot_module(kernel.module, arch=HOPPER_GPU, module_dir=tmp_path, use_ptx=True)

    assert len(list(tmp_path.glob("*.ptx"))) == len({kernel.module for kernel in kernels})


@pytest.mark.usefixtures("_device")
@pytest.mark.parametrize(
    "scene",
    ["hopper", "drum", "tschamut_blocks", "breakage", "periodic_shear", "triaxial", "winnow"],
)
def test_cuda_and_cpu_agree_before_contacts_diverge(scene):
    runs = []
    for device in ("cpu", "cuda"):
        simulation = Simulation(load(SCENES / f"{scene}.toml"), device=device)
        simulation.advance(0.05)
        runs.append(simulation.snapshot(contacts=True))

    np.testing.assert_allclose(runs[1].position, runs[0].position, rtol=0, atol=1e-9)
    assert len(runs[1].contacts.gap) == len(runs[0].contacts.gap)


@pytest.mark.usefixtures("_device")
def test_cuda_runs_repeat_bitwise_and_after_a_restore():
    scene = load(SCENES / "drum.toml")
    whole, first, second = (Simulation(scene, device="cuda") for _ in range(3))
    whole.advance(0.4)
    first.advance(0.2)
    second.restore(first.checkpoint())
    second.advance(0.4)

    assert (whole.snapshot().position == second.snapshot().position).all()


def flown(scene, device, count, **how):
    """The first trajectories of a rockfall scene."""
    ready = prepared(load(SCENES / f"{scene}.toml", [f"ensemble.count={count}"]), device, "")
    flyer = Trajectories(ready.work.site, ready.work.rocks, ready.work.method, device=device, **how)
    return flyer.fly(ready.releases.starts(np.arange(count)))


@pytest.mark.usefixtures("_device")
@pytest.mark.parametrize("scene", ["rockfall_tschamut", "rockfall_valley"])
def test_rockfall_on_cuda_does_not_depend_on_slots_nor_passes(scene):
    whole = flown(scene, "cuda", 500, slots=65_536)
    parts = flown(scene, "cuda", 500, slots=37, passes=101)

    for name in ("fate", "time", "position", "spin", "counts", "measures"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name)), name
    assert np.array_equal(whole.visits.cell, parts.visits.cell)
    assert np.array_equal(whole.visits.energy, parts.visits.energy)
    assert np.array_equal(whole.crossings.time, parts.crossings.time)


@pytest.mark.usefixtures("_device")
@pytest.mark.parametrize("scene", ["rockfall_tschamut", "rockfall_valley"])
def test_rockfall_on_cuda_and_cpu_ends_alike(scene):
    count = 2000
    ends = [flown(scene, device, count, slots=count) for device in ("cpu", "cuda")]
    ways = [np.linalg.norm(end.position - end.start, axis=1) for end in ends]
    every = np.sort(np.concatenate(ways))
    below = [np.searchsorted(np.sort(way), every, side="right") / count for way in ways]

    assert np.abs(below[0] - below[1]).max() < 1.95 * np.sqrt(2.0 / count)  # p = .001
    rests = [np.mean(end.fate == Fate.REST) for end in ends]
    assert rests[0] == pytest.approx(rests[1], abs=0.05)
