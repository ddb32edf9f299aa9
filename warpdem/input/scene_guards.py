"""What is done before a run, and looked after in it, so that it stays physical."""

from typing import Annotated, Literal

from pydantic import Field

from warpdem.input.scene_values import Positive, Section


class Relax(Section):
    """Before time zero, bodies that overlap are pushed apart.

    They move by the springs of their contacts alone, without friction, attraction, gravity and
    drivers, all are stopped after every few steps, and none goes farther in one than ``stride``;
    then they have the velocities of the scene. Needs bodies that may move: what is fixed stays.
    """

    overlap: Annotated[float, Field(gt=0, lt=0.5)] = 0.01
    """Largest overlap left, over the way to the middle of the thinner of two bodies, roundings
    included [-]."""

    stride: Annotated[float, Field(gt=0, le=0.1)] = 0.02
    """Longest way of a body between two stops, over its bounding radius [-]."""

    steps: Annotated[int, Field(ge=1, le=10**9)] = 20000
    """Most steps it may take; then what is left is an error."""


class EnergyGuard(Section):
    """Watches that energy does not grow: needs output.energy.

    What is stored (motion, height, springs, bonds), less the work of drivers, of the cell and of
    forces but gravity, may only fall. It is looked at every 64 steps.
    """

    growth: Positive = 0.05
    """Growth above its lowest value so far, over the largest sum of kinetic and elastic energy so
    far [-]: friction and dashpots that err by more are told."""

    action: Literal["stop", "note"] = "stop"
    """"stop" the run (exit status 3), or "note" it once; both with the body that gained most."""
