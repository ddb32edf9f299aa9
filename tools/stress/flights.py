"""Bodies that nothing touches: a fast top, a slow one for long, flight for long."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
from rig import Figure, Way

from warpdem.geometry.orientation import turned

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.simulation import Simulation
    from warpdem.snapshot import Snapshot

G = 9.81


def top(way: Way) -> Iterator[Figure]:
    """A top at 1e4 rad/s, tilted against its momentum, .05 rad a step."""
    end = way.pick(1.0, 0.05)
    moments, spin = (1.0, 1.0, 1.8), np.array([1e3, 0.0, 1e4])
    dt = 0.05 / float(np.linalg.norm(spin))
    simulation = _rotor(way, moments, spin, dt)
    start = simulation.snapshot()
    simulation.advance(end)
    shot = simulation.snapshot()
    # its axis goes round the momentum at a constant rate |L|/A
    momentum = np.array(moments) * spin
    rate, axis = momentum / moments[0], np.array([0.0, 0.0, 1.0])
    angle = np.linalg.norm(rate) * shot.time
    expected = _about(rate / np.linalg.norm(rate), angle, axis)
    off = np.linalg.norm(turned(shot.orientation[0], axis) - expected)
    energy = abs(_energy(shot, moments) / _energy(start, moments) - 1.0)
    yield Figure("energy, relative", energy, 1e-6, f"{shot.step} steps of {dt:.3g} s")
    yield Figure("axis [rad]", float(off), 1e-3)


def rotor(way: Way) -> Iterator[Figure]:
    """A top of moments 1, 2, 3 for 1000 s at steps of .01 s."""
    moments, spin = (1.0, 2.0, 3.0), np.array([0.3, 1.0, 0.2])
    simulation = _rotor(way, moments, spin, 1e-2)
    begun = _momentum(simulation.snapshot(), moments)
    energy = lost = 0.0
    start = _energy(simulation.snapshot(), moments)
    for until in np.linspace(0.0, way.pick(1000.0, 20.0), 101)[1:]:
        simulation.advance(float(until))
        shot = simulation.snapshot()
        energy = max(energy, abs(_energy(shot, moments) / start - 1.0))
        off = np.linalg.norm(_momentum(shot, moments) - begun) / np.linalg.norm(begun)
        lost = max(lost, float(off))
    yield Figure("energy, relative", energy, 1e-6, f"{shot.step} steps")
    yield Figure("angular momentum, relative", lost, 1e-13)


def flight(way: Way) -> Iterator[Figure]:
    """1000 s of free flight, without gravity and with it; what a step of it costs."""
    # each step rounds alike: the error grows by some 4e-17 of the place a step, whatever dt
    end = way.pick(1000.0, 100.0)
    velocity = np.array([0.1, -0.7, 30.0])
    for what, pull in (("straight", 0.0), ("falling", -G)):
        changes = (f"gravity.vector={[0.0, 0.0, pull]}", f"body.0.velocity={velocity.tolist()}")
        simulation = way.simulation("free", "run.dt=0.1", *changes)
        simulation.advance(end)
        shot = simulation.snapshot()
        expected = velocity * shot.time + 0.5 * np.array([0.0, 0.0, pull]) * shot.time**2
        off = np.abs(shot.position[0] - expected).max() / np.abs(expected).max()
        yield Figure(f"{what}: place, relative", float(off), 1e-12, f"{shot.step} steps")
        faster = velocity + np.array([0.0, 0.0, pull]) * shot.time
        off = np.abs(shot.velocity[0] - faster).max() / np.abs(faster).max()
        yield Figure(f"{what}: velocity, relative", float(off), 1e-12)
    if way.short:
        # seconds prove nothing on a machine with other work
        return
    count, settled = 300, 1.2
    flying = _seconds(way, count, 0.0, "gravity.vector=[0.0, 0.0, 0.0]")
    touching = _seconds(way, count, settled)
    note = f"{1e9 * flying / count:.0f} ns a body against {1e9 * touching / count:.0f}"
    yield Figure("a step over one of the same bodies in a heap", flying / touching, 0.1, note)


def _seconds(way: Way, count: int, since: float, *changes: str) -> float:
    """Least time of a step of the packing's bodies from some simulated time on [s]."""
    region = "{ min = [-0.25, -0.25, 0.0], max = [0.25, 0.25, 4.0] }"
    sizes = (f"fill.0.count={count}", f"fill.0.region={region}")
    simulation = way.simulation("packing", "run.dt=1e-4", *sizes, *changes)
    simulation.advance(since + 100 * simulation.dt)
    best, steps = np.inf, 500
    for _ in range(10):
        begun = time.perf_counter()
        simulation.advance(simulation.time + steps * simulation.dt)
        best = min(best, time.perf_counter() - begun)
    return best / steps


def _rotor(
    way: Way, moments: tuple[float, float, float], spin: np.ndarray, dt: float
) -> Simulation:
    changes = (f"shape.0.inertia_over_mass={list(moments)}", f"body.0.spin={spin.tolist()}")
    return way.simulation("free", f"run.dt={dt!r}", *changes)


def _momentum(shot: Snapshot, moments: tuple[float, float, float]) -> np.ndarray:
    """Angular momentum of a body of 1 kg, world [kg m^2/s]."""
    q = shot.orientation[0]
    own = turned(q * np.array([1.0, -1.0, -1.0, -1.0]), shot.spin[0])
    return turned(q, own * np.array(moments))


def _energy(shot: Snapshot, moments: tuple[float, float, float]) -> float:
    """Energy of turning of a body of 1 kg [J]."""
    return 0.5 * float(shot.spin[0] @ _momentum(shot, moments))


def _about(axis: np.ndarray, angle: float, v: np.ndarray) -> np.ndarray:
    """A vector turned about a unit axis."""
    along = axis * (axis @ v)
    return along + np.cos(angle) * (v - along) + np.sin(angle) * np.cross(axis, v)
