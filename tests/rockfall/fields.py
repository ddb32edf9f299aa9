"""Sites and flights for tests of the results: an inclined plane, values by the thousand."""

import numpy as np

from warpdem.rockfall.flights import COUNTS, MEASURES, Crossings, Fate, Flights, Visits
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.site import Barrier, Grid, Ground, GroundClass, Site

SLOPE = 0.5
ORIGIN = np.array([2_600_000.0, 1_200_000.0, 1_500.0])


class Incline(Ground):
    """z = - SLOPE x, whoever asks."""

    def height(self, x, y):
        return -SLOPE * np.asarray(x) + 0.0 * np.asarray(y)


def site(*, cell=10.0, rows=30, columns=40, known=None):
    grid = Grid(0.0, 0.0, cell, rows, columns)
    x = np.arange(columns + 1) * cell
    heights = np.tile(-SLOPE * x, (rows + 1, 1))
    everywhere = np.ones((rows, columns), bool)
    ground = Incline(
        grid,
        heights,
        None,
        everywhere if known is None else known,
        np.full((rows, columns), SLOPE),
        1.0,
    )
    classes = (GroundClass("hard", 0.55, 2.0, 3.0, 185.0, 0.4),)
    net = Barrier(
        'net, "upper"', np.array([[200.0, 0.0], [200.0, 100.0], [260.0, 180.0]]), 3.0, 5e5
    )
    line = Barrier("road", np.array([[300.0, 0.0], [300.0, 300.0]]), np.inf, 0.0)
    return Site(
        origin=ORIGIN,
        crs="EPSG:2056",
        ground=ground,
        classes=classes,
        class_of=np.zeros((rows, columns), int),
        stands=(),
        stand_of=None,
        trees=None,
        barriers=(net, line),
        results=grid,
    )


def rock(name="block"):
    corners = np.array([[a, b, c] for a in (-1.0, 1.0) for b in (-1.0, 1.0) for c in (-1.0, 1.0)])
    corners *= [0.4, 0.3, 0.2]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    return Rock(
        name, corners, 0.0, np.zeros((0, 2), int), 500.0, np.array([22.0, 33.0, 42.0]),
        corners, np.array(triangles),
    )  # fmt: skip


def flights(count, *, visits=0, crossings=0, seed=0, first=0, where=None):
    """Trajectories first .. first + count - 1, with values drawn from a seed."""
    where = where or site()
    draw = np.random.default_rng([seed, first])
    ids = np.arange(first, first + count)

    def some(n):
        return np.sort(draw.integers(first, first + count, n)) if count else np.zeros(0, int)

    def real(n, scale):
        return (scale * draw.lognormal(0.0, 1.0, n)).astype(np.float32)

    cells = where.results.rows * where.results.columns
    passed = Visits(
        some(visits),
        draw.integers(0, max(cells // 4, 1), visits),
        real(visits, 1e5),
        real(visits, 10.0),
        real(visits, 1.5),
        real(visits, 5.0),
    )
    start = np.column_stack(
        [draw.uniform(0, 50, count), draw.uniform(50, 250, count), np.zeros(count)]
    )
    end = start + np.column_stack(
        [draw.uniform(0, 400, count), draw.normal(0, 20, count), -draw.uniform(0, 200, count)]
    )
    crossed = some(crossings)
    return Flights(
        id=ids,
        release=np.zeros(count, np.int32),
        rock=np.zeros(count, np.int32),
        fate=draw.choice([Fate.REST, Fate.LEFT, Fate.CAUGHT, Fate.TIMEOUT], count).astype(np.int8),
        time=draw.uniform(5, 30, count),
        start=start,
        position=end,
        orientation=np.tile([1.0, 0, 0, 0], (count, 1)),
        velocity=np.zeros((count, 3)),
        spin=np.zeros((count, 3)),
        counts=draw.integers(0, 1000, (count, len(COUNTS))),
        measures=draw.lognormal(0.0, 1.0, (count, len(MEASURES))),
        visits=passed,
        crossings=Crossings(
            crossed,
            draw.integers(0, 2, crossings).astype(np.int32),
            draw.integers(0, 2, crossings).astype(bool),
            np.sort(draw.uniform(0, 30, crossings)),
            np.column_stack([np.full(crossings, 200.0), draw.uniform(0, 100, crossings),
                             np.full(crossings, -99.0)]),
            draw.lognormal(0, 1, crossings),
            draw.lognormal(12, 1, crossings),
            draw.lognormal(2, 1, crossings),
            draw.lognormal(1, 1, crossings),
        ),
    )  # fmt: skip
