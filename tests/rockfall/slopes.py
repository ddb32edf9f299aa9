"""Small sites and rocks, made by hand.

All sites have the same things on them, out of reach where a test has no use for them, so that one
compiled kernel serves nearly every test; ``bare`` has nothing.
"""

import itertools
from dataclasses import replace

import numpy as np

from warpdem.rockfall.flights import Method, Starts
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.site import Barrier, Grid, Ground, GroundClass, Site, Stand, Trees
from warpdem.rockfall.trajectories import Trajectories

G = 9.81
REACH_CELLS = 2


def ground_of(heights, x=0.0, y=0.0, cell=1.0):
    """Ground through heights at nodes, row 0 in the south."""
    z = np.asarray(heights, float)
    east, north = np.abs(np.diff(z, axis=1)) / cell, np.abs(np.diff(z, axis=0)) / cell
    slope = np.hypot(np.maximum(east[:-1], east[1:]), np.maximum(north[:, :-1], north[:, 1:]))
    known = np.isfinite(slope)
    span = REACH_CELLS
    pad = np.pad(np.where(known, slope, 0.0), span)
    rows, columns = slope.shape
    shifts = itertools.product(range(2 * span + 1), repeat=2)
    steep = np.max([pad[j : j + rows, i : i + columns] for j, i in shifts], axis=0)
    return Ground(Grid(x, y, cell, rows, columns), z, None, known, steep, span * cell)


def plane(slope=(0.0, 0.0), size=200, cell=1.0, level=0.0):
    """An inclined plane through (0, 0, level), ``size`` cells to every side."""
    at = cell * np.arange(-size, size + 1)
    x, y = np.meshgrid(at, at)
    return ground_of(level + slope[0] * x + slope[1] * y, -size * cell, -size * cell, cell)


def law(mu, **more):
    """A class of constant friction."""
    given = {"kappa": 1.0, "beta": 100.0, "drag": 0.0} | more
    return GroundClass(
        "test", mu, more.pop("mu_max", mu), **{k: given[k] for k in given if k != "mu_max"}
    )


AWAY = 1e5
FAR_LINE = Barrier("far", np.array([[AWAY, AWAY], [AWAY, 2 * AWAY]]), np.inf, 0.0)
FAR_TRUNK = Trees(np.array([[AWAY, AWAY]]), np.array([0.2]), np.array([9.0]), np.array([0.5]))
NOWHERE = law(0.5, scar_modulus=500.0)
"""A class of ground of which there is none."""


HARD = law(0.55, mu_max=2.0, kappa=3.0, beta=185.0, drag=0.4)


def bare(ground, kind):
    """A site with one class of ground, results in the ground's own cells."""
    grid = ground.grid
    return Site(
        origin=np.zeros(3),
        crs="",
        ground=ground,
        classes=(kind,),
        class_of=np.zeros((grid.rows, grid.columns), np.int32),
        stands=(),
        stand_of=None,
        trees=None,
        barriers=(),
        results=grid,
    )


def site_on(ground, kind, **more):
    """The same with a barrier, a trunk, a forest and soft soil, out of reach or as given."""
    site = bare(ground, kind)
    far = {
        "classes": (kind, NOWHERE),
        "stands": (Stand(1.0, 1.0),),
        "stand_of": np.full(site.class_of.shape, -1, np.int32),
        "trees": FAR_TRUNK,
        "barriers": (FAR_LINE,),
    }
    return replace(site, **(far | more))


def flyer(site, rocks, method, **how):
    """Trajectories of rocks, one kind more among them that is round."""
    return Trajectories(site, [*rocks, ball()], method, **how)


def flown(site, rocks, method, begin, **how):
    return flyer(site, rocks, method, **how).fly(begin)


def ball(radius=0.5, mass=100.0):
    return Rock(
        "ball", np.zeros((1, 3)), radius, np.array([[0, 0]]), mass,
        np.full(3, 0.4 * mass * radius**2), *box_skin((2 * radius,) * 3),
    )  # fmt: skip


def corners(size):
    return np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * np.asarray(size, float)


def box_skin(size):
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    triangles = [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]
    return corners(size), np.array(triangles)


def box(size=(1.0, 1.0, 1.0), mass=100.0):
    points = corners(size)
    pairs = itertools.combinations(range(8), 2)
    edges = [p for p in pairs if np.sum(points[p[0]] != points[p[1]]) == 1]
    moments = mass / 12 * (np.sum(np.square(size)) - np.square(size))
    return Rock("box", points, 0.0, np.array(edges), mass, moments, *box_skin(size))


def starts(position, velocity=(0, 0, 0), orientation=(1, 0, 0, 0), spin=(0, 0, 0), rock=0):
    """Starts of rocks; a single vector stands for all."""
    position = np.atleast_2d(np.asarray(position, float))
    n = len(position)

    def rows(values):
        return np.broadcast_to(np.asarray(values, float), (n, np.shape(values)[-1])).copy()

    return Starts(
        id=np.arange(n),
        release=np.zeros(n, np.int32),
        rock=np.full(n, rock, np.int32),
        position=position,
        orientation=rows(orientation),
        velocity=rows(velocity),
        spin=rows(spin),
    )


def fixed_step(dt, duration, **more):
    """A method with a constant step."""
    return Method(duration=duration, **({"dt": dt, "stride": 0.0} | more))


def random_orientations(count, seed=0):
    q = np.random.default_rng(seed).normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def throw(velocity=(6.0, 3.7, 12.0), cell=1.0, results=None, method=None, **site):
    """A small ball thrown over a plane from (0.3, 0.2, 5), and what it passed."""
    ground = plane(size=60, cell=cell)
    place = site_on(ground, law(0.5), **site)
    if results:
        place = replace(place, results=results)
    begin = starts([[0.3, 0.2, 5.0]], velocity=velocity)
    return place, flown(place, [ball(0.1, 2.0)], method or Method(duration=1.9), begin)
