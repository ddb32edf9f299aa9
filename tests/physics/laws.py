"""Two balls, or a block on the floor, under one contact law each: scenes of the law tests."""

import numpy as np

from scenes import ball, body, laboratory

RADIUS, MASS, KN = 0.1, 1.0, 1e4
OBLIQUE = {"kn": KN, "kt": 8e3, "mu": 0.3, "kr": 5.0, "mur": 0.01}
END = 0.2


def oblique(rules, dt, *, shift=0.0, **run):
    """Two spinning balls that meet off their line of centres at .04 s."""
    balls = [
        body("ball", [0.0, 0.0, 3.0], velocity=[0.5, 0.0, 0.0], spin=[0.0, 3.0, 1.0]),
        body("ball", [0.22 + shift, 0.05, 3.01], velocity=[-1.5, 0.3, 0.0], spin=[1.0, 0.0, 5.0]),
    ]
    return laboratory([ball("ball", RADIUS)], balls, {**OBLIQUE, **rules}, dt=dt, **run)


def imbalance(rules, dt, *, phases=4, **run):
    """Largest error of the energy balance over the kinetic energy at the start.

    During the contact and after it, averaged over phases of the onset within a step.
    """
    found = []
    for phase in range(phases):
        simulation = oblique(rules, dt, shift=phase * 2.0 * dt / phases, **run)
        start = simulation.snapshot().energy.kinetic
        worst = 0.0
        for instant in np.linspace(0.01, END, 8):
            simulation.advance(instant)
            worst = max(worst, abs(simulation.snapshot().energy.balance))
        found.append(worst / start)
    return float(np.mean(found))


def head_on(rules, speed, dt, *, distance=2.0 * RADIUS, **run):
    """Two balls along their line of centres, ``speed`` of one against the other."""
    balls = [
        body("ball", [0.0, 0.0, 3.0], velocity=[0.5 * speed, 0.0, 0.0]),
        body("ball", [distance, 0.0, 3.0], velocity=[-0.5 * speed, 0.0, 0.0]),
    ]
    rules = {"kn": KN, "kt": 0.0, "mu": 0.0, **rules}
    return laboratory([ball("ball", RADIUS)], balls, rules, dt=dt, **run)


def separation(simulation):
    """Speed at which the two balls go apart [m/s]."""
    return float(np.diff(simulation.snapshot().velocity[:2, 0])[0])
