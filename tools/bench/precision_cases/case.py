"""What a case is: bodies, a time, what is measured there, and what should be."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

Scene = dict[str, Any]


@dataclass(frozen=True)
class Case:
    """One diagram.

    Attributes:
        name: For the command line and files.
        what: What happens, and what the error is, in a line.
        until: When it is measured [s].
        steps: Ladder of numbers of steps until then, coarse to fine.
        settings: Names of the settings that apply.
        scene: Makes the scene, without its clock and numerics.
        measured: Of a snapshot at the end: what is compared, shape [copies, ...].
        unit: What errors are divided by.
        exact: What should be measured, by the law ("own" or another); None: a run of the default
            scheme with ``finer`` times as many steps as the finest.
        finer: See ``exact``.
        typical: How the errors of all copies become one.
        prepared: Makes a run of something that is no scene of the smooth method, from numerics and
            number of steps; see worker.
        programs: Other programs that run the same; see peers.
        problem: What those programs need to know.
        seen: What is compared, of velocities, spins and positions, for those programs.
        rigid: What hard contacts should give, for programs that have such.
        hard: Makes a run of the nonsmooth method, from numerics and number of steps.
        hard_steps: Its ladder.
    """

    name: str
    what: str
    until: float
    steps: tuple[int, ...]
    settings: tuple[str, ...]
    scene: Callable[[], Scene] | None = None
    measured: Callable[[Any], FloatArray] | None = None
    unit: float = 1.0
    exact: Callable[[str], FloatArray] | None = None
    finer: int = 8
    typical: Callable[[FloatArray], float] = field(default=lambda e: float(np.sqrt(np.mean(e**2))))
    prepared: Callable[[Mapping[str, Any], int], Any] | None = None
    programs: tuple[str, ...] = ()
    problem: Callable[[], Scene] | None = None
    seen: Callable[[FloatArray, FloatArray, FloatArray], FloatArray] | None = None
    rigid: Callable[[], FloatArray] | None = None
    hard: Callable[[Mapping[str, Any], int], Any] | None = None
    hard_steps: tuple[int, ...] = ()

    def ladder(self, law: str) -> tuple[int, ...]:
        """Numbers of steps, coarse to fine."""
        return self.hard_steps if law == "hard" else self.steps

    def error(self, values: Any, truth: Any) -> float:
        """One number for how far a run is off; infinite where it failed."""
        if values is None:
            return float("inf")
        off = np.asarray(values, float) - np.asarray(truth, float)
        size = np.linalg.norm(off.reshape(len(off), -1), axis=1)
        found = self.typical(size) / self.unit
        return found if np.isfinite(found) else float("inf")


SKIN = {"skin": 0.5}
"""Of lists: few bodies far apart, and some are fast."""


def scene_of(bodies: list[Scene], shapes: list[Scene], law: Scene, **more: Any) -> Scene:
    """A scene with one law, without gravity and account of energies unless ``more`` says so."""
    plain: Scene = {"gravity": {"vector": [0.0, 0.0, 0.0]}, "output": {"energy": False}}
    contact = [{"groups": ["default"] * 2, **law}]
    return {**plain, "shape": shapes, "body": bodies, "contact": contact, **more}


def lattice(count: int, apart: float) -> FloatArray:
    """So many places in a square, ``apart`` [m] from each other; shape [count, 2]."""
    side = int(np.ceil(np.sqrt(count)))
    k = np.arange(count)
    return apart * np.column_stack([k % side, k // side]).astype(float)


def random(seed: int) -> np.random.Generator:
    """The draws of a case."""
    return np.random.default_rng(seed)


def turns(count: int, generator: np.random.Generator) -> FloatArray:
    """Orientations w, x, y, z that are all equally likely; shape [count, 4]."""
    q = generator.normal(size=(count, 4))
    return q / np.linalg.norm(q, axis=1, keepdims=True)


GROUND = {"shape": "ground", "position": [0.0, 0.0, 0.0], "fixed": True}
PLANE = {"kind": "plane", "name": "ground"}
"""A fixed plane z = 0."""
G = 9.81
WEIGHT = {"vector": [0.0, 0.0, -G]}
