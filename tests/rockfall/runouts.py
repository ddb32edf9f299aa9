"""A slope that flattens out, and the same rocks on it by both methods."""

from functools import partial
from math import atan, cos, radians, sin, tan

import numpy as np
from grids import write_asc
from rockfall_cases import kolmogorov_smirnov

from warpdem.input.decode import load
from warpdem.rockfall import task
from warpdem.rockfall.flights import Fate
from warpdem.simulation import Simulation

STEEP, FOOT, CURVE, LENGTH = tan(radians(35.0)), 10.0, 8.0, 60.0
"""Slope of the upper part, where it ends, on what length it turns level, where the ground ends."""
LANE = 12.0
"""Width of a rock's own strip [m]; wide enough that none meets another."""
SLAB, BLOCK = (1.0, 0.8, 0.25), (0.6, 0.5, 0.45)
DENSITY = 2700.0


def height(x):
    """Height of the slope [m]; straight, then a parabola, then level."""
    x = np.asarray(x, float)
    left = np.clip(FOOT + CURVE - x, 0.0, CURVE)
    return np.where(x < FOOT, STEEP * (FOOT - x + 0.5 * CURVE), 0.5 * STEEP * left**2 / CURVE)


def sliders(count):
    """Slabs that lie on the slope and slide down at 0 to 5 m/s: places, turns, velocities."""
    speed = 5.0 * (np.arange(count) + 0.5) / count
    down = np.array([cos(atan(STEEP)), 0.0, -sin(atan(STEEP))])
    up = np.array([-down[2], 0.0, down[0]])
    foot = np.array([3.0, 0.0, float(height(3.0))])
    place = np.tile(foot + 0.5 * SLAB[2] * up, (count, 1))
    half = 0.5 * atan(STEEP)
    return place, np.tile([cos(half), 0.0, sin(half), 0.0], (count, 1)), speed[:, None] * down


def tumblers(count, seed=1):
    """Blocks in random orientation that are thrown down the slope at 3 m/s."""
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=(count, 4))
    x = rng.uniform(2.0, 4.0, count)
    place = np.column_stack([x, 0 * x, height(x) + 1.0])
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return place, turn, np.tile([3.0, 0.0, -1.0], (count, 1))


def written(folder, size, begin, *, mu=0.5, en2=0.04, stiffness=2e6, duration=12.0):
    """The scene file of rocks side by side, each in its lane; its path."""
    place, turn, velocity = begin
    lanes = len(place) * LANE
    x = np.arange(-5.0, LENGTH)
    write_asc(folder / "slope.asc", np.tile(height(x), (int(lanes) + 24, 1)), x=-5.0, y=-12.0)
    bodies = "".join(
        _body(row, [*at[:1], LANE * (k + 0.5), at[2]], velocity[k])
        for k, (at, row) in enumerate(zip(place, turn, strict=True))
    )
    contact = f"kn = {stiffness}\nkt = {stiffness}\nen2 = {en2}\nmu = {mu}\n"
    (folder / "slope.toml").write_text(
        f"[run]\nduration = {duration}\n"
        '[[shape]]\nkind = "terrain"\nname = "slope"\nfile = "slope.asc"\n'
        f'[[shape]]\nkind = "box"\nname = "rock"\nsize = {list(size)}\n'
        f'[[group]]\nname = "rock"\ndensity = {DENSITY}\n'
        '[[body]]\nshape = "slope"\ngroup = "ground"\nposition = [0.0, 0.0, 0.0]\nfixed = true\n'
        f'{bodies}[[contact]]\ngroups = ["rock", "ground"]\n{contact}'
        f'[[contact]]\ngroups = ["rock", "rock"]\n{contact}'
    )
    return folder / "slope.toml"


def _body(turn, place, velocity):
    numbers = {"position": place, "orientation": turn, "velocity": velocity}
    lines = (f"{name} = {[float(v) for v in values]}\n" for name, values in numbers.items())
    return '[[body]]\nshape = "rock"\ngroup = "rock"\n' + "".join(lines)


def smooth(path):
    """Run-outs of a scene's free bodies by the smooth method, all of them standing still [m]."""
    simulation = Simulation(load(path, []), device="cpu")
    start = simulation.snapshot().position
    simulation.advance(simulation.scene.run.duration)
    shot = simulation.snapshot()
    assert np.linalg.norm(shot.velocity, axis=1).max() < 1e-2
    return np.linalg.norm((shot.position - start)[1:, :2], axis=1)


def nonsmooth(path, *overrides):
    """The same by the non-smooth method, from the same file."""
    end, _ = flights(path, 'run.method="nonsmooth"', *overrides)
    assert (end.fate == Fate.REST).all()
    return runouts(end)


def flights(path, *overrides):
    """Trajectories of a scene, and the origin of their coordinates in it."""
    prepared = task.prepared(load(path, list(overrides)), "cpu", "")
    flyer = partial(prepared.work.make, visits=False)
    work = prepared.work
    ids = np.arange(prepared.releases.count)
    end = flyer(work.site, work.rocks, work.method, device="cpu").fly(prepared.releases.starts(ids))
    return end, work.site.origin


def runouts(end):
    """Horizontal ways from start to end [m]."""
    return np.linalg.norm((end.position - end.start)[:, :2], axis=1)


def compared(first, second):
    """Largest distance of two samples' distributions, and the probability of a larger one.

    The latter is the asymptotic one with the correction for small samples; Stephens (1970),
    doi:10.1111/j.2517-6161.1970.tb00821.x.
    """
    distance = kolmogorov_smirnov(first, second)
    root = np.sqrt(len(first) * len(second) / (len(first) + len(second)))
    scaled = (root + 0.12 + 0.11 / root) * distance
    if scaled < 0.2:  # the series alternates without end; the sum is 1 within 1e-10
        return distance, 1.0
    k = np.arange(1, 101)
    tail = 2.0 * float(((-1.0) ** (k - 1) * np.exp(-2.0 * (k * scaled) ** 2)).sum())
    return distance, min(max(tail, 0.0), 1.0)
