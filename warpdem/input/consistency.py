"""Rules that tie keys of a scene together; they need no geometry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from warpdem.input.rules_bond import RULES as BOND_RULES
from warpdem.input.rules_cell import CELL_RULES
from warpdem.input.rules_contact import attraction, dashpot, laws_of_their_own, programs
from warpdem.input.rules_driver import DRIVER_RULES
from warpdem.input.rules_force import forces
from warpdem.input.rules_guards import GUARD_RULES
from warpdem.input.rules_method import METHOD_RULES
from warpdem.input.rules_release import RULES as RELEASE_RULES
from warpdem.input.rules_rockfall import ROCKFALL_RULES
from warpdem.input.rules_sleep import SLEEP_RULES
from warpdem.input.rules_surface import containers, surfaces_stand
from warpdem.input.scene_reading import Fault, entries, given, number, numbers, read, tables, text
from warpdem.input.scene_references import (
    contact_pairs,
    densities,
    known_shapes,
    terrain_stands,
    unique_names,
)
from warpdem.input.scene_run import PROGRAMS, Numerics


def rolling(scene: Any) -> Iterator[Fault]:
    """Rolling resistance has a stiffness and a cap."""
    for index, contact in tables(scene, "contact"):
        kr, mur = number(contact, "kr") or 0.0, number(contact, "mur") or 0.0
        if kr > 0.0 and not given(contact, "mur"):
            yield Fault(("contact", index, "kr"), kr, "needs mur, the cap of the rolling moment")
        if mur > 0.0 and not kr:
            yield Fault(("contact", index, "mur"), mur, "has no effect without kr > 0")


def compatibility(scene: Any) -> Iterator[Fault]:
    """What ``compat`` sets is not set otherwise."""
    run = read(scene, "run")
    if not (isinstance(run, Mapping) or hasattr(run, "model_fields_set")):
        return
    compat = read(run, "compat")
    if compat != "rockable" and read(run, "list_distance") is not None:
        value = read(run, "list_distance")
        yield Fault(("run", "list_distance"), value, 'only with compat = "rockable"')
    if not isinstance(compat, str) or compat not in PROGRAMS:
        return
    for key in Numerics.model_fields:
        value = getattr(PROGRAMS[compat], key)
        if given(run, key) and read(run, key) != value:
            rule = f'compat = "{compat}" sets "{value}": leave one of the two out'
            yield Fault(("run", key), read(run, key), rule)


def clock(scene: Any) -> Iterator[Fault]:
    """A step fits into the run and between frames."""
    run = read(scene, "run")
    dt, duration = number(run, "dt"), number(run, "duration")
    every = number(read(scene, "output"), "every")
    limits = {"run.duration": duration, "output.every": every}
    for name, limit in limits.items():
        if dt and limit and dt > limit > 0.0:
            yield Fault(("run", "dt"), dt, f"longer than {name} = {limit:g}")


def boxes(scene: Any) -> Iterator[Fault]:
    """A box is at least as thick as its rounding makes it."""
    for index, shape in tables(scene, "shape"):
        size, rounding = numbers(shape, "size", 3), number(shape, "rounding")
        if size and rounding and rounding > min(size) / 2.0 > 0.0:
            rule = f"must be at most half the smallest size, {min(size) / 2.0:g}"
            yield Fault(("shape", index, "rounding"), rounding, rule)


def declared_mass(scene: Any) -> Iterator[Fault]:
    """Declared volume and inertia come together, and belong to some solid."""
    keys = ("volume", "inertia_over_mass")
    for index, shape in tables(scene, "shape"):
        present = [key for key in keys if read(shape, key) is not None]
        if len(present) == 1:
            other = keys[1 - keys.index(present[0])]
            rule = f"declared without {other}: give both or neither"
            yield Fault(("shape", index, present[0]), read(shape, present[0]), rule)
        moments = numbers(shape, "inertia_over_mass", 3)
        # The moments of a flat plate are equal to the bound: allow for their rounding.
        if moments and max(moments) > (sum(moments) - max(moments)) * (1.0 + 1e-9):
            rule = "no solid has a principal moment larger than the two others together"
            yield Fault(("shape", index, keys[1]), moments, rule)


def polyhedra(scene: Any) -> Iterator[Fault]:
    """Faces and edges join different vertices that exist."""
    for index, shape in tables(scene, "shape"):
        count = len(entries(shape, "vertices"))
        for key in ("faces", "edges"):
            for place, loop in enumerate(entries(shape, key)):
                corners = [c for c in loop if isinstance(c, int)] if _is_list(loop) else []
                rule = _wrong_loop(corners, count)
                if count and rule:
                    yield Fault(("shape", index, key, place), list(corners), rule)


def _is_list(value: Any) -> bool:
    return isinstance(value, list | tuple)


def _wrong_loop(corners: list[int], count: int) -> str:
    if any(corner >= count for corner in corners):
        return f"names a vertex beyond the last, number {count - 1}"
    return "" if len({*corners}) == len(corners) else "names a vertex twice"


def fills(scene: Any) -> Iterator[Fault]:
    """A fill says how many, of what, and where."""
    for index, fill in tables(scene, "fill"):
        shapes, weights = entries(fill, "shapes"), entries(fill, "weights")
        if weights and len(weights) != len(shapes):
            rule = f"must have one weight for each of the {len(shapes)} shapes"
            yield Fault(("fill", index, "weights"), list(weights), rule)
        if read(fill, "count") is None:
            if text(fill, "kind") == "random":
                yield Fault(("fill", index, "count"), None, 'missing: kind = "random" needs it')
            if read(fill, "must_fit") is True:
                yield Fault(("fill", index, "must_fit"), None, "needs count: how many must fit?")
        if text(fill, "kind") == "random" and number(fill, "spacing"):
            rule = 'only kind = "lattice" has a spacing'
            yield Fault(("fill", index, "spacing"), read(fill, "spacing"), rule)


def regions(scene: Any) -> Iterator[Fault]:
    """A region has a length, a width and a height."""
    for index, fill in tables(scene, "fill"):
        low, high = (numbers(read(fill, "region"), key, 3) for key in ("min", "max"))
        if low and high and any(a >= b for a, b in zip(low, high, strict=True)):
            rule = f"must exceed region.min = {low} along every axis"
            yield Fault(("fill", index, "region", "max"), high, rule)


def sizes(scene: Any) -> Iterator[Fault]:
    """A distribution's mean lies between its bounds."""
    for index, fill in tables(scene, "fill"):
        size = read(fill, "size")
        low, mean, high = (number(size, key) for key in ("min", "mean", "max"))
        path = ("fill", index, "size")
        if low and high and low > high:
            yield Fault((*path, "max"), high, f"must be at least min = {low:g}")
        elif low and high and mean and not low <= mean <= high:
            rule = f"must lie between min = {low:g} and max = {high:g}"
            yield Fault((*path, "mean"), mean, rule)


RULES = (
    unique_names,
    known_shapes,
    densities,
    terrain_stands,
    surfaces_stand,
    containers,
    contact_pairs,
    forces,
    rolling,
    dashpot,
    attraction,
    laws_of_their_own,
    programs,
    compatibility,
    clock,
    boxes,
    declared_mass,
    polyhedra,
    fills,
    regions,
    sizes,
    *CELL_RULES,
    *DRIVER_RULES,
    *BOND_RULES,
    *METHOD_RULES,
    *SLEEP_RULES,
    *GUARD_RULES,
    *ROCKFALL_RULES,
    *RELEASE_RULES,
)


def consistency(scene: Any) -> list[Fault]:
    """All faults between the keys of a `Scene`, or of the raw tables of one."""
    return [fault for rule in RULES for fault in rule(scene)]
