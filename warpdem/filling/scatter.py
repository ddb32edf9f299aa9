"""Where generated bodies go: centres of balls that meet neither one another nor anything else."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.ballgrid import BallGrid
from warpdem.filling.repeat import Repeat

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.arrays import BoolArray, FloatArray, IntArray

    Blocked = Callable[[FloatArray, FloatArray], BoolArray]

_APART = 1.0 + 1e-9  # balls that would just touch keep apart by rounding
# few, since a ball that loses its place to another of the round has spent them all
_TRIES_A_ROUND = 4
_TRIES = 100  # random places a ball may try on the average
_BATCH = 4000  # places tried at once at least
_ROUNDS = 256  # looked at together at most


class Balls:
    """Balls that have their place; a few layers, each at least twice as full as the next."""

    def __init__(self) -> None:
        self._layers: list[_Layer] = []

    def add(self, centres: FloatArray, radii: FloatArray) -> None:
        """Add balls, shapes [n, 3] and [n]."""
        if not len(radii):
            return
        while self._layers and len(self._layers[-1].radii) < 2 * len(radii):
            layer = self._layers.pop()
            centres = np.concatenate([layer.centres, centres])
            radii = np.append(layer.radii, radii)
        self._layers.append(_Layer(centres, radii))

    def touched(self, centres: FloatArray, radii: FloatArray, largest: float) -> BoolArray:
        """Which of other balls meet one of these, shape [n]; ``largest`` bounds their radii."""
        touched = np.zeros(len(radii), bool)
        for layer in self._layers:
            free = np.flatnonzero(~touched)
            touched[free] = layer.touched(centres[free], radii[free], largest)
        return touched


class _Layer:
    """Balls with a grid for others up to a radius, made anew when that changes."""

    def __init__(self, centres: FloatArray, radii: FloatArray) -> None:
        self.centres, self.radii = centres, radii
        self._grid: tuple[float, BallGrid] | None = None

    def touched(self, centres: FloatArray, radii: FloatArray, largest: float) -> BoolArray:
        if self._grid is None or self._grid[0] != largest:
            reach = (self.radii + largest) * _APART
            self._grid = largest, BallGrid(self.centres, reach)
        ball, mine = self._grid[1].near(centres)
        if not len(ball):
            return np.zeros(len(radii), bool)
        apart = centres[ball] - self.centres[mine]
        square = np.einsum("ij,ij->i", apart, apart)
        touched = np.zeros(len(radii), bool)
        touched[ball[square < ((radii[ball] + self.radii[mine]) * _APART) ** 2]] = True
        return touched


def lattice(
    low: FloatArray,
    high: FloatArray,
    radius: float,
    spacing: float,
    repeat: Repeat | None = None,
) -> FloatArray:
    """Sites of a simple cubic lattice of balls inside a box, x fastest, from its lowest corner.

    Args:
        low: Lowest corner of the box [m], shape [3].
        high: Highest corner [m], shape [3].
        radius: Of the balls [m].
        spacing: Clear distance between neighbours [m].
        repeat: Periods of space; along an axis that the box spans the sites go round evenly.

    Returns:
        Centres, shape [site_count, 3].
    """
    free = high - low - 2.0 * radius
    pitch = (2.0 * radius + spacing) * _APART
    # a box of exactly so many balls holds them, the margin notwithstanding
    steps = np.floor(free / pitch + 1e-6).astype(np.int64)
    if (free < -1e-9 * radius).any():
        return np.zeros((0, 3))
    steps = np.maximum(steps, 0)
    x, y, z = (
        low[axis]
        + radius
        + np.minimum(pitch, max(free[axis], 0.0) / max(1, steps[axis])) * np.arange(steps[axis] + 1)
        for axis in range(3)
    )
    around = (repeat or Repeat()).spans(low, high)
    count = np.floor((high - low) / pitch + 1e-6).astype(np.int64)
    x, y, z = (
        low[axis] + (high - low)[axis] * (np.arange(count[axis]) + 0.5) / max(1, count[axis])
        if around[axis]
        else line
        for axis, line in enumerate((x, y, z))
    )
    sites = np.stack(np.meshgrid(z, y, x, indexing="ij"), axis=-1).reshape(-1, 3)
    return sites[:, ::-1]


def random_places(
    generator: np.random.Generator,
    low: FloatArray,
    high: FloatArray,
    radii: FloatArray,
    blocked: Blocked,
    repeat: Repeat | None = None,
) -> tuple[FloatArray, BoolArray]:
    """Random places in a box for balls, the largest first, none meeting another.

    Each place is drawn evenly from where the ball lies inside the box, and again when it is taken;
    after 100 draws a ball on the average the rest are left out.

    Args:
        generator: Source of randomness.
        low: Lowest corner of the box [m], shape [3].
        high: Highest corner [m], shape [3].
        radii: Of the balls [m], shape [ball_count].
        blocked: Says which balls, by centres and radii, meet something else.
        repeat: Periods of space; along an axis that the box spans centres lie anywhere in it.

    Returns:
        Centres, shape [ball_count, 3], and whether each ball has a place, shape [ball_count].
    """
    centres = np.zeros((len(radii), 3))
    placed = np.zeros(len(radii), bool)
    repeat = repeat or Repeat()
    inset = np.where(repeat.spans(low, high), 0.0, 1.0)
    room = np.where(inset > 0.0, high - low, np.inf)
    fits = (2.0 * radii <= room.min()) & repeat.wide_enough(radii)
    order = np.argsort(-radii, kind="stable")
    order = order[fits[order]]
    balls, draws = Balls(), _Draws(generator)
    # balls of a size within a factor two take their turn together
    octave = np.floor(np.log2(radii[order] / radii[order].max(initial=1e-300)))
    for group in np.split(order, np.flatnonzero(np.diff(octave)) + 1):
        region, result = (low, high, inset), (centres, placed)
        _scatter(draws, region, radii, group, repeat, result=result, balls=balls, blocked=blocked)
    return centres, placed


class _Draws:
    """Numbers drawn evenly from 0 to 1, of which some may be put back."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._generator = generator
        self._kept = np.zeros(0)

    def take(self, count: int) -> FloatArray:
        """The next numbers, shape [count]."""
        lacking = max(0, count - len(self._kept))
        row = np.concatenate([self._kept, self._generator.random(lacking)])
        self._kept = row[count:]
        return row[:count]

    def put_back(self, numbers: FloatArray) -> None:
        """Make numbers the next ones again."""
        self._kept = np.concatenate([numbers, self._kept])


def _scatter(
    draws: _Draws,
    box: tuple[FloatArray, FloatArray, FloatArray],
    radii: FloatArray,
    group: IntArray,
    repeat: Repeat,
    *,
    result: tuple[FloatArray, BoolArray],
    balls: Balls,
    blocked: Blocked,
) -> None:
    """Place the balls in ``group``, in rounds; several at once while none finds a place."""
    centres, placed = result
    budget = _TRIES * len(group)
    largest = float(radii[group].max(initial=0.0))
    rounds = 1
    while len(group) and budget > 0:
        share = max(1, min(_BATCH // len(group), budget // len(group), _TRIES_A_ROUND))
        tries = np.repeat(group, share)
        rounds = max(1, min(rounds, _ROUNDS, _BATCH // len(tries), budget // len(tries)))
        reach = radii[tries]
        inset = reach[:, None] * box[2]
        low, high = box[0] + inset, box[1] - inset
        drawn = draws.take(3 * rounds * len(tries))
        where = (low + drawn.reshape(rounds, -1, 3) * (high - low)).reshape(-1, 3)
        reach = np.tile(reach, rounds)
        # one bound for all rounds, that the grids of the balls need not be made anew
        met = repeat.touched(lambda c, r: balls.touched(c, r, largest), where, reach)
        free = np.flatnonzero(~met)
        free = free[~repeat.touched(blocked, where[free], reach[free])]
        # the first round that finds a place ends them: the others are drawn again
        whole = free[0] // len(tries) + 1 if len(free) else rounds
        draws.put_back(drawn[3 * whole * len(tries) :])
        budget -= whole * len(tries)
        rounds = whole if len(free) else 2 * rounds
        free = free[free < whole * len(tries)]
        free = _winners(free, tries[free % len(tries)], where, reach, repeat)
        chosen = tries[free % len(tries)]
        centres[chosen], placed[chosen] = where[free], True
        balls.add(where[free], reach[free])
        group = group[~placed[group]]


def _winners(
    free: IntArray, ball: IntArray, where: FloatArray, reach: FloatArray, repeat: Repeat
) -> IntArray:
    """Those of a round's free places that are the first of their ball and meet none before them."""
    _, first = np.unique(ball, return_index=True)
    free = free[np.sort(first)]
    return free[_undisputed(where[free], reach[free], repeat)]


def _undisputed(centres: FloatArray, radii: FloatArray, repeat: Repeat) -> BoolArray:
    """Balls that meet none before them in the row, shape [n]."""
    undisputed = np.ones(len(radii), bool)
    if len(radii) > 1:
        most = 2.0 * radii.max()
        low, high = centres.min(axis=0) - most, centres.max(axis=0) + most
        places, whose = repeat.with_images(centres, low, high)
        later, image = BallGrid(places, radii[whose] + radii.max()).near(centres)
        before = whose[image] < later
        later, image = later[before], image[before]
        distance = np.linalg.norm(centres[later] - places[image], axis=1)
        earlier = whose[image]
        undisputed[later[distance < (radii[later] + radii[earlier]) * _APART]] = False
    return undisputed
