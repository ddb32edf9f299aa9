"""Walls that follow a force: their inertia, what is imposed on them, and the areas they press."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.input.decode import problem_at
from warpdem.input.scene_driver import ControlDriver, PressureDriver

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray
    from warpdem.errors import Problem
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene

AXIS = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True)
class Area:
    """Clear rectangle between two pairs of walls, and whose pressure acts on it.

    Attributes:
        place: Of the pressed wall among the driven bodies.
        along: Axis of the pressure.
        low, high: Bodies on the lower and the upper side of each pair.
        axis: Along which each pair is apart.
        less: Distance of their centres less their clear width [m].
    """

    place: int
    along: int
    low: tuple[int, int]
    high: tuple[int, int]
    axis: tuple[int, int]
    less: tuple[float, float]


@dataclass(frozen=True)
class Push:
    """What one driver imposes on one body, from its start to its stop.

    Attributes:
        index: Of the driver in the scene.
        place: Of the body among the driven ones.
        kind: "force", "moment" or "pressure".
        vector: N, N m or Pa along the world's axes, shape [3].
        loose: 1 along the axes that follow it, else 0, shape [3].
        steady: What no ramp multiplies (weight) [N], shape [3].
        start, stop: [s].
        ramp: Times and factors, or None.
    """

    index: int
    place: int
    kind: str
    vector: FloatArray
    loose: FloatArray
    steady: FloatArray
    start: float
    stop: float
    ramp: FloatArray | None

    def at(self, time: FloatArray) -> FloatArray:
        """The imposed vector, shape [count, 3]."""
        factor = np.ones_like(time)
        if self.ramp is not None:
            factor = np.interp(time, self.ramp[:, 0], self.ramp[:, 1])
        return factor[:, None] * self.vector + self.steady

    def active(self, time: FloatArray) -> FloatArray:
        """Axes that are loose at each time, shape [count, 3]."""
        return ((time >= self.start) & (time < self.stop))[:, None] * self.loose


class Loads(NamedTuple):
    """What is imposed at each of some times; shapes [count, driven_count, 3].

    Attributes:
        force, moment, pressure: At the times themselves [N], [N m], [Pa].
        loose, loose_spin: 1 along and about the axes that follow them.
    """

    force: FloatArray
    moment: FloatArray
    pressure: FloatArray
    loose: FloatArray
    loose_spin: FloatArray


@dataclass(frozen=True)
class Walls:
    """All that the drivers' forces move.

    Attributes:
        inverse_mass, inverse_inertia: Along and about the world's axes [1/kg], [1/(kg m^2)], 0
            where no force ever moves a body, shapes [driven_count, 3].
        damping, spin_damping: [N s/m], [N m s], shapes [driven_count, 3].
        pushes: One for each driver, body and kind.
        areas: Those that change.
    """

    inverse_mass: FloatArray
    inverse_inertia: FloatArray
    damping: FloatArray
    spin_damping: FloatArray
    pushes: tuple[Push, ...]
    areas: tuple[Area, ...]

    def loads(self, ends: FloatArray, dt: float) -> Loads:
        """Forces at the ends of steps [s], and what is loose during them.

        A step belongs to the drivers of its middle. The force at its end acts in the next one too
        and is that of the next one's drivers: of the last step of a driver half is left out.
        """
        shape = (len(ends), len(self.inverse_mass), 3)
        loads = Loads(*(np.zeros(shape) for _ in Loads._fields))
        for push in self.pushes:
            acts = push.active(ends + 0.5 * dt).any(axis=1, keepdims=True)
            getattr(loads, push.kind)[:, push.place] += acts * push.at(ends)
            loose = loads.loose_spin if push.kind == "moment" else loads.loose
            active = push.active(ends - 0.5 * dt)
            loose[:, push.place] = np.maximum(loose[:, push.place], active)
        return loads


def walls_of(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    place: Mapping[str, int],
    count: int,
) -> tuple[Walls, list[Problem]]:
    """The walls of a placed scene that follow forces, and what is wrong with them.

    Args:
        scene, placement, polyhedra: The scene, its bodies, its shapes.
        place: Of the bodies that drivers name, among the driven ones.
        count: Number of driven bodies.
    """
    inverse_mass, inverse_inertia, damping, spin_damping = np.zeros((4, count, 3))
    pushes: list[Push] = []
    areas: dict[tuple[int, int], Area] = {}
    problems: list[Problem] = []
    number = {name: k for k, name in enumerate(placement.names)}
    for index, driver in enumerate(scene.driver):
        if not isinstance(driver, ControlDriver | PressureDriver):
            continue
        for name in driver.bodies:
            body, at = number[name], place[name]
            mass, moments = _inertia(placement, polyhedra, body, driver.mass)
            for push in _pushes(scene, index, at, mass):
                loose = push.loose > 0.0
                if push.kind == "moment":
                    assert isinstance(driver, ControlDriver)
                    for axis, value in driver.inertia.given.items():
                        moments[axis] = value
                    inverse_inertia[at, loose] = 1.0 / moments[loose]
                    spin_damping[at, loose] = driver.spin_damping
                    lacks = not np.all((moments[loose] > 0.0) & np.isfinite(moments[loose]))
                else:
                    lacks = not mass > 0.0
                    before = inverse_mass[at, loose]
                    if not lacks and np.any((before > 0.0) & (before != 1.0 / mass)):
                        rule = f'"{name}" has another mass in an earlier driver: give it one'
                        problems.append(problem_at(scene, ("driver", index, "mass"), rule))
                    inverse_mass[at, loose] = 0.0 if lacks else 1.0 / mass
                    damping[at, loose] = driver.damping
                if lacks:
                    rule = f'"{name}" has no mass to accelerate: give the driver '
                    rule += "inertia" if push.kind == "moment" else "mass"
                    rule += ", or the body a density and a shape that is closed"
                    problems.append(problem_at(scene, ("driver", index), rule))
                pushes.append(push)
            if isinstance(driver, PressureDriver) and driver.between:
                area, fault = _area(placement, polyhedra, driver, at)
                if fault or area is None:
                    problems.append(problem_at(scene, ("driver", index, "between"), fault))
                elif areas.setdefault((at, area.along), area) != area:
                    rule = f'"{name}" is pressed along {driver.axis} on another area already'
                    problems.append(problem_at(scene, ("driver", index, "between"), rule))
    walls = Walls(
        inverse_mass,
        inverse_inertia,
        damping,
        spin_damping,
        tuple(pushes),
        tuple(areas.values()),
    )
    return walls, problems


def _pushes(
    scene: Scene, index: int, place: int, mass: float
) -> Iterator[Push]:
    """What one driver imposes on one body."""
    driver = scene.driver[index]
    assert isinstance(driver, ControlDriver | PressureDriver)
    stop = inf if driver.stop is None else driver.stop
    ramp = None if driver.ramp is None else np.array(driver.ramp, float)
    if isinstance(driver, PressureDriver):
        vector, loose = np.zeros(3), np.zeros(3)
        axis = AXIS[driver.axis]
        loose[axis] = 1.0
        vector[axis] = driver.sign * driver.pressure * (driver.area or 1.0)
        kind = "force" if driver.area else "pressure"
        yield Push(index, place, kind, vector, loose, np.zeros(3), driver.start, stop, ramp)
        return
    for kind, given in (("force", driver.force.given), ("moment", driver.moment.given)):
        if given:
            vector, loose = np.zeros(3), np.zeros(3)
            for axis, value in given.items():
                vector[axis], loose[axis] = value, 1.0
            weight = np.zeros(3)
            if kind == "force" and driver.gravity:
                weight = loose * mass * np.array(scene.gravity.vector)
            yield Push(index, place, kind, vector, loose, weight, driver.start, stop, ramp)


def _inertia(
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    body: int,
    declared: float | None,
) -> tuple[float, FloatArray]:
    """Mass [kg] and moments about the world's axes through the centre [kg m^2]; 0: unknown."""
    shape = list(polyhedra.values())[placement.shape[body]]
    if not shape.mass_known:
        return declared or 0.0, np.zeros(3)
    scale = float(placement.scale[body])
    mass = declared or float(shape.volume * scale**3 * placement.density[body])
    axes = matrix(placement.orientation[body])
    return mass, mass * scale**2 * (axes**2 @ shape.inertia_over_mass)


def _area(
    placement: Placement, polyhedra: Mapping[str, Polyhedron], driver: PressureDriver, place: int
) -> tuple[Area | None, str]:
    """The area between the walls that a driver names, or what is wrong with them."""
    assert driver.between
    number = {name: k for k, name in enumerate(placement.names)}
    along = AXIS[driver.axis]
    found = []
    for pair in driver.between:
        first, second = (number[name] for name in pair)
        apart = placement.position[second] - placement.position[first]
        axis = int(np.argmax(np.where(np.arange(3) == along, -1.0, np.abs(apart))))
        low, high = (first, second) if apart[axis] > 0.0 else (second, first)
        inner = _extent(placement, polyhedra, high, axis)[0]
        inner -= _extent(placement, polyhedra, low, axis)[1]
        if not inner > 0.0:
            named = f'"{pair[0]}" and "{pair[1]}"'
            return None, f"{named} leave no clear width along {'xyz'[axis]} at the start"
        found.append((low, high, axis, float(abs(apart[axis]) - inner)))
    (low, high, axis, less), (low2, high2, axis2, less2) = found
    if axis == axis2:
        return None, f"both pairs are apart along {'xyz'[axis]}: they span no area"
    return Area(place, along, (low, low2), (high, high2), (axis, axis2), (less, less2)), ""


def _extent(
    placement: Placement, polyhedra: Mapping[str, Polyhedron], body: int, axis: int
) -> tuple[float, float]:
    """Least and largest coordinate of a body along an axis, rounding included [m]."""
    shape = list(polyhedra.values())[placement.shape[body]]
    scale = float(placement.scale[body])
    across = shape.vertices @ matrix(placement.orientation[body])[axis] * scale
    across = across + placement.position[body, axis]
    return float(across.min() - shape.radius * scale), float(across.max() + shape.radius * scale)
