"""A fixed number of steps of a scene, its instructions counted by callgrind when run under it.

    python counted.py SCENE.toml --warm STEPS --steps STEPS

Counting is switched on for the steps alone, by the request that callgrind.h makes (a few machine
instructions that do nothing outside valgrind; x86-64 alone). Kernels are compiled for x86-64-v3
instead of this machine, so that counts are those of others, and valgrind knows the instructions.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import json
import mmap
from math import inf
from pathlib import Path

import warp as wp

wp.config.cpu_compiler_flags = wp.config.cpu_compiler_flags.replace(
    "-march=native", "-target-cpu x86-64-v3"
)

from warpdem.input.decode import load  # noqa: E402 - after the flags
from warpdem.precision import bind  # noqa: E402 - the same

START, STOP = 0x43540004, 0x43540005
"""Callgrind's requests to start and stop instrumentation."""
# mov rax, rdi; xor edx, edx; rol rdi by 3, 13, 61, 51; xchg rbx, rbx; mov rax, rdx; ret
REQUEST = bytes.fromhex("4889f831d248c1c70348c1c70d48c1c73d48c1c7334887db4889d0c3")


class Counter:
    """Callgrind's instrumentation, off at the start."""

    def __init__(self) -> None:
        self._page = mmap.mmap(-1, mmap.PAGESIZE, prot=7)
        self._page.write(REQUEST)
        start = ctypes.addressof(ctypes.c_char.from_buffer(self._page))
        self._call = ctypes.CFUNCTYPE(ctypes.c_uint64, ctypes.c_void_p)(start)

    def ask(self, request: int) -> None:
        """Make a request of callgrind; without it nothing happens."""
        words = (ctypes.c_uint64 * 6)(request)
        self._call(ctypes.addressof(words))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--warm", type=int, default=100)
    parser.add_argument("--steps", type=int, default=100)
    asked = parser.parse_args()
    gc.disable()
    scene = load(asked.scene)
    bind(scene.run.precision)
    from speed.worker import advance, described  # noqa: PLC0415 - once the precision is bound
    from warpdem import simulation as stepping  # noqa: PLC0415 - the same

    stepping.PATIENCE = inf  # no look at the clock: each run asks the host equally often
    simulation = stepping.Simulation(scene, device="cpu", threads=1)
    advance(simulation, asked.warm)
    counter, before = Counter(), simulation.step_count
    counter.ask(START)
    advance(simulation, asked.steps)
    counter.ask(STOP)
    print(json.dumps(described(simulation) | {"steps": simulation.step_count - before}))


if __name__ == "__main__":
    main()
