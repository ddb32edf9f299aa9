"""Rules on guards, on bodies pushed apart at the start, and on steps that adapt."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, read, tables, text

if TYPE_CHECKING:
    from collections.abc import Iterator

FOLLOWING = ("control", "pressure")
"""Drivers that follow a force."""


def energy_is_known(scene: Any) -> Iterator[Fault]:
    """What watches the energies needs their account."""
    guard = read(read(scene, "run"), "energy_guard")
    if guard is not None and read(read(scene, "output"), "energy") is False:
        rule = "needs the account of energies: set output.energy = true, or leave this out"
        yield Fault(("run", "energy_guard"), None, rule)


def relaxed_alone(scene: Any) -> Iterator[Fault]:
    """Bonds are made where bodies are; compat reproduces runs as they are."""
    run = read(scene, "run")
    if read(run, "relax") is None:
        return
    if entries(scene, "bond"):
        rule = "moves what [[bond]] holds together: leave one of the two out"
        yield Fault(("run", "relax"), None, rule)
    if read(scene, "cell") is not None:
        rule = "not in a periodic cell: leave out [cell] or this"
        yield Fault(("run", "relax"), None, rule)
    if text(run, "compat") not in {None, "none"}:
        rule = "not with run.compat, which starts as its program does: leave one of the two out"
        yield Fault(("run", "relax"), None, rule)


def adaptive_alone(scene: Any) -> Iterator[Fault]:
    """A step grows where contacts alone bound it."""
    run = read(scene, "run")
    if read(run, "adaptive_dt") is not True:
        return
    path = ("run", "adaptive_dt")
    if text(run, "compat") not in {None, "none"}:
        yield Fault(path, True, "run.compat has one step for all: leave one of the two out")
    for name in ("cell", "bond", "force"):
        if read(scene, name) is not None and (name == "cell" or entries(scene, name)):
            shown = "[cell]" if name == "cell" else f"[[{name}]]"
            yield Fault(path, True, f"not with {shown}, which bounds the step too: leave one out")
    for index, driver in tables(scene, "driver"):
        if text(driver, "kind") in FOLLOWING:
            rule = f"not with driver[{index}], which follows a force: leave one of the two out"
            yield Fault(path, True, rule)


GUARD_RULES = (energy_is_known, relaxed_alone, adaptive_alone)
