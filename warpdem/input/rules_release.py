"""Rules on the releases of a scene, and on the rocks they name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.rules_rock import ROCK_RULES
from warpdem.input.scene_reading import Fault, entries, number, numbers, read, tables, text
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

RANGES = ("height", "speed", "azimuth", "dip", "spin_rate")
"""Keys of a release that are a number or a range."""


def release_rocks(scene: Any) -> Iterator[Fault]:
    """Releases name rocks there are, each once, and weigh each of them."""
    names = [name for _, rock in tables(scene, "rock") if (name := text(rock, "name"))]
    for index, release in tables(scene, "release"):
        path, rocks = ("release", index), entries(release, "rocks")
        for place, name in enumerate(rocks):
            where = (*path, "rocks", place)
            if isinstance(name, str) and name and name not in names:
                hint = (
                    did_you_mean(name, names) or f"; there are: {', '.join(names[:12]) or 'none'}"
                )
                yield Fault(where, name, f"no [[rock]] has this name{hint}")
            elif name in rocks[:place]:
                yield Fault(where, name, "is named twice: give it a larger weight")
        weights = entries(release, "weights")
        if weights and not rocks:
            yield Fault((*path, "weights"), list(weights), "needs rocks: which are weighed?")
        elif weights and len(weights) != len(rocks):
            rule = f"must have one weight for each of the {len(rocks)} rocks"
            yield Fault((*path, "weights"), list(weights), rule)
    if not names and any(True for _ in tables(scene, "release")):
        yield Fault(("rock",), None, "missing: what is released, a [[rock]]")


def release_motion(scene: Any) -> Iterator[Fault]:
    """A start has one velocity and one spin."""
    for index, release in tables(scene, "release"):
        path = ("release", index)
        has = {key: read(release, key) is not None for key in ("velocity", "speed", "azimuth")}
        for one, other in (("velocity", "speed"), ("spin", "spin_rate")):
            if read(release, one) is not None and read(release, other) is not None:
                rule = f"{one} is given already: leave one of the two out"
                yield Fault((*path, other), read(release, other), rule)
        if has["speed"] and not has["azimuth"] and not _is_vertical(release):
            rule = "missing: where speed points, clockwise from north [degrees]; [0, 360]: anywhere"
            yield Fault((*path, "azimuth"), None, rule)
        for key in ("azimuth", "dip"):
            if read(release, key) is not None and not has["speed"]:
                yield Fault((*path, key), read(release, key), "has no effect without speed")


def _is_vertical(release: Any) -> bool:
    return abs(number(release, "dip") or 0.0) == 90.0


def release_ranges(scene: Any) -> Iterator[Fault]:
    """A range goes up."""
    for index, release in tables(scene, "release"):
        for key in RANGES:
            ends = numbers(release, key, 2)
            if ends and ends[0] > ends[1]:
                rule = "a range goes from its smaller to its larger end"
                if key == "azimuth":
                    rule += f": over north, write [{ends[0]:g}, {ends[1] + 360.0:g}]"
                yield Fault(("release", index, key), ends, rule)


def release_areas(scene: Any) -> Iterator[Fault]:
    """An area stands here or in a file."""
    for index, release in tables(scene, "release"):
        if text(release, "kind") != "area":
            continue
        here, file = read(release, "polygon") is not None, read(release, "file")
        if here and file is not None:
            rule = "a polygon is given already: leave one of the two out"
            yield Fault(("release", index, "file"), file, rule)
        elif not here and file is None:
            rule = "missing: the area, here or in a file"
            yield Fault(("release", index, "polygon"), None, rule)


def release_tables(scene: Any) -> Iterator[Fault]:
    """What a table says is not said beside it."""
    for index, release in tables(scene, "release"):
        columns = read(release, "columns")
        if text(release, "kind") != "table" or columns is None:
            continue
        path = ("release", index)
        said = {"v": ("velocity", "speed"), "w": ("spin", "spin_rate")}
        for letter, keys in said.items():
            axes = [f"{letter}{axis}" for axis in "xyz"]
            present = [axis for axis in axes if read(columns, axis) is not None]
            if present and len(present) < 3:
                rule = f"a vector has three columns: give {', '.join(axes)} or none of them"
                yield Fault((*path, "columns", present[0]), read(columns, present[0]), rule)
            for key in keys if present else ():
                if read(release, key) is not None:
                    rule = f"the table has columns of it ({present[0]}): leave one of the two out"
                    yield Fault((*path, key), read(release, key), rule)
        if read(columns, "rock") is not None and read(release, "rocks") is not None:
            rule = "the table names its rocks: leave rocks or columns.rock out"
            yield Fault((*path, "rocks"), list(entries(release, "rocks")), rule)


def release_count(scene: Any) -> Iterator[Fault]:
    """Points and rows can be counted; lines and areas cannot."""
    if read(read(scene, "ensemble"), "count") is not None:
        return
    for index, release in tables(scene, "release"):
        kind = text(release, "kind")
        if kind in {"line", "area"}:
            rule = f'missing: release[{index}] of kind "{kind}" has no number of its own'
            yield Fault(("ensemble", "count"), None, rule)
            return


RULES = (
    *ROCK_RULES,
    release_rocks,
    release_motion,
    release_ranges,
    release_areas,
    release_tables,
    release_count,
)
