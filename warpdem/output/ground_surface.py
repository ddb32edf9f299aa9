"""The ground (terrain.vtu) and the rocks on it (rocks.vtu) as surfaces, in local coordinates.

The field "origin" of both grids gives what national coordinates are more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.orientation import matrix

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Ground, Site
    from warpdem.rockfall.trace import Trace


def ground_surface(site: Site) -> vtkUnstructuredGrid:
    """The cells with data at their four corners, or the triangles.

    Point data: height, national [m]. Cell data: class, a number in the field "classes", and forest,
    that of the stand or -1 without.
    """
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK, which few runs need

    points, faces, cells = _triangles(site.ground) if site.ground.facets else _quads(site.ground)
    stand_of = site.stand_of
    forest = np.full(len(cells), -1) if stand_of is None else stand_of.ravel()[cells]
    grid = vtu.polygons(
        points,
        faces.ravel().astype(np.int32),
        np.arange(0, faces.size + 1, faces.shape[1], dtype=np.int32),
        {
            "class": site.class_of.ravel()[cells].astype(np.int32),
            "forest": forest.astype(np.int32),
        },
        {"height": points[:, 2] + site.origin[2]},
    )
    vtu.note(grid, "origin", site.origin)
    vtu.note(grid, "classes", [each.name for each in site.classes])
    return grid


def rock_skins(traces: Sequence[Trace], site: Site, rocks: Sequence[Rock]) -> vtkUnstructuredGrid:
    """Skins of the rocks of some trajectories, one or more, as they start and as they end.

    Cell data: id, rock, end (0 at the start, 1 at the end).
    """
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK, which few runs need

    points, faces, owners = [], [], []
    first = 0
    for trace in traces:
        skin = rocks[trace.rock]
        for end, sample in enumerate((0, -1)):
            turn = matrix(trace.orientation[sample])
            points.append(skin.skin_points @ turn.T + trace.position[sample])
            faces.append(skin.skin_triangles + first)
            owners.append(np.tile([trace.id, trace.rock, end], (len(skin.skin_triangles), 1)))
            first += len(skin.skin_points)
    corners = np.concatenate(faces).ravel().astype(np.int32)
    ids, kind, ends = np.concatenate(owners).T
    grid = vtu.polygons(
        np.concatenate(points),
        corners,
        np.arange(0, len(corners) + 1, 3, dtype=np.int32),
        {"id": ids, "rock": kind.astype(np.int32), "end": ends.astype(np.uint8)},
    )
    vtu.note(grid, "origin", site.origin)
    return grid


def _quads(ground: Ground) -> tuple[FloatArray, IntArray, IntArray]:
    """Nodes with data, corners of the cells between four of them, and these cells' numbers."""
    assert ground.heights is not None
    heights, grid = ground.heights, ground.grid
    rows, columns = heights.shape
    x, y = np.meshgrid(
        grid.x + grid.cell * np.arange(columns), grid.y + grid.cell * np.arange(rows)
    )
    number = np.arange(heights.size).reshape(rows, columns)
    corners = np.stack(
        [number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1
    ).reshape(-1, 4)
    cells = np.flatnonzero(np.isfinite(heights.ravel()[corners]).all(axis=1))
    used = np.zeros(heights.size, bool)
    used[corners[cells]] = True
    points = np.stack([x, y, heights], axis=-1).reshape(-1, 3)[used]
    return points, (np.cumsum(used) - 1)[corners[cells]], cells


def _triangles(ground: Ground) -> tuple[FloatArray, IntArray, IntArray]:
    """Corners, triangles, and the cells under their centres."""
    assert ground.facets is not None
    points, triangles = ground.facets.points, ground.facets.triangles
    centre = points[triangles].mean(axis=1)
    return points, triangles, np.maximum(ground.grid.index(centre[:, 0], centre[:, 1]), 0)
