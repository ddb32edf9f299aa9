"""Ground from a raster of heights: an ESRI ASCII grid as a surface of triangles."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING, Literal

import numpy as np

from warpdem.errors import GeometryError
from warpdem.geometry.activity import active_vertices, borders, terrain_cones, terrain_edges
from warpdem.geometry.core import Core
from warpdem.geometry.facets import facets_of, twins
from warpdem.geometry.polyhedron import Polyhedron, in_frame
from warpdem.geometry.text_file import text_of

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray

_HEADER = ("ncols", "nrows", "xllcorner", "yllcorner", "cellsize", "nodata_value")
_CENTRES = {"xllcenter": "xllcorner", "yllcenter": "yllcorner"}


@dataclass(frozen=True, eq=False)
class Raster:
    """Heights at nodes of a square grid.

    Attributes:
        x: Of the columns, rising [m], shape [column_count].
        y: Of the rows, falling: the first row lies in the north [m], shape [row_count].
        heights: NaN where there are no data [m], shape [row_count, column_count].
        cell: Distance of neighbouring nodes [m].
        crs: Reference system, empty when the file does not say.
    """

    x: FloatArray
    y: FloatArray
    heights: FloatArray
    cell: float
    crs: str = ""


def raster_of(
    heights: FloatArray, west: float, south: float, cell: float, *, crs: str = ""
) -> Raster:
    """Heights and the place of the node in the last row, first column."""
    rows, columns = heights.shape
    return Raster(
        west + cell * np.arange(columns, dtype=np.float64),
        south + cell * np.arange(rows, dtype=np.float64)[::-1],
        heights,
        cell,
        crs,
    )


def read_raster(path: Path, nodes: Literal["corner", "centre"] = "corner") -> Raster:
    """An ESRI ASCII grid.

    Args:
        path: The file.
        nodes: Where the height of the last row, first column lies: at (xllcorner, yllcorner), or in
            the centre of the cell that has its corner there. xllcenter, yllcenter are its place in
            both cases.

    Raises:
        GeometryError: The file cannot be read or understood.
    """
    header, rest = _header(path, text_of(path).splitlines())
    columns, rows = int(header["ncols"]), int(header["nrows"])
    try:
        parts = [np.array(line.split(), np.float64) for line in rest]
    except ValueError as error:
        raise GeometryError(f"{path}: {error}") from None
    heights = np.concatenate([np.zeros(0), *parts])
    if len(heights) != rows * columns or min(rows, columns) < 2:
        raise GeometryError(
            f"{path}: {rows} rows of {columns} heights are announced (two of two at least), "
            f"{len(heights)} heights are there"
        )
    if "nodata_value" in header:
        heights[heights == header["nodata_value"]] = np.nan
    cell = header["cellsize"]
    half = 0.5 * cell if nodes == "centre" else 0.0
    west, south = (header.get(f"{axis}llcenter", header[f"{axis}llcorner"] + half) for axis in "xy")
    return raster_of(heights.reshape(rows, columns), west, south, cell)


def _header(path: Path, lines: list[str]) -> tuple[dict[str, float], list[str]]:
    """Header values by key in small letters, and the lines that follow."""
    header: dict[str, float] = {}
    count = 0
    for number, line in enumerate(lines):
        key, *values = line.split() or [""]
        known = key.lower()
        if known not in {*_HEADER, *_CENTRES}:
            break
        try:
            header[known] = float(" ".join(values))
        except ValueError:
            raise GeometryError(f"{path}:{number + 1}: {key} needs a number") from None
        if known in _CENTRES:
            header[_CENTRES[known]] = header[known]
        count = number + 1
    if missing := [key for key in _HEADER[:5] if key not in header]:
        raise GeometryError(
            f"{path}: the header lacks {', '.join(missing)}; an ESRI ASCII grid begins with "
            "ncols, nrows, xllcorner, yllcorner, cellsize, NODATA_value"
        )
    for key in ("ncols", "nrows"):
        if not (header[key] >= 1.0 and header[key] % 1.0 == 0.0):
            raise GeometryError(f"{path}: {key} must be a positive whole number")
    if not (header["cellsize"] > 0.0 and all(map(isfinite, (header[k] for k in _HEADER[:5])))):
        raise GeometryError(f"{path}: cellsize must be positive, and the header's numbers finite")
    return header, lines[count:]


def terrain(raster: Raster, *, name: str, radius: float) -> Polyhedron:
    """The ground through the nodes: two triangles a cell, split from its north-west corner.

    Neighbouring triangles stay apart where they are coplanar, but then their edge is inactive. The
    origin is the middle of the ground's box, so that coordinates stay small.

    Raises:
        GeometryError: No cell has data at its four corners.
    """
    vertices, triangles = _mesh(raster)
    if not len(triangles):
        raise GeometryError(f'shape "{name}": the raster has no cell with data at all four corners')
    origin = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    facets = facets_of(triangles)
    twin, _ = twins(facets)
    core = Core(vertices - origin, facets, twin, np.zeros((0, 2), int), np.zeros(0, int), False)
    edges = borders(facets)
    edge_active = terrain_edges(core, edges)
    cone_start, cone_planes = terrain_cones(core, edges)
    return in_frame(
        core,
        None,
        origin=origin,
        name=name,
        radius=radius,
        edges=edges.astype(np.int32),
        convex=False,
        two_sided=False,
        terrain=True,
        vertex_active=active_vertices(len(vertices), edges, edge_active),
        edge_active=edge_active,
        cone_start=cone_start.astype(np.int32),
        cone_planes=cone_planes,
    )


def _mesh(raster: Raster) -> tuple[FloatArray, IntArray]:
    """Nodes of the cells with data, and their triangles, normals upward."""
    known = np.isfinite(raster.heights)
    rows, columns = known.shape
    number = np.arange(rows * columns).reshape(rows, columns)
    north_west, north_east = number[:-1, :-1], number[:-1, 1:]
    south_west, south_east = number[1:, :-1], number[1:, 1:]
    cells = np.stack([north_west, south_west, south_east, north_east], axis=-1)
    cells = cells[known.reshape(-1)[cells].all(axis=-1)]
    triangles = cells[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    used = np.zeros(rows * columns, bool)
    used[triangles] = True
    x, y = np.meshgrid(raster.x, raster.y)
    vertices = np.stack([x, y, raster.heights], axis=-1).reshape(-1, 3)[used]
    return vertices, (np.cumsum(used) - 1)[triangles]
