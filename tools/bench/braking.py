"""Energy that strong damping creates at the automatic step: columns of slabs, light walls.

    python tools/bench/braking.py

Columns of thin slabs on a floor, e from .7 to .05, .1 s: kinetic and elastic energy at the end over
what sinking into the springs sets free, and the error of the balance. Then a wall that pushes a
block of 2 kg with 60 N: error of the balance over the work of the force. Exit status 1 if a column
ends with more than twice what was set free, or a balance misses by more than 1 %.
"""

from __future__ import annotations

import sys
from typing import Any

from rockable_cases import verdict

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

THICK = 0.08
SINKING = 1e-5
"""Static overlap under the whole column [m]."""
KN = 0.25 * 9.81 / SINKING
END = 0.1
LIMIT = 0.01


def column(count: int, e: float) -> Simulation:
    """Slabs of two sizes on each other, 1 kg in all, the top one spinning a little."""
    sizes = {"a": [0.11, 0.25, THICK], "b": [0.13, 0.27, THICK]}
    slabs = [
        {
            "shape": "ab"[k % 2],
            "position": [0.0, 0.0, THICK * (k + 0.5)],
            "density": 1.0 / count,
            "spin": [0.01, 0.02, 0.0] if k == count - 1 else [0.0] * 3,
        }
        for k in range(count)
    ]
    floor = {"shape": "floor", "position": [0.0, 0.0, -0.5], "fixed": True}
    shapes: list[dict[str, Any]] = [
        {
            "kind": "box",
            "name": name,
            "size": size,
            "rounding": 1e-3,
            "volume": 1.0,
            "inertia_over_mass": [
                (size[1] ** 2 + THICK**2) / 12.0,
                (size[0] ** 2 + THICK**2) / 12.0,
                (size[0] ** 2 + size[1] ** 2) / 12.0,
            ],
        }
        for name, size in sizes.items()
    ]
    shapes.append({"kind": "box", "name": "floor", "size": [4.0, 4.0, 1.0], "rounding": 0.05})
    law = {"kn": KN, "kt": 0.8 * KN, "mu": 0.5, "en2": e * e}
    return simulated(shapes, [*slabs, floor], law, gravity=-9.81)


def wall(mass: float, e: float) -> Simulation:
    """A wall of so many kg that pushes a block with 60 N."""
    plate = {"name": "wall", "shape": "plate", "position": [0.0, 0.0, -0.01], "fixed": True}
    block = {"shape": "block", "position": [0.0, 0.0, 0.05], "density": 2000.0}
    shapes = [
        {"kind": "box", "name": "plate", "size": [0.4, 0.4, 0.02], "rounding": 0.004},
        {"kind": "box", "name": "block", "size": [0.1, 0.1, 0.1], "rounding": 0.004},
    ]
    push = {"kind": "control", "bodies": ["wall"], "force": {"z": 60.0}, "mass": mass}
    law = {"kn": 1e5, "kt": 0.0, "mu": 0.0, "en2": e * e}
    return simulated(shapes, [plate, block], law, driver=[push])


def simulated(
    shapes: list[Any], bodies: list[Any], law: dict[str, Any], *, gravity: float = 0.0, **more: Any
) -> Simulation:
    """The scene at its automatic step."""
    scene = {
        "run": {"duration": END},
        "gravity": {"vector": [0.0, 0.0, gravity]},
        "shape": shapes,
        "body": bodies,
        "contact": [{"groups": ["default"] * 2, **law}],
        **more,
    }
    return Simulation(Scene.model_validate(scene), device="cpu", threads=1)


def main() -> int:
    passes = []
    print(f"{'slabs':>5s} {'e':>6s} {'energy / set free':>18s} {'balance [J]':>12s}")
    for count in (2, 5, 20):
        for e in (0.7, 0.5, 0.3, 0.135, 0.05):
            simulation = column(count, e)
            simulation.advance(END)
            energy = simulation.snapshot().energy
            assert energy
            free = 9.81 * SINKING * count
            left = (energy.kinetic + energy.elastic) / free
            passes.append(left < 2.0)
            print(f"{count:5d} {e:6.3f} {left:18.3f} {energy.balance:12.1e}  {verdict(passes[-1])}")
    print(f"{'wall [kg]':>12s} {'e':>6s} {'balance / work':>15s}")
    for mass in (2.0, 0.2, 0.01, 0.001):
        for e in (0.7, 0.1):
            simulation = wall(mass, e)
            simulation.advance(END)
            energy = simulation.snapshot().energy
            assert energy
            miss = energy.balance / energy.work
            passes.append(abs(miss) < LIMIT)
            print(f"{mass:12.3f} {e:6.2f} {miss:15.1e}  {verdict(passes[-1])}")
    return 0 if all(passes) else 1


if __name__ == "__main__":
    sys.exit(main())
