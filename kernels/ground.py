"""Heights and slopes of the ground under a point."""

import warp as wp
from warpdem.kernels.fall_views import Terrain
from warpdem.kernels.precision import wide, wide3
from warpdem.kernels.variant import inlined


@inlined()
def column_of(terrain: Terrain, x: wide) -> int:
    """Column of the cell that holds ``x``, or of the nearest one."""
    return wp.clamp(int(wp.floor((x - terrain.x) * terrain.per_metre)), 0, terrain.columns - 1)


@inlined()
def row_of(terrain: Terrain, y: wide) -> int:
    """Row of the cell that holds ``y``, or of the nearest one."""
    return wp.clamp(int(wp.floor((y - terrain.y) * terrain.per_metre)), 0, terrain.rows - 1)


@inlined()
def is_known(terrain: Terrain, x: wide, y: wide) -> bool:
    """Whether a rock's centre may be above this point."""
    i = int(wp.floor((x - terrain.x) * terrain.per_metre))
    j = int(wp.floor((y - terrain.y) * terrain.per_metre))
    inside = i >= 0 and j >= 0 and i < terrain.columns and j < terrain.rows
    if inside:
        inside = terrain.known[j, i] != 0
    return inside


@inlined()
def raster_ground(terrain: Terrain, x: wide, y: wide) -> wide3:
    """Height, dh/dx, dh/dy of the bilinear surface; the border's patch goes on beyond it."""
    i = column_of(terrain, x)
    j = row_of(terrain, y)
    a = (x - terrain.x) * terrain.per_metre - wide(i)
    b = (y - terrain.y) * terrain.per_metre - wide(j)
    h = terrain.heights[j, i]
    east = terrain.heights[j, i + 1] - h
    north = terrain.heights[j + 1, i] - h
    twist = terrain.heights[j + 1, i + 1] - h - north - east
    return wide3(
        h + a * east + b * north + a * b * twist,
        (east + b * twist) * terrain.per_metre,
        (north + a * twist) * terrain.per_metre,
    )


@wp.func
def is_left(a: wp.vec2d, b: wp.vec2d, x: wide, y: wide) -> bool:
    """Whether a point is on the left of the line from a to b, or on it within rounding."""
    cross = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
    return cross >= wide(-1.0e-12) * wp.length_sq(b - a)


@inlined()
def facet_ground(terrain: Terrain, x: wide, y: wide) -> wide3:
    """Height, dh/dx, dh/dy of the highest triangle over the point; NaN where there is none."""
    found = wide3(wide(wp.nan), wide(0.0), wide(0.0))
    number = row_of(terrain, y) * terrain.columns + column_of(terrain, x)
    for k in range(terrain.facet_start[number], terrain.facet_start[number + 1]):
        facet = terrain.facet_member[k]
        a = terrain.facet_corner[facet, 0]
        b = terrain.facet_corner[facet, 1]
        c = terrain.facet_corner[facet, 2]
        if is_left(a, b, x, y) and is_left(b, c, x, y) and is_left(c, a, x, y):
            plane = terrain.facet_plane[facet]
            height = plane[0] + plane[1] * x + plane[2] * y
            if not (height <= found[0]):
                found = wide3(height, plane[1], plane[2])
    return found


@wp.func
def upward_normal(ground: wide3) -> wide3:
    """Unit normal of a ground with slopes ground[1], ground[2]."""
    return wp.normalize(wide3(-ground[1], -ground[2], wide(1.0)))
