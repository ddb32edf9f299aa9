"""What a term costs: not in the scene, in it but never used, in use; and the trajectory it leaves.

A term is compiled into the kernels when something in the scene has it. Here that is a fixed body
far away ("idle"), whose law with the others has the term: it is compiled in and never used, so that
the other bodies must move the same to the last bit. Without the term that body is there as well.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from speed import scenes
from speed.packings import worker
from speed.problem import Law
from speed.report import Cell, Table

if TYPE_CHECKING:
    from collections.abc import Iterable

    from speed.packings import Folder
    from speed.problem import Problem

SEPARATE = "separate"
"""Arithmetic in which what a scene does not use changes no bit."""

COLUMNS = (
    "scene",
    "term",
    "without [ns]",
    "in, unused",
    "in use",
    "same trajectory",
    "compiled in by it",
)
AWAY = "position = [0.5, 0.5, 40.0]"
IDLE_BODY = f'[[body]]\nshape = "idle"\ngroup = "idle"\nfixed = true\n{AWAY}'
IDLE_SPHERE = '[[shape]]\nname = "idle"\nkind = "sphere"\nradius = 0.05'
IDLE_BOX = '[[shape]]\nname = "idle"\nkind = "box"\nsize = [0.1, 0.1, 0.1]'
LOSSLESS = Law(en2=1.0)
SMOOTH = Law(mu=0.0, kt=0.0)
NOT_HELD = "1e3"
"""Far above any speed or spin [m/s, rad/s]; to its 200th power a barrier is exactly one."""


@dataclass(frozen=True)
class Term:
    """A term in three scenes.

    Attributes:
        name: In the table.
        law: Of all contacts in the scene without the term.
        idle: Lines of the idle body's law when the term is in, unused.
        unused: Sections of the scene when it is in, unused.
        idle_law, idle_shape, idle_body: The idle body's own, when it is in, unused.
        used: Lines of the laws when it is in use; None: it is not timed so.
        use: Sections of the scene when it is in use.
        used_law: Of all contacts when it is in use.
        open_sides: The first wall alone is there, the floor.
    """

    name: str
    law: Law = field(default_factory=Law)
    idle: str = ""
    unused: str = ""
    idle_law: Law | None = None
    idle_shape: str = IDLE_SPHERE
    idle_body: str = IDLE_BODY
    used: str | None = ""
    use: str = ""
    used_law: Law | None = None
    open_sides: bool = False

    def scenes(self, problem: Problem) -> dict[str, str]:
        """Texts without it, with it unused and with it in use."""
        walls = problem.walls[:1] if self.open_sides else problem.walls
        plain = replace(problem, law=self.law, walls=walls)
        here = _idle(self.law)
        there = _idle(self.idle_law or self.law, self.idle, self.idle_shape, self.idle_body)
        found = {
            "without": scenes.text(plain, extra=here, arithmetic=SEPARATE),
            "unused": scenes.text(plain, extra=f"{there}\n{self.unused}", arithmetic=SEPARATE),
        }
        if self.used is not None:
            busy = replace(plain, law=self.used_law or self.law)
            more = f"{here}\n{self.use}"
            found["used"] = scenes.text(busy, law=self.used, extra=more, arithmetic=SEPARATE)
        return found


def _idle(law: Law, more: str = "", shape: str = IDLE_SPHERE, body: str = IDLE_BODY) -> str:
    return "\n".join(['[[group]]\nname = "idle"', shape, body, scenes.contact(law, "idle", more)])


def law_term(name: str, lines: str) -> Term:
    """A term that is some lines of a law."""
    return Term(name, idle=lines, used=lines)


def force_term(name: str, lines: str) -> Term:
    """A force on bodies, unused when it acts on the idle group alone."""
    force = f'[[force]]\nkind = "{name}"\n{lines}'
    return Term(name, unused=f'{force}\ngroups = ["idle"]', use=force)


def _barrier(name: str) -> Term:
    force = '[[force]]\nkind = "velocity_barrier"\n'
    unused = f"{force}{name} = {NOT_HELD}\n{name}_exponent = 200.0"
    return Term(f"{name} barrier", unused=unused, use=f"{force}{name} = 50.0")


CELL = """[cell]
size = [200.0, 200.0, 100.0]
origin = [-100.0, -100.0, -20.0]
periodic = [true, true, false]
"""
TERMS = (
    Term("friction", SMOOTH, idle_law=Law(), used_law=Law()),
    Term("friction, mu = 0 given", SMOOTH, idle_law=Law(mu=0.0), used=None),
    Term("damping", LOSSLESS, idle_law=Law(), used_law=Law()),
    law_term("rolling", "kr = 100.0\nmur = 0.001"),
    law_term("cohesion", "fc = 0.5"),
    law_term("cohesion at a distance", "fc = 0.5\ndncut = 0.002"),
    law_term("adhesion", "gamma = 0.5"),
    force_term("drag", "coefficient = 0.01"),
    _barrier("velocity"),
    _barrier("spin"),
    Term("numerical damping", use='[[force]]\nkind = "numerical_damping"\ncoefficient = 0.1'),
    Term("periodic cell", unused=CELL, used=None, open_sides=True),
    Term("moving wall", idle_body=f"{IDLE_BODY}\nvelocity = [0.0, 0.0, 0.01]", used=None),
    Term("polyhedra", idle_shape=IDLE_BOX, used=None),
)


def skips(folder: Folder, *, repeats: int = 3, names: Iterable[str] = ()) -> Table:
    """The table of all terms, or of those named, for spheres and for cubes."""
    wanted = set(names)
    problems = [
        (folder.settled(scenes.spheres(1000, 10, name="skips_spheres"), 8000), 4000),
        (folder.settled(scenes.cubes(216, 6, name="skips_cubes"), 6000), 2000),
    ]
    rows = [
        row(problem, term, steps, repeats)
        for problem, steps in problems
        for term in TERMS
        if not wanted or term.name in wanted
    ]
    note = (
        "CPU time per body and step on one thread, medians of alternating runs; unused and in use: "
        "relative to the scene without the term, paired"
    )
    return Table("Terms that a scene has or lacks", COLUMNS, tuple(rows), (note,))


def row(problem: Problem, term: Term, steps: int, repeats: int) -> tuple[Cell, ...]:
    """One term in one scene."""
    with tempfile.TemporaryDirectory() as place:
        files = {}
        for kind, text in term.scenes(problem).items():
            files[kind] = Path(place) / f"{kind}.toml"
            files[kind].write_text(text, encoding="utf-8")
        rounds = [
            {kind: timed(file, steps) for kind, file in files.items()} for _ in range(repeats)
        ]
        same = _same(*(file.with_suffix(".npz") for file in list(files.values())[:2]))
    plain = median(each["without"]["cpu"] for each in rounds)
    features = [set(rounds[0][kind]["features"]) for kind in ("without", "unused")]
    return (
        problem.solid.kind,
        term.name,
        1e9 * plain / (steps * problem.count),
        _ratio(rounds, "unused"),
        _ratio(rounds, "used") if "used" in files else None,
        "yes" if same else "NO",
        ", ".join(sorted(features[1] - features[0])) or "nothing",
    )


def timed(scene: Path, steps: int) -> dict[str, Any]:
    """One run of a scene; its end is kept beside it."""
    return worker(scene, warm=200, steps=steps, save=scene.with_suffix(".npz"))


def _ratio(rounds: list[dict[str, dict[str, Any]]], kind: str) -> float:
    return median(each[kind]["cpu"] / each["without"]["cpu"] for each in rounds)


def _same(one: Path, other: Path) -> bool:
    """Whether two states are equal to the last bit."""
    with np.load(one) as a, np.load(other) as b:
        return all(np.array_equal(a[name], b[name]) for name in ("position", "orientation"))
