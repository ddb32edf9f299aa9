"""What a Rockable conf file says, before anything is made of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from warpdem.errors import Problem

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.converting.words import Place


Groups = tuple[int, int]

DEFAULTS: dict[str, float] = {
    "t": 0.0,
    "tmax": 1.0,
    "dt": 1e-6,
    "interVerlet": 0.01,
    "interConf": 0.25,
    "dVerlet": 0.0,
    "numericalDampingCoeff": 0.0,
    "VelocityBarrier": 0.0,
    "AngularVelocityBarrier": 0.0,
    "VelocityBarrierExponent": 1.0,
    "AngularVelocityBarrierExponent": 1.0,
    "usePeriodicCell": 0.0,
}
"""Numbers of the program that a file need not give."""


@dataclass
class Particle:
    """A body as the file gives it.

    Attributes:
        shape: Name within the shape library.
        group: Number of its material.
        cluster: Number of the cluster it is part of.
        homothety: Its size over that of its shape.
        position: [m].
        velocity: [m/s].
        orientation: Quaternion w, x, y, z.
        spin: [rad/s].
        place: Where it stands.
    """

    shape: str
    group: int
    cluster: int
    homothety: float
    position: tuple[float, ...]
    velocity: tuple[float, ...]
    orientation: tuple[float, ...]
    spin: tuple[float, ...]
    place: Place


@dataclass(frozen=True)
class Command:
    """A command that glues bodies or changes their bonds.

    Attributes:
        name: Its keyword.
        values: What follows it.
        place: Where it stands.
    """

    name: str
    values: tuple[float | str, ...]
    place: Place


@dataclass
class Conf:
    """The content of a conf file.

    Attributes:
        path: The file.
        numbers: Settings that are one number, by keyword.
        gravity: [m/s^2].
        law: Name of the force law.
        partnership: Name of the rule that shares stiffness among contacts.
        shape_file: As written; empty when none is named.
        driven: How many of the first bodies are driven.
        glue_walls: Bonds with driven bodies too.
        cell: Columns of the periodic cell, row by row; velocity, likewise.
        density: By group [kg/m^3].
        tables: Parameters of pairs of groups (smaller number first) by keyword.
        particles: The bodies.
        commands: Those on bonds, in the order of the file.
        places: Where a keyword stands first.
        unused: Settings of the program's own lists and files, as written.
        notes: What has no counterpart, with the reason.
        problems: What is wrong.
    """

    path: Path
    numbers: dict[str, float] = field(default_factory=lambda: dict(DEFAULTS))
    gravity: tuple[float, ...] = (0.0, -9.81, 0.0)
    law: str = "Default"
    partnership: str = "None"
    shape_file: str = ""
    driven: int = 0
    glue_walls: bool = False
    cell: dict[str, tuple[float, ...]] = field(default_factory=dict)
    density: dict[int, float] = field(default_factory=dict)
    tables: dict[str, dict[Groups, float]] = field(default_factory=dict)
    particles: list[Particle] = field(default_factory=list)
    commands: list[Command] = field(default_factory=list)
    places: dict[str, Place] = field(default_factory=dict)
    unused: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    @property
    def step_count(self) -> int:
        """Steps the program does: until the first time at or past tmax, but for rounding."""
        steps = (self.numbers["tmax"] - self.numbers["t"]) / self.numbers["dt"]
        return int(-(-(steps - 1e-6) // 1.0))

    def note(self, place: Place | None, message: str) -> None:
        """Tell of something that has no counterpart."""
        self.notes.append(f"{place}  {message}" if place else message)

    def fault(self, place: Place | None, message: str) -> None:
        """Tell of something that is wrong."""
        problem = place.problem(message) if place else Problem(str(self.path), "", message)
        self.problems.append(problem)

    def pair(self, keyword: str, first: int, second: int) -> float | None:
        """A parameter of two groups; None when the file does not give it."""
        return self.tables.get(keyword, {}).get((min(first, second), max(first, second)))
