"""A case's physics, free of any program: bodies, walls, law and step, given to every engine."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from math import log, pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Law:
    """One linear contact law for all contacts, friction with a spring that remembers.

    Attributes:
        kn, kt: Stiffnesses [N/m].
        en2: Energy kept by a rebound [-].
        mu: Friction coefficient [-].
    """

    kn: float = 1e6
    kt: float = 8e5
    en2: float = 0.1
    mu: float = 0.5

    @property
    def damping_ratio(self) -> float:
        """Of the linear oscillator that rebounds so, 1 is critical."""
        rate = -0.5 * log(self.en2)
        return rate / sqrt(rate**2 + pi**2)


@dataclass(frozen=True)
class Wall:
    """A fixed plane; the solid lies behind its unit normal."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class Solid:
    """The shape of all free bodies.

    Attributes:
        kind: "sphere", "cube" or "octahedron".
        size: Diameter, edge or corner-to-corner length, rounding included [m].
        rounding: Minkowski radius [m]; of a sphere its radius.
    """

    kind: str
    size: float
    rounding: float

    @property
    def volume(self) -> float:
        """Of the rounded solid [m^3]."""
        return _volume(*self._core(), self.rounding)

    def _core(self) -> tuple[float, float, float]:
        """Volume, area and mean width (times 2 pi) of the sharp core."""
        if self.kind == "sphere":
            return 0.0, 0.0, 0.0
        if self.kind == "cube":
            a = self.size - 2.0 * self.rounding
            return a**3, 6.0 * a**2, 3.0 * pi * a
        edge = (self.size - 2.0 * self.rounding) / sqrt(2.0)
        bend = pi - np.arccos(-1.0 / 3.0)
        return sqrt(2.0) / 3.0 * edge**3, 2.0 * sqrt(3.0) * edge**2, 6.0 * edge * float(bend)

    @property
    def bound(self) -> float:
        """Radius of the sphere about it [m]."""
        if self.kind == "cube":
            return sqrt(3.0) * (0.5 * self.size - self.rounding) + self.rounding
        return 0.5 * self.size


def _volume(core: float, area: float, bend: float, rounding: float) -> float:
    """Steiner's formula."""
    return core + area * rounding + bend * rounding**2 + 4.0 / 3.0 * pi * rounding**3


@dataclass(frozen=True, eq=False)
class Problem:
    """Equal bodies among walls.

    Attributes:
        name: Of the case and size, for files.
        solid: Shape of the bodies.
        position: Centres [m], shape [body_count, 3].
        orientation: Unit quaternions w, x, y, z, body to world, shape [body_count, 4].
        walls: Fixed planes.
        law: Of all contacts.
        dt: Step [s].
        density: [kg/m^3].
        gravity: [m/s^2].
    """

    name: str
    solid: Solid
    position: FloatArray
    orientation: FloatArray
    walls: tuple[Wall, ...]
    law: Law = field(default_factory=Law)
    dt: float = 1e-4
    density: float = 2500.0
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)

    @property
    def count(self) -> int:
        """Number of free bodies."""
        return len(self.position)

    @property
    def mass(self) -> float:
        """Of one body [kg]."""
        return self.density * self.solid.volume

    def dashpot(self, *, wall: bool) -> float:
        """Of a contact between two bodies, or of one with a wall [N s/m]."""
        effective = self.mass if wall else 0.5 * self.mass
        return 2.0 * self.law.damping_ratio * sqrt(self.law.kn * effective)

    def at(self, position: FloatArray, orientation: FloatArray) -> Problem:
        """The same with its bodies elsewhere."""
        return replace(self, position=position, orientation=orientation)

    def stepped(self, dt: float) -> Problem:
        """The same with another step [s]."""
        return replace(self, dt=dt)

    def as_dict(self) -> dict[str, Any]:
        """For JSON, with what engines ask for besides."""
        plain = asdict(replace(self, position=np.zeros((0, 3)), orientation=np.zeros((0, 4))))
        plain |= {"position": self.position.tolist(), "orientation": self.orientation.tolist()}
        derived = {"mass": self.mass, "damping_ratio": self.law.damping_ratio}
        derived |= {f"dashpot_{k}": self.dashpot(wall=k == "wall") for k in ("pair", "wall")}
        return plain | derived | {"volume": self.solid.volume}

    def write(self, file: Path, **more: Any) -> None:
        """As JSON for an engine that runs in a process of its own."""
        file.write_text(json.dumps(self.as_dict() | more), encoding="utf-8")
