"""The same code on a CUDA device: compiled everywhere, run where there is one."""

from pathlib import Path

import numpy as np
import pytest
import warp as wp

from warpdem import Simulation, load
from warpdem.compile import kernels_of
from warpdem.devices import start_warp

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
        simulation._model, simulation._state, simulation._lists, simulation._shares[0]
    )

    for kernel in kernels.values():
        wp.compile_aot_module(kernel.module, arch=HOPPER_GPU, module_dir=tmp_path, use_ptx=True)

    assert len(list(tmp_path.glob("*.ptx"))) == len({kernel.module for kernel in kernels.values()})


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
