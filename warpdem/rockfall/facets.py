"""The ground as triangles without overhangs: their index, slopes and heights."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError
from warpdem.rockfall.nearby import REACH, around
from warpdem.rockfall.site import Facets, Grid, Ground

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import BoolArray, FloatArray, IntArray

_STEEPEST = 100.0  # slope beyond which a triangle stands: heights there mean nothing
_NEAR = 1e-9  # of a cell or triangle: what counts as its border
_AT_ONCE = 100_000  # points whose candidates are looked at together


def facet_ground(
    points: FloatArray, faces: IntArray | Sequence[Sequence[int]], origin: FloatArray
) -> Ground:
    """The ground of a mesh.

    Args:
        points: In national coordinates [m], shape [point_count, 3].
        faces: Convex polygons; fans of triangles are made of them.
        origin: Of the local coordinates, shape [3].

    Raises:
        GeometryError: A triangle stands, or lies above another; says where.
    """
    points, welded = np.unique(points - origin, axis=0, return_inverse=True)
    triangles = _upward(points, welded.reshape(-1)[_fans(faces)], origin)
    grid = _grid(points, triangles)
    start, members = _index(grid, points, triangles)
    facets = Facets(points, triangles, start, members)
    _refuse_layers(facets, grid, origin)
    steep = np.zeros(grid.rows * grid.columns)
    np.maximum.at(steep, np.repeat(np.arange(len(steep)), np.diff(start)), _slope(facets)[members])
    shape = grid.rows, grid.columns
    known = _covered(facets, grid).reshape(shape)
    return Ground(grid, None, facets, known, around(steep.reshape(shape), REACH), REACH * grid.cell)


def _fans(faces: IntArray | Sequence[Sequence[int]]) -> IntArray:
    if isinstance(faces, np.ndarray) and faces.shape[1] == 3:
        return faces.astype(np.int64)
    fans = [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]
    return np.array(fans, np.int64).reshape(-1, 3)


def _normals(points: FloatArray, triangles: IntArray) -> FloatArray:
    a, b, c = points[triangles].swapaxes(0, 1)
    return np.cross(b - a, c - a)


def _upward(points: FloatArray, triangles: IntArray, origin: FloatArray) -> IntArray:
    """The triangles that have an area, counter-clockwise seen from above."""
    normal = _normals(points, triangles)
    keep = np.linalg.norm(normal, axis=1) > 0.0
    triangles, normal = triangles[keep], normal[keep]
    standing = np.hypot(normal[:, 0], normal[:, 1]) > _STEEPEST * np.abs(normal[:, 2])
    if standing.any():
        where = _place(points, triangles[int(np.argmax(standing))], origin)
        raise GeometryError(
            f"{standing.sum()} triangles stand vertically, the first at {where}; ground has one "
            "height at each place: cut a mesh down to its upper side, or make a raster of it"
        )
    down = normal[:, 2] < 0.0
    triangles[down] = triangles[down][:, [0, 2, 1]]
    sides = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = sides[:, 0] * len(points) + sides[:, 1]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    if (folded := first[count > 1]).size:
        _refuse(points, triangles[int(folded.min()) // 3], origin)
    return triangles


def _place(points: FloatArray, triangle: IntArray, origin: FloatArray) -> str:
    x, y, z = points[triangle].mean(axis=0) + origin
    return f"({x:.2f}, {y:.2f}, {z:.2f})"


def _refuse(points: FloatArray, triangle: IntArray, origin: FloatArray) -> None:
    raise GeometryError(
        f"the mesh overhangs at {_place(points, triangle, origin)}: two triangles lie above one "
        "another; ground has one height at each place: remove one layer, or make a raster of it"
    )


def _refuse_layers(facets: Facets, grid: Grid, origin: FloatArray) -> None:
    """Refuse triangles whose middle lies above or below another one."""
    middle = facets.points[facets.triangles].mean(axis=1)
    for begin in range(0, len(middle), _AT_ONCE):
        part = middle[begin : begin + _AT_ONCE]
        point, _, depth = _candidates(facets, grid, part[:, 0], part[:, 1])
        layers = np.bincount(point[depth > _NEAR], minlength=len(part))
        if (layers > 1).any():
            _refuse(facets.points, facets.triangles[begin + int(np.argmax(layers > 1))], origin)


def _grid(points: FloatArray, triangles: IntArray) -> Grid:
    """Cells of about two triangles each, their edge a round number."""
    used = points[np.unique(triangles)]
    low, high = used[:, :2].min(axis=0), used[:, :2].max(axis=0)
    width, depth = high - low
    cell = float(f"{np.sqrt(2.0 * width * depth / len(triangles)):.1g}")
    columns, rows = (max(1, ceil(side / cell - _NEAR)) for side in (width, depth))
    return Grid(float(low[0]), float(low[1]), cell, rows, columns)


def _index(grid: Grid, points: FloatArray, triangles: IntArray) -> tuple[IntArray, IntArray]:
    """First member of each cell, and the triangles whose plan reaches into the cells."""
    corner = points[triangles][:, :, :2]
    low, high = corner.min(axis=1), corner.max(axis=1)
    triangle, cell = _cells(grid, low, high)
    centre, half = _centres(grid, cell), 0.5 * grid.cell
    # what only touches a cell is left out: else a triangulated raster has 16 members a cell, not 2
    meets = ((low[triangle] < centre + half) & (high[triangle] > centre - half)).all(axis=1)
    for side in range(3):
        a, b = corner[triangle, side], corner[triangle, (side + 1) % 3]
        inward = np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]])
        reach = half * np.abs(inward).sum(axis=1)
        meets &= np.einsum("ij,ij->i", centre - a, inward) > -reach
    triangle, cell = triangle[meets], cell[meets]
    order = np.argsort(cell, kind="stable")
    count = np.bincount(cell, minlength=grid.rows * grid.columns)
    return np.concatenate([[0], np.cumsum(count)]), triangle[order]


def _cells(grid: Grid, low: FloatArray, high: FloatArray) -> tuple[IntArray, IntArray]:
    """Boxes and the cells they touch, borders included: numbers of both, shape [n] each."""
    start = np.array([grid.x, grid.y])
    last = np.array([grid.columns, grid.rows]) - 1
    first = np.clip(np.floor((low - start) / grid.cell - _NEAR).astype(np.int64), 0, last)
    final = np.clip(np.floor((high - start) / grid.cell + _NEAR).astype(np.int64), 0, last)
    size = final - first + 1
    count = size.prod(axis=1)
    box = np.repeat(np.arange(len(low)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    column = first[box, 0] + place % size[box, 0]
    row = first[box, 1] + place // size[box, 0]
    return box, row * grid.columns + column


def _centres(grid: Grid, cell: IntArray) -> FloatArray:
    row, column = np.divmod(cell, grid.columns)
    return np.column_stack([grid.x + (column + 0.5) * grid.cell, grid.y + (row + 0.5) * grid.cell])


def _slope(facets: Facets) -> FloatArray:
    normal = _normals(facets.points, facets.triangles)
    return np.hypot(normal[:, 0], normal[:, 1]) / normal[:, 2]


def _covered(facets: Facets, grid: Grid) -> BoolArray:
    """Cells wholly above triangles: their centres are, and no border runs through them."""
    sides = facets.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = sides[:, 0] * len(facets.points) + sides[:, 1]
    twin = sides[:, 1] * len(facets.points) + sides[:, 0]
    a, b = facets.points[sides[~np.isin(key, twin)]][:, :, :2].swapaxes(0, 1)
    segment, cell = _cells(grid, np.minimum(a, b), np.maximum(a, b))
    a, b = a[segment], b[segment]
    centre, half = _centres(grid, cell), 0.5 * grid.cell * (1.0 - 1e3 * _NEAR)
    normal = np.column_stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]])
    across = np.abs(np.einsum("ij,ij->i", centre - a, normal)) < half * np.abs(normal).sum(axis=1)
    along = (np.minimum(a, b) < centre + half) & (np.maximum(a, b) > centre - half)
    covered = np.ones(grid.rows * grid.columns, bool)
    covered[cell[across & along.all(axis=1)]] = False
    middle = _centres(grid, np.arange(len(covered)))
    return covered & np.isfinite(height_at(facets, grid, middle[:, 0], middle[:, 1]))


def height_at(facets: Facets, grid: Grid, x: FloatArray, y: FloatArray) -> FloatArray:
    """Height of the triangle under each point [m], NaN where there is none; shape [n]."""
    height = np.full(len(x), np.nan)
    for begin in range(0, len(x), _AT_ONCE):
        at = slice(begin, begin + _AT_ONCE)
        height[at] = _heights(facets, grid, x[at], y[at])
    return height


def slopes_at(facets: Facets, grid: Grid, x: FloatArray, y: FloatArray) -> FloatArray:
    """Slopes dh/dx, dh/dy of the triangle under each point, NaN without one; shape [n, 2]."""
    slopes = np.full((len(x), 2), np.nan)
    for begin in range(0, len(x), _AT_ONCE):
        at = slice(begin, begin + _AT_ONCE)
        point, triangle = _under(facets, grid, x[at], y[at])
        normal = _normals(facets.points, facets.triangles[triangle])
        slopes[begin + point] = -normal[:, :2] / normal[:, 2:]
    return slopes


def _heights(facets: Facets, grid: Grid, x: FloatArray, y: FloatArray) -> FloatArray:
    point, triangle = _under(facets, grid, x, y)
    corner = facets.points[facets.triangles[triangle, 0]]
    normal = _normals(facets.points, facets.triangles[triangle])
    rise = (x[point] - corner[:, 0]) * normal[:, 0] + (y[point] - corner[:, 1]) * normal[:, 1]
    height = np.full(len(x), np.nan)
    height[point] = corner[:, 2] - rise / normal[:, 2]
    return height


def _under(facets: Facets, grid: Grid, x: FloatArray, y: FloatArray) -> tuple[IntArray, IntArray]:
    """Points that have a triangle under them, and that triangle."""
    point, triangle, depth = _candidates(facets, grid, x, y)
    order = np.lexsort((-depth, point))  # the triangle a point lies deepest in comes first
    point, triangle, depth = point[order], triangle[order], depth[order]
    best = np.flatnonzero(np.diff(point, prepend=-1) > 0)
    best = best[depth[best] >= -_NEAR]
    return point[best], triangle[best]


def _candidates(
    facets: Facets, grid: Grid, x: FloatArray, y: FloatArray
) -> tuple[IntArray, IntArray, FloatArray]:
    """Points, triangles of their cells, and the smallest barycentric coordinate of each pair."""
    column, row = np.floor((x - grid.x) / grid.cell), np.floor((y - grid.y) / grid.cell)
    # what lies on the outer border belongs to the last cell
    inside = (column >= -1) & (column <= grid.columns) & (row >= -1) & (row <= grid.rows)
    column, row = (
        np.clip(np.where(inside, place, 0), 0, count - 1).astype(np.int64)
        for place, count in ((column, grid.columns), (row, grid.rows))
    )
    cell = row * grid.columns + column
    begin = facets.start[cell]
    count = np.where(inside, facets.start[cell + 1] - begin, 0)
    point = np.repeat(np.arange(len(x)), count)
    slot = np.repeat(begin - np.cumsum(count) + count, count) + np.arange(count.sum())
    triangle = facets.members[slot]
    corner = facets.points[facets.triangles[triangle]][:, :, :2]
    away = corner - np.column_stack([x[point], y[point]])[:, None]
    after, before = away[:, [1, 2, 0]], away[:, [2, 0, 1]]
    share = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    return point, triangle, share.min(axis=1) / share.sum(axis=1)
