"""Precision of the device code, which a process has once: bound before its kernels are imported."""

from __future__ import annotations

from warpdem.errors import WarpdemError
from warpdem.kernels.choice import choose, kernels_are


def bind(name: str) -> None:
    """Have the kernels of this process be of a precision, or see that they are.

    Raises:
        WarpdemError: They have another one already.
    """
    bound = kernels_are()
    if bound is None:
        choose(name)
    elif bound != name:
        raise WarpdemError(
            f'run.precision = "{name}": this process has kernels of "{bound}" already, and can '
            "have but one; run this scene in a process of its own, or bind it before anything "
            f'else: warpdem.precision.bind("{name}")'
        )
