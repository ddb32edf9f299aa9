import numpy as np
import pytest
from grids import waves

from warpdem.errors import GeometryError
from warpdem.rockfall.facets import facet_ground
from warpdem.rockfall.heights import height_at, origin_of, slopes_at

AWAY = np.array([2790000.0, 1180000.0, 1500.0])


def sheet(rows, columns, height, *, jitter=0.0):
    """Points and triangles over the unit cells of a grid."""
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    inner = (x > 0) & (x < columns - 1) & (y > 0) & (y < rows - 1)
    moved = np.random.default_rng(7).uniform(-jitter, jitter, (2, *x.shape)) * inner
    x, y = x + moved[0], y + moved[1]
    number = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    corners = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3), corners


def ground_of(points, triangles):
    return facet_ground(points, triangles, origin_of(*points.T))


def plane(x, y):
    return 0.4 * x - 0.3 * y + 7.0


def test_triangles_sampled_from_a_plane_are_that_plane():
    points, triangles = sheet(9, 12, plane, jitter=0.3)
    triangles[::2] = triangles[::2, ::-1]  # wound either way
    points += AWAY
    origin = origin_of(*points.T)
    ground = facet_ground(points, triangles, origin)
    at = np.random.default_rng(0).uniform(0.0, [11.0, 8.0], (2000, 2))
    exact = plane(*at.T) + AWAY[2] - origin[2]
    shift = AWAY[:2] - origin[:2]
    assert height_at(ground, *(at + shift).T) == pytest.approx(exact, abs=1e-9)
    assert ground.steep == pytest.approx(np.full(ground.steep.shape, 0.5), rel=1e-9)
    corners = np.array([[0.0, 0.0], [11.0, 0.0], [11.0, 8.0], [0.0, 8.0]])
    assert height_at(ground, *corners.T) == pytest.approx(
        plane(*corners.T) + AWAY[2] - origin[2], abs=1e-9
    )


def test_triangles_of_a_stl_are_joined_by_their_places():
    points, triangles = sheet(5, 5, plane)
    loose = points[triangles].reshape(-1, 3)
    ground = ground_of(loose, np.arange(len(loose)).reshape(-1, 3))
    assert len(ground.facets.points) == 25
    assert ground.known[:4, :4].all()


def test_quadrilaterals_become_triangles():
    points = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 2], [0, 2, 2]], float)
    ground = ground_of(points, [[0, 1, 2, 3]])
    assert ground.height(np.array([1.0]), np.array([1.5])) == pytest.approx(1.5)


def test_there_is_ground_only_where_triangles_are():
    points, triangles = sheet(9, 9, plane)
    middle = points[triangles].mean(axis=1)
    hole = np.abs(middle[:, :2] - 4.5).max(axis=1) < 1.0
    ground = ground_of(points, triangles[~hole])
    centre = (np.arange(ground.grid.columns) + 0.5) * ground.grid.cell
    x, y = np.meshgrid(centre, centre)
    probes = np.stack([x, y], axis=-1)[:, :, None] + np.linspace(-0.49, 0.49, 9)[:, None]
    whole = np.isfinite(ground.height(probes[..., 0], probes[..., 1])).all(axis=-1)
    assert np.isnan(ground.height(np.array([4.5]), np.array([4.5]))).all()
    assert not (ground.known & ~whole).any()
    assert ground.known.sum() > 0.8 * whole.sum()


def test_steep_bounds_every_rise_within_reach_on_triangles():
    rough = waves(20, 20, seed=1)
    points, triangles = sheet(20, 20, lambda x, y: rough, jitter=0.3)
    ground = ground_of(points, triangles)
    rng = np.random.default_rng(4)
    start = rng.uniform(0.0, 19.0, (20_000, 2))
    angle, length = rng.uniform(0.0, 2.0 * np.pi, 20_000), rng.uniform(1e-3, ground.reach, 20_000)
    end = start + length[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    rise = np.abs(ground.height(*end.T) - ground.height(*start.T))
    cell = ground.grid.index(start[:, 0], start[:, 1])
    assert (np.isnan(rise) | (rise <= ground.steep.reshape(-1)[cell] * length + 1e-9)).all()


def test_an_overhang_is_refused_with_its_place():
    points, triangles = sheet(4, 4, plane)
    points = np.concatenate([points, [[1.5, 1.0, 20.0]]]) + AWAY
    with pytest.raises(GeometryError, match=r"overhangs at \(27900\d\d\.\d\d, 1180"):
        ground_of(points, np.concatenate([triangles, [[1, 2, 16]]]))


def test_a_loose_layer_above_the_ground_is_refused():
    points, triangles = sheet(6, 6, plane)
    points = np.concatenate([points, [[1.1, 1.1, 20], [1.4, 1.1, 20], [1.2, 1.4, 20]]])
    with pytest.raises(GeometryError, match="overhangs"):
        ground_of(points, np.concatenate([triangles, [[36, 37, 38]]]))


def test_a_standing_triangle_is_refused():
    points, triangles = sheet(4, 4, plane)
    points = np.concatenate([points, [[0.5, 0.0, 20.0]]])
    with pytest.raises(GeometryError, match="1 triangles stand vertically"):
        ground_of(points, np.concatenate([triangles, [[0, 1, 16]]]))


def test_a_closed_solid_is_no_ground():
    a, b, c, d = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 3]], float)
    with pytest.raises(GeometryError, match="overhangs"):
        ground_of(np.array([a, b, c, d]), np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]))


def test_slopes_are_those_of_the_triangle_under_a_point():
    points, triangles = sheet(6, 7, lambda x, y: np.sin(x) * np.cos(1.3 * y), jitter=0.3)
    ground = ground_of(points, triangles)
    corner = ground.facets.points[ground.facets.triangles]
    x, y = corner.mean(axis=1)[:, :2].T  # a triangle is linear about its middle
    along_x, along_y = slopes_at(ground, x, y)
    step = 1e-3
    rise = ground.height(x + step, y) - ground.height(x - step, y)
    assert along_x == pytest.approx(rise / (2 * step), abs=1e-9)
    rise = ground.height(x, y + step) - ground.height(x, y - step)
    assert along_y == pytest.approx(rise / (2 * step), abs=1e-9)
    assert np.isnan(slopes_at(ground, np.array([-9.0, 99.0]), np.array([1.0, 1.0]))).all()
