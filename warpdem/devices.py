"""Where a simulation runs: Warp's devices by name."""

from __future__ import annotations

import os
import sys
import tempfile
from typing import Any

import warp as wp

from warpdem.errors import WarpdemError

# what Warp's native code prints on a machine without a GPU, whatever its log level
NO_GPU = "Warp CUDA warning: Could not find or load the NVIDIA CUDA driver"


def find_device(name: str) -> Any:
    """The Warp device of a name: "auto", "cpu", "cuda" or "cuda:N".

    Raises:
        WarpdemError: There is no such device.
    """
    start_warp()
    if name == "auto":
        return wp.get_preferred_device()
    try:
        return wp.get_device(name)
    except (ValueError, RuntimeError) as cause:
        known = ", ".join(str(device) for device in wp.get_devices())
        raise WarpdemError(f'run.device = "{name}": no such device; there are: {known}') from cause


def start_warp() -> None:
    """Initialise Warp once, silently but for real troubles."""
    wp.config.log_level = wp.LOG_ERROR
    sys.stderr.flush()
    kept = os.dup(2)
    with tempfile.TemporaryFile() as said:
        os.dup2(said.fileno(), 2)
        try:
            wp.init()
        finally:
            os.dup2(kept, 2)
            os.close(kept)
        said.seek(0)
        lines = said.read().decode(errors="replace").splitlines()
    for line in lines:
        if not line.startswith(NO_GPU):
            print(line, file=sys.stderr)
