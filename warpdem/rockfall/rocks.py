"""The rocks of a scene as their trajectories see them."""

from __future__ import annotations

from itertools import chain, pairwise
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError, SceneError
from warpdem.geometry.hull import convex_hull
from warpdem.geometry.polyhedron import Polyhedron, build
from warpdem.geometry.shapes import polyhedron_of, read_mesh
from warpdem.geometry.shp import read_shp
from warpdem.input.decode import problem_at
from warpdem.input.scene_rock import BuilderRock, MeshRock, PointsRock, ShapeRock, ShpRock
from warpdem.input.scene_shapes import MeshShape, PolyhedronShape, ShpShape
from warpdem.rockfall.builder import built
from warpdem.rockfall.point_file import read_points
from warpdem.rockfall.rock import Rock

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene import Scene
    from warpdem.input.scene_rock import Rock as RockSection
    from warpdem.input.scene_shapes import Shape

_INSIDE = 1e-6  # of the size: how far below its hull a corner must lie to make a note


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


def rock_of(solid: Polyhedron, name: str, mass: float, notes: tuple[str, ...] = ()) -> Rock:
    """The rock of a convex shape.

    Args:
        solid: With mass properties.
        name: Of the rock.
        mass: [kg].
        notes: What was made of the input.
    """
    points, triangles = _skin(solid)
    return Rock(
        name=name,
        vertices=solid.vertices,
        rounding=solid.radius,
        edges=solid.edges if len(solid.edges) else np.zeros((1, 2), np.int32),
        mass=mass,
        inertia=mass * solid.inertia_over_mass,
        skin_points=points,
        skin_triangles=triangles,
        frame_rotation=solid.frame_rotation,
        notes=notes,
    )


def convex_solid(shape: Shape, directory: Path) -> tuple[Polyhedron, tuple[str, ...]]:
    """A shape of a scene, or its hull where it is not convex, and what was done, as sentences.

    Args:
        shape: No terrain and no analytic surface.
        directory: Folder at which relative file names start.

    Raises:
        GeometryError: It is no solid.
    """
    found = _corners(shape, directory)
    if found is not None:
        points, rounding = found
        try:
            return hulled(points, name=shape.name, rounding=rounding, noted=True)
        except GeometryError:  # A plate, a rod or a ball: its rounding gives it a volume.
            pass
    solid = polyhedron_of(shape, directory)
    if not solid.mass_known or not solid.convex:
        raise GeometryError(f'shape "{shape.name}": is no convex solid, and no hull of it is one')
    return solid, ()


def hulled(
    points: FloatArray, *, name: str, rounding: float, noted: bool = False
) -> tuple[Polyhedron, tuple[str, ...]]:
    """The rounded convex hull of points, with exact mass properties.

    Args:
        points: In the rock's own axes [m], shape [point_count, 3].
        name: Of the rock.
        rounding: Minkowski radius [m].
        noted: The points are corners: if some lie inside the hull, a note says so.

    Raises:
        GeometryError: The points span no solid.
    """
    facets = convex_hull(points)
    used, number = np.unique(facets, return_inverse=True)
    solid = build(points[used], number.reshape(facets.shape), name=name, radius=rounding)
    inside = _inside(points, facets) if noted else 0
    note = f"is not convex: {inside} of its {len(points)} vertices lie inside the hull that it is"
    return solid, (note,) if inside else ()


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
            points = section.scale * _mesh_corners(directory / section.file)
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


def _corners(shape: Shape, directory: Path) -> tuple[FloatArray, float] | None:
    """Corners and rounding of a shape that may be no convex solid; None for others.

    A shape with declared mass properties is taken as it is.
    """
    match shape:
        case PolyhedronShape(volume=None):
            return np.array(shape.vertices, float), shape.rounding
        case MeshShape(volume=None):
            return shape.scale * _mesh_corners(directory / shape.file), shape.rounding
        case ShpShape(volume=None):
            item = read_shp(directory / shape.file).get(shape.item or shape.name)
            return (np.array(item.vertices), item.radius) if item else None
    return None


def _mesh_corners(path: Path) -> FloatArray:
    """Vertices of the facets of a mesh, in the file's unit."""
    points, facets = read_mesh(path)
    return points[np.unique(np.fromiter(chain.from_iterable(facets), np.int64))]


def _inside(points: FloatArray, facets: IntArray) -> int:
    """Number of points clearly inside their hull."""
    a, b, c = (points[facets[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    height = np.full(len(points), -np.inf)
    for base, normal in zip(a, normals, strict=True):
        np.maximum(height, (points - base) @ normal, out=height)
    return int((height < -_INSIDE * np.ptp(points, axis=0).max()).sum())


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
