"""Displacement and rotation vector of each kind of driver, and their exact rates."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpdem.driving.expression import Expression, parse
from warpdem.driving.table import AXES, MotionTable, read_table
from warpdem.geometry.orientation import product
from warpdem.input.scene_driver import (
    ConstantDriver,
    ControlDriver,
    ExpressionDriver,
    SineDriver,
    TableDriver,
)

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.input.scene_driver import Driver

SMALL_TURN = 1e-4
"""Angle below which the rate of a rotation vector is expanded in it [rad]."""


class Motion(NamedTuple):
    """What a driver does to a body at each of some times.

    Attributes:
        displacement, rate: [m], [m/s], shape [count, 3].
        turn, spin: Rotation since the start and its angular velocity, world: quaternions
            w, x, y, z, shape [count, 4], and [rad/s], shape [count, 3].
    """

    displacement: FloatArray
    rate: FloatArray
    turn: FloatArray
    spin: FloatArray


@dataclass(frozen=True)
class Uniform:
    """Constant velocity and spin [m/s, rad/s], shape [6], from t = ``start`` on."""

    rates: FloatArray
    start: float

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacements with rotation vectors, and rates; shapes [count, 6]."""
        return (time - self.start)[:, None] * self.rates, np.tile(self.rates, (len(time), 1))


@dataclass(frozen=True)
class Wave:
    """A wave of amplitudes [m, rad], shape [6]."""

    amplitudes: FloatArray
    driver: SineDriver

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """As `Uniform.at`."""
        driver = self.driver
        angular = 2.0 * pi * driver.frequency
        angle = angular * (time - driver.start) + driver.phase
        if driver.wave == "sine":
            value, rate = np.sin(angle), angular * np.cos(angle)
        else:
            value = 2.0 / pi * np.arcsin(np.sin(angle))
            rising = (angle / (2.0 * pi) + 0.25) % 1.0 < 0.5
            rate = np.where(rising, 4.0, -4.0) * driver.frequency
        return value[:, None] * self.amplitudes, rate[:, None] * self.amplitudes


@dataclass(frozen=True)
class Formulas:
    """Six functions of time."""

    expressions: tuple[Expression, ...]

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """As `Uniform.at`."""
        parts = [expression.at(time) for expression in self.expressions]
        values = np.stack([part.value for part in parts], axis=1)
        return values, np.stack([part.rate for part in parts], axis=1)


Curve = Uniform | Wave | Formulas | MotionTable


def curve_of(driver: Driver, directory: Path) -> Curve | None:
    """What a driver imposes as functions of time; None for one that imposes none.

    Raises:
        ExpressionError: An expression is none.
        GeometryError: A table cannot be read.
    """
    if isinstance(driver, ConstantDriver):
        return Uniform(np.array([*driver.velocity, *driver.spin]), driver.start)
    if isinstance(driver, ControlDriver):
        rates = np.zeros(6)
        for axis, value in driver.velocity.given.items():
            rates[axis] = value
        return Uniform(rates, driver.start) if rates.any() else None
    if isinstance(driver, SineDriver):
        return Wave(np.array([*driver.translation, *driver.rotation]), driver)
    if isinstance(driver, ExpressionDriver):
        return Formulas(tuple(parse(getattr(driver, axis)) for axis in AXES))
    if isinstance(driver, TableDriver):
        return read_table(directory / driver.file, cubic=driver.interpolation == "cubic")
    return None


def motion(curve: Curve, start: float, stop: float | None, time: FloatArray) -> Motion:
    """The motion since ``start`` [s], held from ``stop`` on, at times [s] of shape [count]."""
    end = inf if stop is None else stop
    within = np.append(np.clip(time, start, end), start)
    value, rate = curve.at(within)
    moves = ((time >= start) & (time < end))[:, None]
    rate = np.where(moves, rate[:-1], 0.0)
    turn = exponential(value[:, 3:])
    if turn[-1, 0] != 1.0:
        turn = product(turn, turn[-1] * np.array([1.0, -1.0, -1.0, -1.0]))
    return Motion(
        value[:-1, :3] - value[-1, :3],
        rate[:, :3],
        turn[:-1],
        spin_of(value[:-1, 3:], rate[:, 3:]),
    )


def moving(curve: Curve, start: float) -> BoolArray:
    """Which of x, y, z, rx, ry, rz ever change, shape [6]; expressions by samples."""
    if isinstance(curve, Uniform):
        return curve.rates != 0.0
    if isinstance(curve, Wave):
        return curve.amplitudes != 0.0
    if isinstance(curve, MotionTable):
        return np.ptp(curve.value, axis=0) > 0.0
    return np.any(curve.at(start + np.geomspace(1e-6, 1e6, 97))[1] != 0.0, axis=0)


def exponential(vector: FloatArray) -> FloatArray:
    """Unit quaternions w, x, y, z of rotation vectors [rad]; shape [count, 4]."""
    half = 0.5 * np.linalg.norm(vector, axis=1, keepdims=True)
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / pi) * vector], axis=1)


def spin_of(vector: FloatArray, rate: FloatArray) -> FloatArray:
    """World angular velocity of exp(vector) where the vector changes at ``rate`` [rad/s].

    w = r' + (1 - cos a)/a^2 r x r' + (a - sin a)/a^3 r x (r x r'), a = |r|; the derivative of the
    exponential map, Iserles et al. (2000), doi:10.1017/S0962492900002154.
    """
    angle = np.linalg.norm(vector, axis=1, keepdims=True)
    small = angle < SMALL_TURN
    a = np.where(small, 1.0, angle)
    first = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(a)) / a**2)
    second = np.where(small, 1.0 / 6.0 - angle**2 / 120.0, (a - np.sin(a)) / a**3)
    across = np.cross(vector, rate)
    return rate + first * across + second * np.cross(vector, across)
