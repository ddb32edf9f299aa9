"""Walls that follow a force: their inertia, what is imposed on them, and the areas they press."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from warpdem.driving.areas import AXIS, Area, areas_of
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


@dataclass(frozen=True)
class Push:
    """What one driver imposes on one body, from its start to its stop.

    Attributes:
        index: Of the driver in the scene.
        body, place: Number of the body, and among the driven ones.
        kind: "force", "moment" or "pressure".
        vector: N, N m or Pa along the world's axes, shape [3].
        loose: 1 along the axes that follow it, else 0, shape [3].
        steady: What no ramp multiplies (weight) [N], shape [3].
        start, stop: [s].
        ramp: Times and factors, or None.
        inertia: Mass [kg] or moments about the world's axes [kg m^2], 0 if unknown, shape [3].
        damping: Of the motion along the loose axes [N s/m] or [N m s].
    """

    index: int
    body: int
    place: int
    kind: str
    vector: FloatArray
    loose: FloatArray
    steady: FloatArray
    start: float
    stop: float
    ramp: FloatArray | None
    inertia: FloatArray
    damping: float

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

    ``place`` has the bodies that drivers name, among the ``count`` driven ones.
    """
    pushes = list(_all_pushes(scene, placement, polyhedra, place))
    areas, problems = areas_of(scene, placement, polyhedra, place)
    inverses = {"force": np.zeros((count, 3)), "moment": np.zeros((count, 3))}
    dampings = {"force": np.zeros((count, 3)), "moment": np.zeros((count, 3))}
    for push in pushes:
        kind = "moment" if push.kind == "moment" else "force"
        loose = push.loose > 0.0
        if fault := _wrong_inertia(push, inverses[kind][push.place, loose]):
            name = placement.names[push.body]
            problems.append(problem_at(scene, ("driver", push.index), f'"{name}" {fault}'))
            continue
        inverses[kind][push.place, loose] = 1.0 / push.inertia[loose]
        dampings[kind][push.place, loose] = push.damping
    walls = Walls(
        inverses["force"],
        inverses["moment"],
        dampings["force"],
        dampings["moment"],
        tuple(pushes),
        areas,
    )
    return walls, problems


def _wrong_inertia(push: Push, before: FloatArray) -> str:
    """What is wrong with what a force accelerates; ``before``: inverses of earlier drivers."""
    inertia = push.inertia[push.loose > 0.0]
    key = "inertia" if push.kind == "moment" else "mass"
    if not np.all((inertia > 0.0) & np.isfinite(inertia)):
        return (
            f"has nothing to accelerate: give the driver {key}, or the body a density and a shape "
            f"that is closed"
        )
    if np.any((before > 0.0) & (before != 1.0 / inertia)):
        return f"has another {key} in an earlier driver: give both the same"
    return ""


def _all_pushes(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    place: Mapping[str, int],
) -> Iterator[Push]:
    """What the drivers impose on their bodies, in the order of the scene."""
    for index, driver in enumerate(scene.driver):
        if not isinstance(driver, ControlDriver | PressureDriver):
            continue
        for name in driver.bodies:
            mass, moments = _inertia(placement, polyhedra, placement.number[name], driver.mass)
            common: dict[str, Any] = {
                "index": index,
                "body": placement.number[name],
                "place": place[name],
                "start": driver.start,
                "stop": inf if driver.stop is None else driver.stop,
                "ramp": None if driver.ramp is None else np.array(driver.ramp, float),
            }
            if isinstance(driver, PressureDriver):
                yield _pressed(driver, mass, common)
            else:
                yield from _controlled(
                    driver, mass, moments, np.array(scene.gravity.vector), common
                )


def _pressed(driver: PressureDriver, mass: float, common: dict[str, Any]) -> Push:
    """The force of a pressure."""
    vector, loose = np.zeros(3), np.zeros(3)
    axis = AXIS[driver.axis]
    loose[axis] = 1.0
    vector[axis] = driver.sign * driver.pressure * (driver.area or 1.0)
    return Push(
        kind="force" if driver.area else "pressure",
        vector=vector,
        loose=loose,
        steady=np.zeros(3),
        inertia=np.full(3, mass),
        damping=driver.damping,
        **common,
    )


def _controlled(
    driver: ControlDriver,
    mass: float,
    moments: FloatArray,
    gravity: FloatArray,
    common: dict[str, Any],
) -> Iterator[Push]:
    """Force and moment of a driver."""
    for axis, value in driver.inertia.given.items():
        moments[axis] = value
    inertia = {"force": np.full(3, mass), "moment": moments}
    damping = {"force": driver.damping, "moment": driver.spin_damping}
    for kind, given in (("force", driver.force.given), ("moment", driver.moment.given)):
        if given:
            vector, loose = np.zeros(3), np.zeros(3)
            for axis, value in given.items():
                vector[axis], loose[axis] = value, 1.0
            weighs = kind == "force" and driver.gravity
            yield Push(
                kind=kind,
                vector=vector,
                loose=loose,
                steady=loose * mass * gravity if weighs else np.zeros(3),
                inertia=inertia[kind],
                damping=damping[kind],
                **common,
            )


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
