"""Rules on the rocks of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, number, read, tables, text
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

KINDS = ("builder", "points", "mesh", "shp", "shape")
"""Kinds of rocks."""

SOLID = ("box", "sphere", "capsule", "mesh", "polyhedron", "shp")
"""Kinds of shapes that can be rocks."""


def rock_names(scene: Any) -> Iterator[Fault]:
    """One rock a name."""
    first: dict[str, int] = {}
    for index, rock in tables(scene, "rock"):
        name = text(rock, "name")
        if name and first.setdefault(name, index) != index:
            yield Fault(("rock", index, "name"), name, f"already the name of rock[{first[name]}]")


def rock_masses(scene: Any) -> Iterator[Fault]:
    """A rock is as heavy as one set of keys says."""
    for index, rock in tables(scene, "rock"):
        kind = text(rock, "kind")
        if kind not in KINDS:
            continue
        keys, wanted = ("mass", "density"), 1
        if kind == "builder":
            keys, wanted = ("volume", *keys), 2
        present = [key for key in keys if read(rock, key) is not None]
        path = ("rock", index)
        if len(present) < wanted:
            lacking = [key for key in keys if key not in present]
            also = f" beside {present[0]}" if present else ""
            listed = f"{', '.join(lacking[:-1])} and {lacking[-1]}"
            count = "two" if wanted - len(present) == 2 else "one"
            yield Fault(path, None, f"give {count} of {listed}{also}")
        elif len(present) > wanted:
            rule = f"follows from {' and '.join(present[:wanted])}: leave one of them out"
            yield Fault((*path, present[-1]), read(rock, present[-1]), rule)


def rock_points(scene: Any) -> Iterator[Fault]:
    """A cloud of points stands here or in a file."""
    for index, rock in tables(scene, "rock"):
        if text(rock, "kind") != "points":
            continue
        here, file = read(rock, "points") is not None, read(rock, "file")
        if here and file is not None:
            yield Fault(("rock", index, "file"), file, "points are given already: leave one out")
        elif not here and file is None:
            yield Fault(("rock", index, "points"), None, "missing: the points, here or in a file")


def rock_rounding(scene: Any) -> Iterator[Fault]:
    """The rounding of a built rock fits into its volume."""
    for index, rock in tables(scene, "rock"):
        if text(rock, "kind") != "builder" or not (rounding := number(rock, "rounding")):
            continue
        volume, mass, density = (number(rock, key) for key in ("volume", "mass", "density"))
        volume = volume or (mass / density if mass and density and density > 0.0 else None)
        if volume and volume > 0.0 and 4.18879 * rounding**3 >= volume:
            largest = (volume / 4.18879) ** (1.0 / 3.0)
            rule = f"must be less than {largest:.3g} m, the radius of a ball of the rock's volume"
            yield Fault(("rock", index, "rounding"), rounding, rule)


def rock_shapes(scene: Any) -> Iterator[Fault]:
    """A rock names a solid shape there is."""
    kinds = {
        name: text(shape, "kind")
        for _, shape in tables(scene, "shape")
        if (name := text(shape, "name"))
    }
    for index, rock in tables(scene, "rock"):
        name = text(rock, "shape")
        if text(rock, "kind") != "shape" or not name:
            continue
        path = ("rock", index, "shape")
        if name not in kinds:
            listed = ", ".join([*kinds][:12]) or "none"
            hint = did_you_mean(name, kinds) or f"; there are: {listed}"
            yield Fault(path, name, f"no [[shape]] has this name{hint}")
        elif kinds[name] not in {*SOLID, None}:
            yield Fault(path, name, f'is of kind "{kinds[name]}", which is no solid that can fall')


ROCK_RULES = (rock_names, rock_masses, rock_points, rock_rounding, rock_shapes)
