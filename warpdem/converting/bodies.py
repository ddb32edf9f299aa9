"""Commands of a Rockable file that change its bodies as they are read."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from warpdem.converting.words import Misread

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from warpdem.converting.conf import Conf
    from warpdem.converting.words import Words


def set_all_velocities(conf: Conf, words: Words) -> None:
    """The same velocity for all free bodies there are so far."""
    velocity = words.vector("the velocity")
    for particle in conf.particles[conf.driven :]:
        particle.velocity = velocity


def clone(conf: Conf, words: Words) -> None:
    """Copies of some bodies, moved, in clusters of their own."""
    first, last = _range(conf, words)
    away = words.vector("the translation")
    largest = max(particle.cluster for particle in conf.particles)
    for particle in conf.particles[first : last + 1]:
        position = tuple(x + dx for x, dx in zip(particle.position, away, strict=True))
        cluster = particle.cluster - first + largest + 1
        conf.particles.append(replace(particle, position=position, cluster=cluster))


def draw_homothety(conf: Conf, words: Words) -> None:
    """Sizes of some bodies, drawn as the program built with GCC draws them without a seed."""
    first, last = _range(conf, words)
    low, high = words.real("the smallest size"), words.real("the largest size")
    seeded = words.integer("0 or 1")
    if seeded:
        said = "homothetyRange: the program seeds it by the clock"
        conf.note(words.place, f"{said}; drawn here as without a seed")
    numbers = _minstd()
    for particle in conf.particles[first : last + 1]:
        particle.homothety = low + (high - low) * next(numbers)


def _range(conf: Conf, words: Words) -> tuple[int, int]:
    first, last = words.count("the first body"), words.count("the last body")
    if not first <= last < len(conf.particles):
        raise Misread(
            f"bodies {first} to {last} of {len(conf.particles)}: the command stands after them"
        )
    return first, last


def _minstd() -> Iterator[float]:
    """Numbers in [0, 1) of libstdc++'s default engine, minstd_rand0, two draws a number.

    Source: Park & Miller (1988), doi:10.1145/63039.63042, multiplier 16807.
    """
    span, state = 2147483646.0, 1
    while True:
        low = state = state * 16807 % 2147483647
        high = state = state * 16807 % 2147483647
        yield ((low - 1) + (high - 1) * span) / (span * span)


ON_BODIES: dict[str, Callable[[Conf, Words], None]] = {
    "setAllVelocities": set_all_velocities,
    "particlesClonage": clone,
    "homothetyRange": draw_homothety,
}
"""The commands by keyword."""
