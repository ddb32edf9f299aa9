"""The public door to a simulation: it binds the scene's precision before kernels are imported."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.errors import WarpdemError
from warpdem.precision import bind

if TYPE_CHECKING:
    from warpdem.input.scene import Scene
    from warpdem.simulation import Simulation as Simulation_


def admit(scene: Scene) -> None:
    """See that a scene can be simulated in this process, and bind its precision.

    Raises:
        WarpdemError: It is one of rockfall, or another precision is bound already.
    """
    if scene.run.method != "smooth":
        raise WarpdemError('run.method = "nonsmooth": fly it by warpdem.run, not a Simulation')
    bind(scene.run.precision)


def Simulation(scene: Scene, **options: Any) -> Simulation_:  # noqa: N802 - stands for the class
    """The bodies of a scene in motion; see ``warpdem.simulation.Simulation`` for the options.

    Raises:
        WarpdemError: As of the class.
    """
    admit(scene)
    from warpdem.simulation import Simulation  # noqa: PLC0415 - binds the precision

    return Simulation(scene, **options)
