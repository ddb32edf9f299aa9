"""Convex solids of shapes, meshes and clouds: themselves, or their hulls."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.hull import convex_hull
from warpdem.geometry.polyhedron import Polyhedron, build
from warpdem.geometry.shapes import polyhedron_of, read_mesh
from warpdem.geometry.shp import read_shp
from warpdem.input.scene_shapes import MeshShape, PolyhedronShape, ShpShape

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene_shapes import Shape

_INSIDE = 1e-6  # of the size: how far below its hull a corner must lie to make a note


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


def _corners(shape: Shape, directory: Path) -> tuple[FloatArray, float] | None:
    """Corners and rounding of a shape that may be no convex solid; None for others.

    A shape with declared mass properties is taken as it is.
    """
    match shape:
        case PolyhedronShape(volume=None):
            return np.array(shape.vertices, float), shape.rounding
        case MeshShape(volume=None):
            return shape.scale * mesh_corners(directory / shape.file), shape.rounding
        case ShpShape(volume=None):
            item = read_shp(directory / shape.file).get(shape.item or shape.name)
            return (np.array(item.vertices), item.radius) if item else None
    return None


def mesh_corners(path: Path) -> FloatArray:
    """Vertices of the facets of a mesh, in the file's unit, shape [vertex_count, 3].

    Raises:
        GeometryError: The file cannot be read, or holds no facets.
    """
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
