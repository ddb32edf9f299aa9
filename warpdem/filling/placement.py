"""The bodies of a scene at the start: those given one by one, then those its fills generate."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import SceneError
from warpdem.filling.clearance import Elements, Obstacle, SurfaceObstacle
from warpdem.filling.filling import Filled, filled
from warpdem.filling.repeat import Repeat
from warpdem.filling.scatter import Balls
from warpdem.filling.sizes import largest
from warpdem.geometry.orientation import product, turned
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.errors import Problem
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Body, Scene
    from warpdem.input.scene_fill import Fill


@dataclass(frozen=True, eq=False)
class Placement:
    """All bodies at the start.

    Attributes:
        shape: Number of the shape, in the order of the shapes, shape [body_count].
        scale: Homothety, shape [body_count].
        position: Centres of mass, world [m], shape [body_count, 3].
        orientation: Unit quaternions w, x, y, z of the principal frames, body to world,
            shape [body_count, 4].
        velocity: Of the centres of mass [m/s], shape [body_count, 3].
        spin: Angular velocities, world [rad/s], shape [body_count, 3].
        group: Number of the group in ``groups``, shape [body_count].
        cluster: Shape [body_count].
        density: [kg/m^3]; 0 for a fixed body without; shape [body_count].
        fixed: Moved by no force, shape [body_count].
        names: Of the bodies, body_count of them.
        groups: Names of the groups: those of the scene, then others in order of appearance.
        notes: What fills could not do, as sentences.
    """

    shape: IntArray
    scale: FloatArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    group: IntArray
    cluster: IntArray
    density: FloatArray
    fixed: BoolArray
    names: tuple[str, ...]
    groups: tuple[str, ...]
    notes: tuple[str, ...]

    @cached_property
    def number(self) -> dict[str, int]:
        """Number of each body by its name."""
        return {name: body for body, name in enumerate(self.names)}


def place(scene: Scene, shapes: Mapping[str, Polyhedron]) -> Placement:
    """Bodies of a scene, in its order; the same scene and seeds give the same bodies.

    Args:
        scene: What to place.
        shapes: The polyhedra of its shapes by name, in its order.

    Raises:
        SceneError: Free bodies without mass, or fills that must fit and do not; carries all.
    """
    problems = _massless(scene, shapes)
    groups = _groups(scene)
    given = _given(scene, shapes, groups)
    elements: dict[str, Elements] = {}
    parts, fills, notes = [given], [], []
    repeat = Repeat(scene.cell)
    for index, fill in enumerate(scene.fill):
        seed = scene.run.seed + index if fill.seed is None else fill.seed
        blocked = _Blocked(given, fills, shapes, elements, _reach(fill, shapes), repeat)
        made = filled(fill, shapes, np.random.default_rng(seed), blocked, repeat)
        fills.append(made)
        parts.append(_generated(scene, index, made, groups))
        if len(made.shape) < made.wanted:
            rule = f"{len(made.shape)} of {made.wanted} fit"
            notes.append(f'fill "{fill.name}": {rule}')
            if fill.must_fit:
                rule += "; enlarge region, lower count or size, or set must_fit = false"
                problems.append(problem_at(scene, ("fill", index, "count"), rule, fill.count))
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    return _flowing(scene, _joined(parts, groups, notes))


def _flowing(scene: Scene, placement: Placement) -> Placement:
    """The bodies with the homogeneous flow of a cell that deforms from the start."""
    return replace(placement, velocity=placement.velocity + first_flow(scene, placement))


def first_flow(scene: Scene, placement: Placement) -> FloatArray:
    """Velocity of the homogeneous flow at each free body at the start, shape [body_count, 3]."""
    cell = scene.cell
    if cell is None or cell.start > 0.0:
        return np.zeros_like(placement.position)
    flow = (placement.position - np.array(cell.centre)) @ np.array(cell.strain_rate).T
    return np.where(placement.fixed[:, None], 0.0, flow)


def _massless(scene: Scene, shapes: Mapping[str, Polyhedron]) -> list[Problem]:
    """Free bodies of shapes whose mass is unknown, the first of each shape."""
    uses = [
        *((("body", k, "shape"), b.shape) for k, b in enumerate(scene.body) if not b.fixed),
        *((("fill", k, "shapes"), name) for k, f in enumerate(scene.fill) for name in f.shapes),
    ]
    first = {name: path for path, name in reversed(uses) if not shapes[name].mass_known}
    return [
        problem_at(scene, path, _lacking_mass(shapes[name]), name) for name, path in first.items()
    ]


def _lacking_mass(shape: Polyhedron) -> str:
    if shape.analytic:
        return "an infinite surface cannot move freely; set fixed = true"
    if shape.terrain:
        return "ground cannot move; set fixed = true"
    return (
        "the shape is an open surface, of unknown mass; close it, or declare its volume and "
        "inertia_over_mass, or set fixed = true"
    )


def _groups(scene: Scene) -> tuple[str, ...]:
    named = [group.name for group in scene.group]
    named += [entry.group for entry in (*scene.body, *scene.fill)]
    return tuple(dict.fromkeys(named))


def _density(scene: Scene, entry: Body | Fill) -> float:
    """Of a body or fill, its own or its group's [kg/m^3]; 0 when nobody says."""
    of_group = {group.name: group.density for group in scene.group}
    return entry.density or of_group.get(entry.group) or 0.0


def _given(scene: Scene, shapes: Mapping[str, Polyhedron], groups: tuple[str, ...]) -> Placement:
    """The bodies given one by one; a body's position is that of its shape's own origin."""
    bodies = scene.body
    number = {name: k for k, name in enumerate(shapes)}
    shape = np.array([number[body.shape] for body in bodies], np.int64)
    frames = [shapes[body.shape] for body in bodies]
    scale = np.array([body.scale for body in bodies], float)
    turn = _rows([body.orientation for body in bodies], 4)
    origin = _rows([frame.frame_origin for frame in frames], 3) * scale[:, None]
    return Placement(
        shape=shape,
        scale=scale,
        position=_rows([body.position for body in bodies], 3) + turned(turn, origin),
        orientation=product(turn, _rows([frame.frame_rotation for frame in frames], 4)),
        velocity=_rows([body.velocity for body in bodies], 3),
        spin=_rows([body.spin for body in bodies], 3),
        group=np.array([groups.index(body.group) for body in bodies], np.int64),
        cluster=np.array([body.cluster for body in bodies], np.int64),
        density=np.array([_density(scene, body) for body in bodies], float),
        fixed=np.array([body.fixed for body in bodies], bool),
        names=tuple(body.name or f"body[{k}]" for k, body in enumerate(bodies)),
        groups=groups,
        notes=(),
    )


def _rows(values: list[FloatArray] | list[tuple[float, ...]], width: int) -> FloatArray:
    return np.array(values, float).reshape(-1, width)


def _generated(scene: Scene, index: int, made: Filled, groups: tuple[str, ...]) -> Placement:
    """The bodies of a fill."""
    fill = scene.fill[index]
    count = len(made.shape)
    return Placement(
        shape=made.shape,
        scale=made.scale,
        position=made.position,
        orientation=made.orientation,
        velocity=np.tile(np.array(fill.velocity, float), (count, 1)),
        spin=np.tile(np.array(fill.spin, float), (count, 1)),
        group=np.full(count, groups.index(fill.group)),
        cluster=np.full(count, fill.cluster, np.int64),
        density=np.full(count, _density(scene, fill)),
        fixed=np.zeros(count, bool),
        names=tuple(f"{fill.name}[{k}]" for k in range(count)),
        groups=groups,
        notes=(),
    )


def _joined(parts: list[Placement], groups: tuple[str, ...], notes: list[str]) -> Placement:
    arrays = {
        entry.name: np.concatenate([getattr(part, entry.name) for part in parts])
        for entry in fields(Placement)
        if entry.name not in {"names", "groups", "notes"}
    }
    names = tuple(name for part in parts for name in part.names)
    return Placement(**arrays, names=names, groups=groups, notes=tuple(notes))


def _reach(fill: Fill, shapes: Mapping[str, Polyhedron]) -> float:
    """Largest bounding radius of the bodies a fill can generate [m]."""
    return largest(fill.size) * max(shapes[name].bound for name in fill.shapes)


class _Blocked:
    """The bodies there are before a fill: large ones exactly, small ones as bounding spheres."""

    def __init__(
        self,
        given: Placement,
        fills: list[Filled],
        shapes: Mapping[str, Polyhedron],
        elements: dict[str, Elements],
        reach: float,
        repeat: Repeat,
    ) -> None:
        names = list(shapes)
        bound = np.array([shape.bound for shape in shapes.values()])[given.shape] * given.scale
        infinite = np.array([shape.analytic is not None for shape in shapes.values()], dtype=bool)
        small = (bound <= reach) & ~infinite[given.shape]
        self._reach = reach
        self._balls = Balls()
        self._balls.add(repeat.wrapped(given.position[small]), bound[small])
        for made in fills:
            self._balls.add(made.position, made.radius)
        self._obstacles: list[Obstacle | SurfaceObstacle] = []
        for body in np.flatnonzero(~small):
            name = names[given.shape[body]]
            place = given.position[body], given.orientation[body], float(given.scale[body])
            if surface := shapes[name].analytic:
                self._obstacles.append(SurfaceObstacle(surface, *place))
                continue
            elements.setdefault(name, Elements(shapes[name]))
            self._obstacles.append(Obstacle(shapes[name], elements[name], *place))

    def __call__(self, centres: FloatArray, radii: FloatArray) -> BoolArray:
        """Balls that meet a body, shape [n]."""
        blocked = self._balls.touched(centres, radii, self._reach)
        for obstacle in self._obstacles:
            free = np.flatnonzero(~blocked)
            if not len(free):
                break
            blocked[free] = obstacle.touched(centres[free], radii[free])
        return blocked
