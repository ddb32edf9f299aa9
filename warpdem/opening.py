"""The public door to a simulation: it binds the scene's precision before kernels are imported."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.precision import bind

if TYPE_CHECKING:
    from warpdem.input.scene import Scene
    from warpdem.simulation import Simulation as Simulation_


def Simulation(scene: Scene, **options: Any) -> Simulation_:  # noqa: N802 - stands for the class
    """The bodies of a scene in motion; see ``warpdem.simulation.Simulation`` for the options.

    Raises:
        WarpdemError: As of the class; and another precision is bound in this process.
    """
    bind(scene.run.precision)
    from warpdem.simulation import Simulation  # noqa: PLC0415 - binds the precision

    return Simulation(scene, **options)
