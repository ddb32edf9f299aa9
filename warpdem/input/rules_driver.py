"""Rules on the drivers of a scene."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from warpdem.driving.expression import ExpressionError, parse
from warpdem.input.scene_reading import Fault, Path, entries, given, number, read, tables, text
from warpdem.input.suggestions import did_you_mean

AXES = ("x", "y", "z")
TURNS = ("rx", "ry", "rz")
MOTIONS = {
    "constant": ("velocity", "spin"),
    "sine": ("translation", "rotation"),
    "expression": (*AXES, *TURNS),
}
"""Keys of which a driver needs one, by its kind."""


def driven_bodies(scene: Any) -> Iterator[Fault]:
    """Drivers move bodies there are, and that are fixed; pressures act between such."""
    fixed = {
        text(body, "name") or f"body[{index}]": read(body, "fixed") is True
        for index, body in tables(scene, "body")
    }
    for index, driver in tables(scene, "driver"):
        path = ("driver", index)
        named = entries(driver, "bodies")
        for place, name in enumerate(named):
            yield from _named(name, (*path, "bodies", place), fixed, moved=True)
            if name in named[:place]:
                yield Fault((*path, "bodies", place), name, "is named twice")
        for row, pair in enumerate(entries(driver, "between")):
            for place, name in enumerate(pair if isinstance(pair, Sequence) else ()):
                where = (*path, "between", row, place)
                yield from _named(name, where, fixed, moved=False)
                if name in named:
                    rule = "is pressed itself: the area lies between other walls"
                    yield Fault(where, name, rule)


def _named(name: Any, path: Path, fixed: dict[str, bool], *, moved: bool) -> Iterator[Fault]:
    if not isinstance(name, str) or not name:
        return
    if name not in fixed:
        known = sorted(fixed)
        hint = did_you_mean(name, known) or f"; there are: {', '.join(known[:12]) or 'none'}"
        yield Fault(path, name, f"no [[body]] has this name{hint}")
    elif moved and not fixed[name]:
        yield Fault(path, name, "moves freely: a driver needs a body with fixed = true")


def driver_times(scene: Any) -> Iterator[Fault]:
    """A driver stops after it starts; a ramp goes forward in time."""
    for index, driver in tables(scene, "driver"):
        start, stop = number(driver, "start") or 0.0, number(driver, "stop")
        if stop is not None and stop <= start:
            rule = f"must be later than start = {start:g}"
            yield Fault(("driver", index, "stop"), stop, rule)
        rows = [row for row in entries(driver, "ramp") if _is_row(row)]
        for place, (row, after) in enumerate(pairwise(rows)):
            if after[0] <= row[0]:
                rule = f"times must increase, this one is not after {row[0]:g}"
                yield Fault(("driver", index, "ramp", place + 1), list(after), rule)


def _is_row(row: Any) -> bool:
    return (
        isinstance(row, list | tuple)
        and len(row) == 2
        and all(isinstance(part, int | float) for part in row)
    )


def driver_motions(scene: Any) -> Iterator[Fault]:
    """A driver moves its bodies somehow; expressions are functions of t."""
    for index, driver in tables(scene, "driver"):
        kind = text(driver, "kind")
        keys = MOTIONS.get(kind or "", ())
        if keys and not any(_acts(read(driver, key)) for key in keys):
            rule = f"moves nothing: give it one of {', '.join(keys)}"
            yield Fault(("driver", index), None, rule)
        for key in (*AXES, *TURNS):
            formula = text(driver, key)
            if kind == "expression" and formula:
                try:
                    parse(formula)
                except ExpressionError as error:
                    yield Fault(("driver", index, key), formula, str(error))
        turning = {"constant": ("spin",), "sine": ("rotation",), "expression": TURNS}
        turns = turning.get(kind or "", ())
        if turns and read(driver, "point") and not any(_acts(read(driver, key)) for key in turns):
            rule = f"has no effect without {' or '.join(turns)}"
            yield Fault(("driver", index, "point"), read(driver, "point"), rule)


def _acts(value: Any) -> bool:
    """Whether a vector, or an expression, is not just zero."""
    if isinstance(value, str):
        return value.strip() not in {"", "0", "0.0"}
    return isinstance(value, list | tuple) and any(part != 0 for part in value)


def driver_forces(scene: Any) -> Iterator[Fault]:
    """What follows a force is not imposed too."""
    for index, driver in tables(scene, "driver"):
        if text(driver, "kind") != "control":
            continue
        path = ("driver", index)
        force, moment = _axes(driver, "force"), _axes(driver, "moment")
        if not force and not moment:
            rule = "follows no force: give it force or moment, say force = { z = -500.0 }"
            yield Fault(path, None, rule)
        for axis in sorted(force & _axes(driver, "velocity")):
            rule = f"force.{axis} moves it along this axis already: give one of the two"
            yield Fault((*path, "velocity", axis), read(read(driver, "velocity"), axis), rule)
        for axis in sorted(_axes(driver, "inertia") - moment):
            rule = f"has no effect without moment.{axis}"
            yield Fault((*path, "inertia", axis), read(read(driver, "inertia"), axis), rule)
        for axis in sorted(_axes(driver, "inertia")):
            value = number(read(driver, "inertia"), axis)
            if value is not None and value <= 0.0:
                yield Fault((*path, "inertia", axis), value, "must be greater than 0")
        wants = {"gravity": force, "damping": force, "spin_damping": moment}
        for key, axes in wants.items():
            if given(driver, key) and read(driver, key) and not axes:
                what = "moment" if key == "spin_damping" else "force"
                yield Fault((*path, key), read(driver, key), f"has no effect without {what}")


def _axes(driver: Any, key: str) -> set[str]:
    table = read(driver, key)
    return {axis for axis in AXES if read(table, axis) is not None}


DRIVER_RULES = (driven_bodies, driver_times, driver_motions, driver_forces)
