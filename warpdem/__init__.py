"""Rigid sphero-polyhedra in contact, on NVIDIA Warp.

``load`` reads a scene, ``Simulation`` sets its bodies in motion and ``Snapshot`` shows them::

    import warpdem

    simulation = warpdem.Simulation(warpdem.load("scenes/hopper.toml"))
    simulation.advance(until=0.5)
    print(simulation.snapshot().position)

``run`` does it all and writes files, as ``python -m warpdem`` does.
"""

from typing import TYPE_CHECKING, Any

from warpdem.errors import (
    CapacityError,
    GeometryError,
    OutputError,
    Problem,
    SceneError,
    UnstableError,
    WarpdemError,
)

if TYPE_CHECKING:
    from warpdem.input.decode import load, loads
    from warpdem.input.scene import Scene
    from warpdem.running.runner import run
    from warpdem.simulation import Simulation
    from warpdem.snapshot import Contacts, Energy, Snapshot

__version__ = "0.1.0"

__all__ = [
    "CapacityError",
    "Contacts",
    "Energy",
    "GeometryError",
    "OutputError",
    "Problem",
    "Scene",
    "SceneError",
    "Simulation",
    "Snapshot",
    "UnstableError",
    "WarpdemError",
    "load",
    "loads",
    "run",
]

_HOMES = {
    "Contacts": "snapshot",
    "Energy": "snapshot",
    "Scene": "input.scene",
    "Simulation": "opening",
    "Snapshot": "snapshot",
    "load": "input.decode",
    "loads": "input.decode",
    "run": "running.runner",
}


def __getattr__(name: str) -> Any:
    """Public names are loaded when first used: checking a scene must not wait for Warp."""
    if name not in _HOMES:
        raise AttributeError(f"module 'warpdem' has no attribute {name!r}")
    from importlib import import_module  # noqa: PLC0415 - needed here alone

    return getattr(import_module(f"warpdem.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])
