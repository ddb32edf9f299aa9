import numpy as np
import pytest

from warpdem.errors import GeometryError
from warpdem.geometry.hull import TOLERANCE, convex_hull
from warpdem.geometry.polyhedron import build

RANDOM = np.random.default_rng(4)
GRID = np.array(np.meshgrid(*[np.linspace(0.0, 1.0, 6)] * 3)).reshape(3, -1).T


def turn():
    return np.linalg.qr(RANDOM.normal(size=(3, 3)))[0]


def ball(count):
    points = RANDOM.normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


CLOUDS = {
    "grid in a cube": GRID,
    "grid in a turned cube far away": GRID @ turn() + 1e3,
    "grid in single precision": (GRID @ turn()).astype(np.float32).astype(float),
    "noise below the tolerance": GRID @ turn() + 1e-9 * RANDOM.normal(size=GRID.shape),
    "noise near the tolerance": GRID + 3e-7 * RANDOM.normal(size=GRID.shape),
    "noise above the tolerance": GRID @ turn() + 1e-5 * RANDOM.normal(size=GRID.shape),
    "ball": ball(300),
    "ball of repeated points": np.repeat(ball(60), 4, axis=0),
    "needle": ball(200) * [1.0, 1e-3, 1e-3],
    "plate": ball(200) * [1.0, 1.0, 1e-3],
    "cloud": RANDOM.normal(size=(20_000, 3)),
    "large coordinates": 1e6 * ball(100) + [2.6e6, 1.2e6, 0.0],
    "small": 1e-12 * ball(100),
}


def volume(points, facets):
    a, b, c = (points[facets[:, k]] - points.mean(axis=0) for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0


def compact(points, facets):
    used, number = np.unique(facets, return_inverse=True)
    return points[used], number.reshape(facets.shape)


@pytest.mark.parametrize("name", CLOUDS)
def test_a_hull_is_closed_and_holds_all_points(name):
    points = CLOUDS[name]
    facets = convex_hull(points)

    sides = np.concatenate([facets, np.roll(facets, -1, axis=1)], axis=1).reshape(-1, 2, 3)
    sides = np.swapaxes(sides, 1, 2).reshape(-1, 2)
    assert len(np.unique(sides, axis=0)) == len(sides)
    assert {*map(tuple, sides.tolist())} == {(b, a) for a, b in sides.tolist()}
    assert len(np.unique(facets)) - len(sides) // 2 + len(facets) == 2
    a, b, c = (points[facets[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    height = (points @ normal.T - np.einsum("ij,ij->i", a, normal)).max()
    assert height <= 2.0 * TOLERANCE * np.ptp(points, axis=0).max()


@pytest.mark.parametrize("name", CLOUDS)
def test_a_hull_has_the_volume_that_qhull_finds(name):
    spatial = pytest.importorskip("scipy.spatial")
    points = CLOUDS[name]
    wanted = spatial.ConvexHull((points - points.mean(axis=0)) / np.ptp(points, axis=0)).volume
    found = volume(points, convex_hull(points)) / np.prod(np.ptp(points, axis=0))
    assert found == pytest.approx(wanted, rel=1e-4 if name == "plate" else 1e-6)


@pytest.mark.parametrize("name", CLOUDS)
@pytest.mark.parametrize("radius", [0.0, 0.05])
def test_every_hull_is_the_core_of_a_convex_shape(name, radius):
    points = CLOUDS[name] / np.ptp(CLOUDS[name], axis=0).max()
    shape = build(*compact(points, convex_hull(points)), name=name, radius=radius)
    assert shape.closed
    assert shape.convex
    assert shape.volume_error == 0.0


@pytest.mark.parametrize("name", [*CLOUDS][:4])
def test_coplanar_points_leave_a_cube(name):
    points = CLOUDS[name]
    shape = build(*compact(points, convex_hull(points)), name=name, radius=0.0)
    assert (len(shape.vertices), len(shape.edges), len(shape.faces)) == (8, 12, 6)
    assert shape.volume == pytest.approx(1.0, abs=3e-7)


def test_points_on_a_ball_are_all_corners():
    assert len(np.unique(convex_hull(ball(300)))) == 300


def test_a_hull_does_not_depend_on_scale_or_place():
    points = ball(50)
    assert np.array_equal(convex_hull(points), convex_hull(1024.0 * points))


@pytest.mark.parametrize(
    ("points", "words"),
    [
        (GRID[:3], "four points at least, not 3"),
        (np.ones((9, 3)), "all points are one"),
        (np.outer(np.arange(9.0), [1.0, 2.0, 3.0]), "lie on one straight line"),
        (GRID * [1.0, 1.0, 0.0] @ turn(), "lie on one plane"),
        (GRID * [1.0, 1.0, 1e-8], "lie on one plane"),
        (np.where(np.arange(216)[:, None] == 7, np.nan, GRID), "point 7 is not finite"),
    ],
)
def test_what_spans_no_solid_is_refused(points, words):
    with pytest.raises(GeometryError, match=words):
        convex_hull(points)
