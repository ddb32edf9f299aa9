"""The rocks of a scene as their trajectories see them."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError, SceneError
from warpdem.input.decode import problem_at
from warpdem.input.scene_rock import BuilderRock, MeshRock, PointsRock, ShapeRock, ShpRock
from warpdem.input.scene_shapes import ShpShape
from warpdem.rockfall.builder import built
from warpdem.rockfall.point_file import read_points
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.solids import convex_solid, hulled, mesh_corners

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.input.scene_rock import Rock as RockSection
    from warpdem.input.scene_shapes import Shape


def rocks_of(scene: Scene) -> tuple[Rock, ...]:
    """Each [[rock]] of a scene, in their order.

    Raises:
        SceneError: Some cannot be made; carries all problems.
    """
    shapes = {shape.name: shape for shape in scene.shape}
    rocks, problems = [], []
    for index, section in enumerate(scene.rock):
        try:
            solid, notes = _solid(section, shapes, scene.directory)
            rocks.append(rock_of(solid, section.name, _mass(section, solid), notes))
        except GeometryError as error:
            file = getattr(section, "file", None)
            path = ("rock", index, "file") if file else ("rock", index)
            message = str(error).removeprefix(f'shape "{section.name}": ')
            problems.append(problem_at(scene, path, message, file))
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    return tuple(rocks)


def rock_of(
    solid: Polyhedron, name: str, mass: float, notes: tuple[str, ...] = (), scale: float = 1.0
) -> Rock:
    """The rock of a convex shape.

    Args:
        solid: With mass properties.
        name: Of the rock.
        mass: [kg].
        notes: What was made of the input.
        scale: Homothety: the rock is so many times the shape's size.
    """
    points, triangles = _skin(solid)
    return Rock(
        name=name,
        vertices=solid.vertices * scale,
        rounding=solid.radius * scale,
        edges=solid.edges if len(solid.edges) else np.zeros((1, 2), np.int32),
        mass=mass,
        inertia=mass * solid.inertia_over_mass * scale**2,
        skin_points=points * scale,
        skin_triangles=triangles,
        frame_rotation=solid.frame_rotation,
        notes=notes,
    )


def _solid(
    section: RockSection, shapes: dict[str, Shape], directory: Path
) -> tuple[Polyhedron, tuple[str, ...]]:
    name = section.name
    match section:
        case BuilderRock():
            volume = _volume(section)
            solid = built(
                section.form,
                volume,
                name=name,
                vertices=section.vertices,
                rounding=section.rounding,
                seed=section.seed,
            )
            return solid, ()
        case PointsRock():
            own = section.points is not None
            points = np.array(section.points) if own else read_points(directory / str(section.file))
            return hulled(section.scale * points, name=name, rounding=section.rounding)
        case MeshRock():
            points = section.scale * mesh_corners(directory / section.file)
            return hulled(points, name=name, rounding=section.rounding, noted=True)
        case ShpRock():
            shape = ShpShape(kind="shp", name=name, file=section.file, item=section.item)
            return convex_solid(shape, directory)
        case ShapeRock():
            return convex_solid(shapes[section.shape], directory)


def _volume(section: BuilderRock) -> float:
    """Volume as two of volume, mass and density say."""
    if section.volume is not None:
        return section.volume
    return (section.mass or 0.0) / (section.density or 1.0)


def _mass(section: RockSection, solid: Polyhedron) -> float:
    if section.mass is not None:
        return section.mass
    volume = _volume(section) if isinstance(section, BuilderRock) else solid.volume
    return (section.density or 0.0) * volume


def _skin(solid: Polyhedron) -> tuple[FloatArray, IntArray]:
    """Outer surface in triangles: points, shape [n, 3], and corners, shape [m, 3]."""
    if solid.radius == 0.0:
        return solid.vertices, solid.triangles[0].astype(np.int32)
    drawn = solid.surface
    triangles = [
        (polygon[0], *pair)
        for first, last in pairwise(drawn.offsets)
        for polygon in [drawn.connectivity[first:last].tolist()]
        for pair in pairwise(polygon[1:])
    ]
    return drawn.points, np.array(triangles, np.int32)
