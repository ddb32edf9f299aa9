"""Shapes of a scene as polyhedra."""

from __future__ import annotations

from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from io import StringIO
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.analytic import Analytic
from warpdem.geometry.inertia import rounded_box
from warpdem.geometry.polyhedron import Polyhedron, build
from warpdem.geometry.shp import ShpItem, read_shp
from warpdem.geometry.terrain import read_raster, terrain
from warpdem.input.scene_shapes import (
    BallShape,
    BoxShape,
    CapsuleShape,
    CylinderShape,
    MeshShape,
    PlaneShape,
    PolyhedronShape,
    ShpShape,
    SphereShape,
    TerrainShape,
)

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene_shapes import Shape

Declared = tuple[float, tuple[float, ...]]

_CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ],
    float,
)
_BOX_EDGES = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 0],
    [4, 5],
    [5, 6],
    [6, 7],
    [7, 4],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
]
_BOX_FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]


def polyhedron_of(shape: Shape, directory: Path) -> Polyhedron:
    """The polyhedron of a shape of a scene.

    Args:
        shape: Of any kind.
        directory: Folder at which relative file names start.

    Raises:
        GeometryError: The shape cannot be simulated, or its file cannot be read.
    """
    match shape:
        case BoxShape() | SphereShape() | CapsuleShape():
            return _rounded(shape)
        case PlaneShape() | CylinderShape() | BallShape():
            return analytic(shape.name, _surface(shape))
        case PolyhedronShape():
            return _polyhedron(shape)
        case MeshShape():
            return _mesh(shape, directory)
        case ShpShape():
            return _shp(shape, directory)
        case TerrainShape():
            return terrain(
                read_raster(directory / shape.file), name=shape.name, radius=shape.rounding
            )


def _rounded(shape: BoxShape | SphereShape | CapsuleShape) -> Polyhedron:
    match shape:
        case BoxShape():
            return box(shape.name, shape.size, shape.rounding, declared=_declared(shape))
        case SphereShape():
            return box(shape.name, (2.0 * shape.radius,) * 3, shape.radius)
        case CapsuleShape():
            return capsule(shape.name, shape.length, shape.radius)


def _surface(shape: PlaneShape | CylinderShape | BallShape) -> Analytic:
    match shape:
        case PlaneShape():
            return Analytic("plane", 0.0, shape.extent)
        case CylinderShape():
            return Analytic("cylinder", shape.radius, shape.length)
        case BallShape():
            return Analytic("ball", shape.radius, None)


def _declared(shape: BoxShape | PolyhedronShape | MeshShape | ShpShape) -> Declared | None:
    if shape.volume is None or shape.inertia_over_mass is None:
        return None
    return shape.volume, shape.inertia_over_mass


def box(
    name: str,
    size: FloatArray | tuple[float, ...],
    radius: float,
    *,
    declared: Declared | None = None,
) -> Polyhedron:
    """A rounded box about its origin; a plate, capsule or sphere where the rounding fills it.

    Args:
        name: Of the shape.
        size: Outer edge lengths [m], shape [3].
        radius: Minkowski radius, at most half of each length [m].
        declared: Volume [m^3] and moments over mass [m^2] to take instead of the exact ones.
    """
    extent = np.array(size, float) - 2.0 * radius
    extent[extent <= 1e-12 * np.array(size)] = 0.0  # 2 (a/2) is a, but 2 (0.1 * 3 / 2) is not 0.3
    return _around(name, extent, radius, declared)


def _around(
    name: str, extent: FloatArray, radius: float, declared: Declared | None = None
) -> Polyhedron:
    """A box about the origin, rounded; ``extent`` of its core, which may be a segment [m]."""
    if declared is None:
        mass = rounded_box(extent, radius)
        declared = (mass.volume, tuple(np.diag(mass.inertia_over_mass)))
    vertices, edges, faces = _box_core(extent)
    return build(
        vertices,
        faces,
        name=name,
        radius=radius,
        edges=edges,
        declared=declared,
        keep_features=True,
    )


def capsule(name: str, length: float, radius: float) -> Polyhedron:
    """A segment along z about the origin, rounded; mass properties in closed form.

    Args:
        name: Of the shape.
        length: Of the segment [m].
        radius: Of the rounding [m].
    """
    return _around(name, np.array([0.0, 0.0, length]), radius)


def analytic(name: str, surface: Analytic) -> Polyhedron:
    """A stand-in for an analytic surface: one vertex at its origin, no rounding, no mass."""
    point = box(name, (2.0, 2.0, 2.0), 1.0)
    return replace(
        point,
        radius=0.0,
        volume=0.0,
        inertia_over_mass=np.zeros(3),
        mass_known=False,
        analytic=surface,
    )


def _box_core(extent: FloatArray) -> tuple[FloatArray, list[list[int]], list[list[int]]]:
    """Vertices, edges and faces of a box, rectangle, segment or point about the origin."""
    thick = extent > 0.0
    corner = [0]
    edges: list[list[int]] = []
    faces: list[list[int]] = []
    if thick.all():
        corner, edges, faces = list(range(8)), _BOX_EDGES, _BOX_FACES
    elif thick.sum() == 2:
        edges, faces = [[0, 1], [1, 2], [2, 3], [3, 0]], [[0, 1, 2, 3]]
        first, second = np.eye(3)[thick]
        signs = np.array([-first - second, first - second, first + second, second - first])
        return 0.5 * extent * signs, edges, faces
    elif thick.sum() == 1:
        axis = np.eye(3)[thick][0]
        return 0.5 * extent * np.array([-axis, axis]), [[0, 1]], []
    return 0.5 * extent * _CORNERS[corner], edges, faces


def _polyhedron(shape: PolyhedronShape) -> Polyhedron:
    declared = _declared(shape)
    return build(
        shape.vertices,
        shape.faces,
        name=shape.name,
        radius=shape.rounding,
        edges=shape.edges,
        declared=declared,
        repair=declared is None,
    )


def _shp(shape: ShpShape, directory: Path) -> Polyhedron:
    path = directory / shape.file
    items = read_shp(path)
    item = items.get(shape.item or shape.name)
    if item is None:
        known = ", ".join(items) or "nothing"
        raise GeometryError(
            f'shape "{shape.name}": {path} holds no {shape.item or shape.name!r} but {known}; '
            "set item"
        )
    return build(
        item.vertices,
        item.faces,
        name=shape.name,
        radius=item.radius,
        edges=item.edges,
        declared=_declared(shape) or _declared_item(item),
        keep_features=True,
    )


def _declared_item(item: ShpItem) -> Declared | None:
    if not item.precomputed or item.volume is None or item.inertia_over_mass is None:
        return None
    return item.volume, item.inertia_over_mass


def _mesh(shape: MeshShape, directory: Path) -> Polyhedron:
    vertices, faces = read_mesh(directory / shape.file)
    return build(
        shape.scale * vertices,
        faces,
        name=shape.name,
        radius=shape.rounding,
        declared=_declared(shape),
    )


def read_mesh(path: Path) -> tuple[FloatArray, IntArray | list[list[int]]]:
    """Vertices and facets of an STL, OBJ or PLY file, in the file's unit.

    Raises:
        GeometryError: The file cannot be read, or holds no facets.
    """
    import meshio  # noqa: PLC0415  a scene without meshes starts faster

    if path.is_dir():
        raise GeometryError(f"{path}: is a folder; a mesh is an STL, OBJ or PLY file")
    try:
        endless = path.suffix.lower() == ".ply" and b"end_header" not in path.read_bytes()
        # meshio multiplies an STL's first bytes to tell its kind, and prints before it gives up
        with np.errstate(over="ignore"), redirect_stdout(StringIO()), redirect_stderr(StringIO()):
            mesh = None if endless else meshio.read(path)  # it would look for the end for ever
    except OSError as error:
        raise GeometryError(f"{path}: {error.strerror or error}") from None
    except (Exception, SystemExit):  # noqa: BLE001 - a broken file trips its readers anywhere
        raise GeometryError(f"{path}: cannot be read as an STL, OBJ or PLY mesh") from None
    if mesh is None:
        raise GeometryError(f"{path}: the header of this PLY file has no end")
    blocks = [block.data for block in mesh.cells if block.dim == 2]
    if not blocks:
        raise GeometryError(f"{path}: holds no facets")
    points = np.asarray(mesh.points, float)[:, :3]
    if len({block.shape[1] for block in blocks}) == 1:
        return points, np.concatenate(blocks)
    return points, [facet for block in blocks for facet in block.tolist()]
