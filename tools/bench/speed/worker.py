"""One timed run of warpdem in a process of its own; prints a line of JSON.

    python worker.py SCENE.toml --threads N --warm STEPS --steps STEPS [--save FILE.npz]

The clock runs over ``steps`` steps after ``warm`` ones; reading, compiling and the first lists are
not in it. --save keeps the state at the end: position, orientation (of the shape's own axes).
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from pathlib import Path

import numpy as np

from warpdem.geometry.orientation import product
from warpdem.input.decode import load
from warpdem.simulation import Simulation


def resident() -> float:
    """Largest memory this process has had so far [bytes]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0


def advance(simulation: Simulation, steps: int) -> None:
    """So many steps further."""
    simulation.advance(simulation.time + steps * simulation.dt)


def timed(simulation: Simulation, steps: int) -> dict[str, float]:
    """Steps done, and seconds of the wall clock and of CPU time that they took."""
    before = simulation.step_count
    wall, cpu = time.perf_counter(), time.process_time()
    advance(simulation, steps)
    spent = {"wall": time.perf_counter() - wall, "cpu": time.process_time() - cpu}
    return spent | {"steps": simulation.step_count - before}


def save(simulation: Simulation, file: Path) -> None:
    """Positions and orientations of the free bodies, and of their shapes' own axes."""
    free = ~simulation.placement.fixed
    now = simulation.snapshot()
    shapes = list(simulation.polyhedra.values())
    frames = np.array([shapes[k].frame_rotation for k in simulation.placement.shape[free]])
    own = product(now.orientation[free], frames * np.array([1.0, -1.0, -1.0, -1.0]))
    np.savez(file, position=now.position[free], orientation=own)


def described(simulation: Simulation) -> dict[str, float]:
    """How much the run had to do, at its end."""
    now = simulation.snapshot(contacts=True)
    assert now.contacts is not None
    free = ~simulation.placement.fixed
    report = simulation.report()
    return {
        "bodies": int(free.sum()),
        "contacts": len(now.contacts.gap),
        "candidates": report["candidates"],
        "threads": report["threads"],
        "features": report["features"],
        "speed_rms": float(np.sqrt((now.velocity[free] ** 2).sum(axis=1).mean())),
        "height": float(now.position[free, 2].mean()),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--warm", type=int, default=0)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--save", type=Path)
    asked = parser.parse_args()
    begin = time.perf_counter()
    scene = load(asked.scene)
    read, base = time.perf_counter() - begin, resident()
    simulation = Simulation(scene, device=asked.device, threads=asked.threads)
    advance(simulation, max(asked.warm, 1))
    before = simulation.report()["rebuilds"]
    result = timed(simulation, asked.steps) | {"rebuilds": -before}
    result["rebuilds"] += simulation.report()["rebuilds"]
    start = time.perf_counter() - begin - read - result["wall"]
    result |= {"read_seconds": read, "start_seconds": start, "memory": resident() - base}
    if asked.save:
        save(simulation, asked.save)
    print(json.dumps(result | {"peak_memory": resident()} | described(simulation)))


if __name__ == "__main__":
    main()
