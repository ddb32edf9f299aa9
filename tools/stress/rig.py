"""What the stress scenes share: reading a scene file with changes, and figures with their gates."""

from __future__ import annotations

import re
import sys
import tomllib
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))

from warpdem.precision import bind  # noqa: E402 - after the path

if "mixed" in sys.argv:
    bind("mixed")  # before anything imports the kernels

from warpdem.converting.toml import toml  # noqa: E402 - the same
from warpdem.errors import WarpdemError  # noqa: E402 - the same
from warpdem.input.decode import loads  # noqa: E402 - the same
from warpdem.input.overrides import apply  # noqa: E402 - the same
from warpdem.simulation import Simulation  # noqa: E402 - the same

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.input.scene import Scene
    from warpdem.snapshot import Snapshot

SCENES = HERE / "scenes"


@dataclass(frozen=True)
class Figure:
    """One measured number of a scene and what it must stay below.

    Attributes:
        metric: What was measured, with its unit.
        value: What came out.
        gate: It passes up to this.
        note: What a reader should know of it.
    """

    metric: str
    value: float
    gate: float
    note: str = ""

    @property
    def passes(self) -> bool:
        """Whether it is a number within its gate."""
        return isfinite(self.value) and self.value <= self.gate


@dataclass(frozen=True)
class Way:
    """How the scenes are run.

    Attributes:
        short: In a few seconds, for continuous integration.
        precision: Of the runs, "float64" or "mixed".
    """

    short: bool = False
    precision: str = "float64"

    @property
    def mixed(self) -> bool:
        """Whether geometry and forces are of single precision."""
        return self.precision == "mixed"

    def pick(self, full: Any, short: Any) -> Any:
        """One of two, by the length of the run."""
        return short if self.short else full

    def gate(self, double: float, mixed: float) -> float:
        """One of two gates, by the precision."""
        return mixed if self.mixed else double

    def scene(
        self, name: str, *changes: str, drop: str = "", **more: list[dict[str, Any]]
    ) -> Scene:
        """A scene file with keys set, as by --set, and tables added to its lists.

        ``drop`` is a key of all contacts that another one stands for.
        """
        path = SCENES / f"{name}.toml"
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        if self.mixed:
            changes = (*changes, 'run.precision="mixed"')
        for change in changes:
            data, _ = apply(change, data)
        for law in data.get("contact", []):
            law.pop(drop, None)
        for key, tables in more.items():
            data[key] = [*data.get(key, []), *tables]
        # as the program reads it, so that it says what is wrong in its own words
        return loads(toml(data, [], {}), str(path)).located(path)

    def simulation(self, name: str, *changes: str, threads: int = 1, **more: Any) -> Simulation:
        """The bodies of a scene file, ready to move."""
        return Simulation(self.scene(name, *changes, **more), device="cpu", threads=threads)


def shots(simulation: Simulation, times: Sequence[float]) -> Iterator[Snapshot]:
    """Snapshots at some times [s]."""
    for time in times:
        simulation.advance(float(time))
        yield simulation.snapshot(contacts=True)


def normal_forces(shot: Snapshot, kn: dict[tuple[int, int], float]) -> dict[tuple[int, int], float]:
    """Elastic normal force of each body pair by its overlaps, sum of kn d [N].

    Args:
        shot: With contacts.
        kn: Stiffness of each body pair, the lower number first [N/m].
    """
    assert shot.contacts
    carried = dict.fromkeys(kn, 0.0)
    for (i, j), gap in zip(shot.contacts.bodies.tolist(), shot.contacts.gap, strict=True):
        pair = (min(i, j), max(i, j))
        carried[pair] += kn[pair] * max(-float(gap), 0.0)
    return carried


def speed(shot: Snapshot, size: float) -> float:
    """Greatest speed of any point of any body about so far from its centre [m/s]."""
    moving = np.linalg.norm(shot.velocity, axis=1) + size * np.linalg.norm(shot.spin, axis=1)
    return float(moving.max(initial=0.0))


def unclean(shot: Snapshot) -> float:
    """How many numbers of a state are not finite."""
    parts = (shot.position, shot.orientation, shot.velocity, shot.spin, shot.force, shot.torque)
    return float(sum(np.count_nonzero(~np.isfinite(part)) for part in parts))


def turn(q: np.ndarray, other: np.ndarray) -> float:
    """Angle between two orientations w, x, y, z [rad]."""
    w = q @ other
    across = np.linalg.norm(q - np.copysign(1.0, w) * other)
    return float(4.0 * np.arcsin(min(0.5 * across, 1.0)))


def refusal(run: Any) -> str:
    """Message of the named error that a call ends with; empty where it ends without one."""
    try:
        run()
    except WarpdemError as error:
        return re.sub(r"\s+", " ", str(error))
    return ""
