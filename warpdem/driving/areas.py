"""Areas that pressures act on: clear rectangles between two pairs of walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix
from warpdem.input.decode import problem_at
from warpdem.input.scene_driver import PressureDriver

if TYPE_CHECKING:
    from collections.abc import Mapping

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


def areas_of(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    place: Mapping[str, int],
) -> tuple[tuple[Area, ...], list[Problem]]:
    """The areas that change while a scene runs, and what is wrong with them."""
    areas: dict[tuple[int, int], Area] = {}
    problems: list[Problem] = []
    for index, driver in enumerate(scene.driver):
        if not (isinstance(driver, PressureDriver) and driver.between):
            continue
        for name in driver.bodies:
            area, fault = _area(placement, polyhedra, driver, place[name])
            if area and areas.setdefault((area.place, area.along), area) != area:
                fault = f'"{name}" is pressed along {driver.axis} on another area already'
            if fault:
                problems.append(problem_at(scene, ("driver", index, "between"), fault))
    return tuple(areas.values()), problems


def _area(
    placement: Placement, polyhedra: Mapping[str, Polyhedron], driver: PressureDriver, place: int
) -> tuple[Area | None, str]:
    """The area between the walls that a driver names, or what is wrong with them."""
    assert driver.between
    along = AXIS[driver.axis]
    found = []
    for pair in driver.between:
        first, second = (placement.number[name] for name in pair)
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
