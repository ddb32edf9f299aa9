"""Housner's rocking block: flown, and read at its impacts by its equation of motion.

theta'' = -p^2 sin(alpha - theta) sign(theta); an impact keeps 1 - 3/2 sin^2 alpha of the spin.
"""

from functools import cache
from math import acos, atan2, cos, hypot, sin, sqrt

import numpy as np
from motions import about_y, flown
from slopes import G, box, fixed_step, law, plane, site_on, starts

WINDOW = 0.01
"""A flight ends so long before or after the instant of an impact [s]: later it might not be there,
earlier it would show less of the scheme."""


class Block:
    """A block that starts from rest at a part of its slenderness, about its edge x = half width.

    Args:
        half, tall: Half its width and height [m].
        part: Angle at the start, over the slenderness.
    """

    def __init__(self, half, tall, part):
        self.alpha, self._radius = atan2(half, tall), hypot(half, tall)
        self.p2 = 3.0 * G / (4.0 * self._radius)
        self._half, self._angle = half, part * self.alpha
        self._rock = box((2 * half, 0.5, 2 * tall))

    def at(self, time, dt):
        """Angle and spin after a whole number of steps, and when that is."""
        out = self.alpha - self._angle
        place = [[self._half - self._radius * sin(out), 0, self._radius * cos(out)]]
        begin = starts(place, orientation=about_y(self._angle))
        method = fixed_step(dt, time - 0.5 * dt, skip="none", tolerance=1e-8)
        end = flown(site_on(plane(), law(5.0)), self._rock, method, begin)
        tilt = 2.0 * np.arctan2(end.orientation[0, 2], end.orientation[0, 0])
        return tilt, end.spin[0, 1], end.time[0]

    def rate(self, tilt, spin):
        return np.array([spin, -self.p2 * sin(self.alpha - abs(tilt)) * np.sign(tilt)])

    def level(self, tilt, spin, direction):
        """Time until it stands level, or since it stood, and its speed of turning there."""
        state, sign, h, time = np.array([tilt, spin]), np.sign(tilt), direction * 1e-4, 0.0
        while sign * state[0] > 0.0 and abs(time) < 10 * WINDOW:
            a = self.rate(*state)
            b = self.rate(*(state + 0.5 * h * a))
            c = self.rate(*(state + 0.5 * h * b))
            d = self.rate(*(state + h * c))
            state, time = state + h / 6 * (a + 2 * b + 2 * c + d), time + h
        beyond = state[0] / state[1]  # less than a step: a straight line
        return time - beyond, self._speed_level(tilt, spin)

    def _speed_level(self, tilt, spin):
        """Speed of turning where it stands level, by its energy [rad/s]."""
        fall = cos(self.alpha - abs(tilt)) - cos(self.alpha)
        return sqrt(spin**2 + 2.0 * self.p2 * fall)

    def amplitude(self, speed):
        """Largest angle after standing level with a spin [rad]."""
        return self.alpha - acos(cos(self.alpha) + 0.5 * speed**2 / self.p2)


@cache
def rockings(half, tall, part, instants, dt):
    """Quarter times, amplitudes and spins about impacts that should be at some instants.

    Returns:
        Arrays by the names of the reference's, one value an impact.
    """
    block = Block(half, tall, part)
    found = {"quarter_times": [], "amplitudes": [], "omega_before": [], "omega_after": []}
    top, last = part * block.alpha, 0.0
    for k, instant in enumerate(instants):
        tilt, spin, time = block.at(instant - WINDOW, dt)
        wait, before = block.level(tilt, spin, 1.0)
        landed = time + wait
        found["quarter_times"].append((landed - last) / (2.0 if k else 1.0))
        found["amplitudes"].append(top)
        found["omega_before"].append(before)
        tilt, spin, time = block.at(instant + WINDOW, dt)
        _, after = block.level(tilt, spin, -1.0)
        found["omega_after"].append(after)
        top, last = block.amplitude(after), landed
    return {name: np.array(values) for name, values in found.items()}
