"""Rules that tie the periodic cell to the rest of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import (
    Fault,
    entries,
    given,
    number,
    numbers,
    read,
    tables,
    text,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

AXES = "xyz"
STILL = "a cell that does not deform (no strain_rate, no stress) has no use for it"


def cell_repeats(scene: Any) -> Iterator[Fault]:
    """A cell repeats itself along some axis."""
    if (cell := read(scene, "cell")) is not None and not any(periodic_axes(cell)):
        rule = "periodic along no axis: leave [cell] out"
        yield Fault(("cell", "periodic"), read(cell, "periodic"), rule)


def cell_control(scene: Any) -> Iterator[Fault]:
    """Components have a rate or a stress, between periodic axes; clocks run forward."""
    cell = read(scene, "cell")
    if cell is None:
        return
    rates, stresses = _rates(cell), _stresses(cell)
    periodic = periodic_axes(cell)
    for a, b in sorted({*rates, *stresses}):
        name = AXES[a] + AXES[b]
        key = "strain_rate" if (a, b) in rates else "stress"
        if not (periodic[a] and periodic[b]):
            rule = f"component {name} deforms the cell along an axis that is not periodic"
            yield Fault(("cell", key), None, rule)
        if (a, b) in rates and tuple(sorted((a, b))) in stresses:
            rule = f"component {name} has a rate and a stress: leave one of the two out"
            yield Fault(("cell", "stress"), None, rule)
    for key in ("inertia", "damping"):
        if read(cell, key) is not None and not stresses:
            yield Fault(("cell", key), read(cell, key), "only with stress")
    for key in ("start", "stop"):
        if not rates and not stresses and given(cell, key) and read(cell, key) is not None:
            yield Fault(("cell", key), read(cell, key), STILL)
    start, stop = number(cell, "start") or 0.0, number(cell, "stop")
    if stop is not None and stop <= start:
        yield Fault(("cell", "stop"), stop, f"must come after start = {start:g}")


def cell_bodies(scene: Any) -> Iterator[Fault]:
    """Nothing fixed stands in a cell that deforms; something holds what falls along it."""
    cell = read(scene, "cell")
    if cell is None:
        return
    fixed = [k for k, body in tables(scene, "body") if read(body, "fixed") is True]
    if fixed and (_rates(cell) or _stresses(cell)):
        rule = "nothing fixed can stand in a cell that deforms: walls would not follow it"
        yield Fault(("body", fixed[0], "fixed"), True, rule)
    gravity = read(scene, "gravity")
    pull = [0.0, 0.0, -9.81] if gravity is None else numbers(gravity, "vector", 3)
    along = [a for a, p in enumerate(periodic_axes(cell)) if p and pull and pull[a] != 0.0]
    if along and not fixed:
        rule = (
            f"gravity along the periodic axis {AXES[along[0]]} and nothing fixed to hold the "
            f"bodies: they would fall for ever; set gravity.vector = [0, 0, 0], or "
            f"cell.periodic = false along it"
        )
        path = ("cell", "periodic") if gravity is None else ("gravity", "vector")
        yield Fault(path, pull if gravity is not None else None, rule)


def cell_fills(scene: Any) -> Iterator[Fault]:
    """A fill stays inside the cell along its periodic axes."""
    cell = read(scene, "cell")
    size = numbers(cell, "size", 3) if cell is not None else None
    if not size:
        return
    origin = numbers(cell, "origin", 3) or [0.0, 0.0, 0.0]
    for index, fill in tables(scene, "fill"):
        region = read(fill, "region")
        low, high = numbers(region, "min", 3), numbers(region, "max", 3)
        for a, periodic in enumerate(periodic_axes(cell)):
            slack = 1e-9 * size[a]
            if not (periodic and low and high):
                continue
            end = origin[a] + size[a]
            if low[a] < origin[a] - slack or high[a] > end + slack:
                rule = (
                    f"reaches out of the periodic cell, which goes from {origin[a]:g} to {end:g} "
                    f"along {AXES[a]}"
                )
                yield Fault(("fill", index, "region"), None, rule)


def periodic_axes(cell: Any) -> list[bool]:
    """Along which axes a cell repeats itself."""
    axes = entries(cell, "periodic")
    return [axis is True for axis in axes] if len(axes) == 3 else [True] * 3


def _rates(cell: Any) -> list[tuple[int, int]]:
    rows = entries(cell, "strain_rate")
    return [
        (a, b)
        for a, row in enumerate(rows)
        if isinstance(row, list | tuple)
        for b, rate in enumerate(row)
        if a < 3 and b < 3 and rate != 0.0
    ]


def _stresses(cell: Any) -> list[tuple[int, int]]:
    stress = read(cell, "stress")
    names = [a + b for a in AXES for b in AXES if a <= b]
    return [
        (AXES.index(name[0]), AXES.index(name[1]))
        for name in names
        if stress is not None and number(stress, name) is not None
    ]


def cell_company(scene: Any) -> Iterator[Fault]:
    """What knows nothing of images, or of the flow of a cell that deforms."""
    cell = read(scene, "cell")
    if cell is None:
        return
    for index, force in tables(scene, "force"):
        if text(force, "kind") == "fluid":
            rule = "a grid of velocities is not repeated with the periodic cell: use drag"
            yield Fault(("force", index, "kind"), "fluid", rule)
    if not (_rates(cell) or _stresses(cell)):
        return
    for index, force in tables(scene, "force"):
        if text(force, "kind") != "fluid":
            rule = (
                "sees velocities, which in a cell that deforms differ between images of a body: "
                "leave out strain_rate and stress, or the force"
            )
            yield Fault(("force", index, "kind"), text(force, "kind"), rule)
    for index, _ in tables(scene, "bond"):
        rule = (
            "bonds do not enter the stress that a deforming cell follows: leave out strain_rate "
            "and stress, or the bonds"
        )
        yield Fault(("bond", index), None, rule)


CELL_RULES = (cell_repeats, cell_control, cell_bodies, cell_fills, cell_company)
