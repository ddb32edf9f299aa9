"""Laws at the ends of their ranges, against closed forms of a ball that hits a plane."""

from __future__ import annotations

from math import acosh, cos, exp, pi, sqrt
from typing import TYPE_CHECKING

from rig import Figure, Way

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.snapshot import Snapshot

KN, RADIUS, INERTIA = 1e9, 0.1, 0.004
SPEED, SLIDING = 1.0, 0.6
CONTACT = pi / sqrt(KN)
"""Duration of an undamped impact of 1 kg [s]."""
STEPS = 4000
"""Of an undamped impact: where mu is 1e3 friction ends with a jump, right to half a step."""
GATE = 1e-3


def laws(way: Way) -> Iterator[Figure]:
    """Damping ratio 1.5, e .05, kt/kn 10, mu 0 and 1e3."""
    zeta = 1.5
    shot = _impact(way, "contact.0.damping_ratio=1.5", drop="en2")
    expected = exp(-2.0 * zeta * acosh(zeta) / sqrt(zeta**2 - 1.0))
    yield Figure("zeta 1.5: e against its closed form", abs(_e(shot) - expected), GATE)
    shot = _impact(way, "contact.0.en2=0.0025")
    yield Figure("e .05: e delivered", abs(_e(shot) - 0.05), GATE)
    yield from _tangential(way, "kt/kn 10, mu 1e3", kt=10.0 * KN, mu=1e3)
    yield from _tangential(way, "mu 1e3", kt=0.8 * KN, mu=1e3)
    yield from _sliding(way)
    shot = _impact(way, "contact.0.mu=0.0", "contact.0.kt=1e10")
    kept = abs(shot.velocity[0, 0] / SLIDING - 1.0) + abs(shot.spin[0]).max()
    yield Figure("mu 0: sliding and spin kept, relative", float(kept), 1e-15)
    yield Figure("mu 0, e 1: e delivered", abs(_e(shot) - 1.0), GATE)


def _tangential(way: Way, what: str, *, kt: float, mu: float) -> Iterator[Figure]:
    """A contact that sticks throughout: its tangential spring swings as often as it is stiff."""
    shot = _impact(way, f"contact.0.kt={kt!r}", f"contact.0.mu={mu!r}")
    square = kt * (1.0 + RADIUS**2 / INERTIA)
    # velocity of the lowest point after the time of the normal impact
    after = SLIDING * cos(sqrt(square) * CONTACT)
    point = shot.velocity[0, 0] - RADIUS * shot.spin[0, 1]
    yield Figure(f"{what}: velocity of the point [m/s]", abs(float(point) - after), GATE)
    # what the point lost is shared by motion and spin
    change = (SLIDING - after) / (1.0 + RADIUS**2 / INERTIA)
    off = abs(SLIDING - float(shot.velocity[0, 0]) - change)
    yield Figure(f"{what}: velocity of the ball [m/s]", off, GATE)


def _sliding(way: Way) -> Iterator[Figure]:
    """kt/kn 10 and mu .01, so little that it slips throughout: the impulse is mu times 2 m v."""
    shot = _impact(way, "contact.0.kt=1e10", "contact.0.mu=0.01")
    off = abs(SLIDING - float(shot.velocity[0, 0]) - 0.02 * SPEED)
    yield Figure("kt/kn 10, mu .01: impulse of sliding [m/s]", off, GATE)


def _e(shot: Snapshot) -> float:
    return float(shot.velocity[0, 2]) / SPEED


def _impact(way: Way, *changes: str, drop: str = "") -> Snapshot:
    """The ball after its impact, which takes so many steps."""
    motion = f"body.0.velocity={[SLIDING, 0.0, -SPEED]}"
    dt = CONTACT / STEPS
    simulation = way.simulation("impact", f"run.dt={dt!r}", motion, *changes, drop=drop)
    simulation.advance(4.0 * CONTACT)
    return simulation.snapshot()
