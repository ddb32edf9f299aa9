"""Damping ratio of a spring and dashpot that rebounds with a wanted restitution coefficient."""

from __future__ import annotations

from math import cos, cosh, hypot, log, pi, sin, sqrt, tan, tanh
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.input.scene_contact import Contact
    from warpdem.input.scene_run import Numerics


def zeta_bilateral(e: float) -> float:
    """Damping ratio of a contact that may pull: e = exp(-pi z/sqrt(1 - z^2)).

    Args:
        e: Restitution coefficient, in (0, 1].

    Raises:
        ValueError: ``e`` lies elsewhere.
    """
    loss = _loss(e)
    return loss / hypot(loss, pi)


def zeta_clamped(e: float) -> float:
    """Damping ratio of a contact that never pulls: e = exp(-2 z acos(z)/sqrt(1 - z^2)).

    Beyond z = 1, where e = exp(-2), acos and 1 - z^2 become acosh and z^2 - 1. Accurate to a few
    units of the last place over the whole range.

    Args:
        e: Restitution coefficient, in (0, 1].

    Raises:
        ValueError: ``e`` lies elsewhere.
    """
    loss = _loss(e)
    if loss == 0.0:
        return 0.0
    # One equation, with the unknown z = sin u, cos t or cosh t where that one is exact to rounding.
    if loss <= 1.0:
        return sin(_root(lambda u: (pi - 2.0 * u) * tan(u) - loss, 0.0, 0.5))
    if loss < 2.0:
        return cos(_root(lambda t: loss - 2.0 * t / tan(t), 0.0, 1.2))
    return cosh(_root(lambda t: 2.0 * t / tanh(t) - loss, 0.0, loss))


def damping_ratio(law: Contact, how: Numerics) -> float:
    """Damping ratio of a contact law, zero without a dashpot."""
    if not law.damped:
        return 0.0
    if law.damping_ratio is not None or law.en2 is None:
        return law.damping_ratio or 0.0
    ratio = zeta_clamped if how.restitution == "clamped" else zeta_bilateral
    return ratio(sqrt(law.en2))


def _loss(e: float) -> float:
    if not 0.0 < e <= 1.0:
        raise ValueError(f"restitution coefficient {e} must lie in (0, 1]")
    return -log(e)


def _root(rising: Callable[[float], float], low: float, high: float) -> float:
    """Where a rising function changes sign, by halving down to neighbouring numbers."""
    while low < (middle := 0.5 * (low + high)) < high:
        if rising(middle) < 0.0:
            low = middle
        else:
            high = middle
    return high
