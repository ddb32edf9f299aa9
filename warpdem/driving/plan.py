"""Which bodies are driven, by what, and where that takes them."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from warpdem.driving.curve import curve_of, exponential, motion, moving
from warpdem.driving.expression import ExpressionError
from warpdem.driving.rates import flaws
from warpdem.driving.walls import Walls, walls_of
from warpdem.errors import GeometryError, SceneError
from warpdem.geometry.orientation import product, turned
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.driving.curve import Curve
    from warpdem.errors import Problem
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene


@dataclass(frozen=True)
class Imposed:
    """One driver's imposed motion.

    Attributes:
        index: Of the driver in the scene.
        curve: Displacement and rotation vector in time.
        start, stop: When it moves [s].
        point: Of its axis [m], or None: each body's own centre.
        places: Of its bodies among the driven ones.
    """

    index: int
    curve: Curve
    start: float
    stop: float | None
    point: FloatArray | None
    places: IntArray


@dataclass(frozen=True)
class Path:
    """Where the driven bodies are at each of some times; shapes [count, driven_count, 3 or 4]."""

    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray


@dataclass(frozen=True)
class Plan:
    """Driven bodies and what moves them.

    Attributes:
        bodies: Numbers of the driven bodies, shape [driven_count].
        position, orientation: At time zero; quaternions w, x, y, z.
        velocity, spin: Their own, of [[body]], kept throughout, about their centres.
        imposed: The drivers, in the order of the scene.
        walls: Those that follow a force.
    """

    bodies: IntArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    imposed: tuple[Imposed, ...]
    walls: Walls

    def path(self, time: FloatArray) -> Path:
        """The imposed motion at times [s], shape [count].

        Rotations follow one another in the order of the drivers, each about its own point; the
        displacements of all are added last.
        """
        shape = (len(time), len(self.bodies))
        own_turn = exponential((time[:, None, None] * self.spin).reshape(-1, 3))
        orientation = product(own_turn.reshape(*shape, 4), self.orientation)
        spin = np.broadcast_to(self.spin, (*shape, 3)).copy()
        centre = np.broadcast_to(self.position, (*shape, 3)).copy()
        swing = np.zeros((*shape, 3))
        shift = time[:, None, None] * self.velocity
        rate = np.broadcast_to(self.velocity, (*shape, 3)).copy()
        for driver in self.imposed:
            at = driver.places
            moved = motion(driver.curve, driver.start, driver.stop, time)
            turn, turning = moved.turn[:, None], moved.spin[:, None]
            if driver.point is not None:
                arm = turned(turn, centre[:, at] - driver.point)
                centre[:, at] = driver.point + arm
                swing[:, at] = np.cross(turning, arm) + turned(turn, swing[:, at])
            orientation[:, at] = product(turn, orientation[:, at])
            spin[:, at] = turning + turned(turn, spin[:, at])
            shift[:, at] += moved.displacement[:, None]
            rate[:, at] += moved.rate[:, None]
        return Path(centre + shift, orientation, swing + rate, spin)


def plan_of(scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> Plan:
    """The driven bodies of a placed scene.

    Raises:
        SceneError: A table cannot be read, an expression is not finite within the run, or a wall
            has no mass or no area; carries all.
    """
    own = placement.fixed & (placement.velocity.any(axis=1) | placement.spin.any(axis=1))
    bodies = np.union1d(np.flatnonzero(own), listed_bodies(scene, placement))
    place = {name: int(np.searchsorted(bodies, placement.number[name])) for name in _names(scene)}
    problems: list[Problem] = []
    imposed: list[Imposed] = []
    for index, driver in enumerate(scene.driver):
        try:
            curve = curve_of(driver, scene.directory)
        except (GeometryError, ExpressionError) as error:
            problems.append(problem_at(scene, ("driver", index), str(error)))
            continue
        if curve is None:
            continue
        point = getattr(driver, "point", None)
        places = np.array([place[name] for name in driver.bodies], np.int64)
        imposed.append(
            Imposed(
                index,
                curve,
                driver.start,
                driver.stop,
                None if point is None else np.array(point),
                places,
            )
        )
        problems += [
            problem_at(scene, ("driver", index, axis), rule, getattr(driver, axis))
            for axis, rule in flaws(imposed[-1], scene.run.duration)
        ]
    walls, faults = walls_of(scene, placement, polyhedra, place, len(bodies))
    faults += conflicts(scene, imposed, walls)
    faults += own_motion(scene, placement, walls, bodies)
    if problems or faults:
        raise SceneError(str(scene.source or "scene"), [*problems, *faults])
    return Plan(
        bodies=bodies,
        position=placement.position[bodies],
        orientation=placement.orientation[bodies],
        velocity=placement.velocity[bodies],
        spin=placement.spin[bodies],
        imposed=tuple(imposed),
        walls=walls,
    )


def listed_bodies(scene: Scene, placement: Placement) -> IntArray:
    """Numbers of the bodies that a [[driver]] moves, rising."""
    if not scene.driver:
        return np.zeros(0, np.int64)
    return np.array(sorted(placement.number[name] for name in _names(scene)), np.int64)


def _names(scene: Scene) -> dict[str, None]:
    """Names of the bodies that drivers move, each once."""
    return dict.fromkeys(name for driver in scene.driver for name in driver.bodies)


def conflicts(scene: Scene, imposed: list[Imposed], walls: Walls) -> list[Problem]:
    """Axes that are both imposed and left to a force at the same time."""
    problems = []
    for driver in imposed:
        along = moving(driver.curve, driver.start)
        stop = inf if driver.stop is None else driver.stop
        for push in walls.pushes:
            if push.place not in driver.places or push.start >= stop or push.stop <= driver.start:
                continue
            turns = push.kind == "moment"
            if turns and along[3:].any():
                what = "rotation, which follows a moment"
            elif not turns and np.any(along[:3] & (push.loose > 0.0)):
                axis = int(np.flatnonzero(along[:3] & (push.loose > 0.0))[0])
                what = f"motion along {'xyz'[axis]}, which follows a force"
            else:
                continue
            rule = f"imposes a {what} of driver[{push.index}] at the same time: give one of them"
            rule += " start or stop, or other axes"
            problems.append(problem_at(scene, ("driver", driver.index), rule))
    return problems


def own_motion(scene: Scene, placement: Placement, walls: Walls, bodies: IntArray) -> list[Problem]:
    """Velocities and spins of bodies' own along axes that a force or moment is to move."""
    problems = []
    for push in walls.pushes:
        body = bodies[push.place]
        own = placement.spin[body] if push.kind == "moment" else placement.velocity[body]
        bad = np.flatnonzero((push.loose > 0.0) & (own != 0.0))
        if len(bad):
            key = "spin" if push.kind == "moment" else "velocity"
            rule = (
                f'moves "{placement.names[body]}" by a {push.kind} along {"xyz"[bad[0]]}, where it '
                f"has a {key} of its own that it would keep for ever: set that to zero"
            )
            problems.append(problem_at(scene, ("driver", push.index), rule))
    return problems
