"""Rockable's reference runs, repeated: how far the bodies end up from where that program has them.

    python tools/bench/rockable.py [CASE ...] [--folder DIR] [--excerpt DIR]

Each case is its own input file, brought by ``convert``. First at equal dt with compat = "rockable":
every position over the whole run within 1e-9 m, or the figure GATES gives with its reason; the
first bond breaks in the same step. A packing is chaotic: its means must agree as those of the two
reference runs do. Then the default numerics at dt/8, with Rockable's law (its dashpot, its cap, its
unrotated friction), against the finest reference run, within twice the distance of that program's
own two runs. Exit status 1 if a case fails.

--excerpt writes definition and some rows of the cases into a folder; tests/peers/data was made so.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rockable_packing
from rockable_cases import FOLDER, chosen_cases, equal, excerpt, refined, verdict

from warpdem.geometry.orientation import product
from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from rockable_cases import Case

    from warpdem.arrays import FloatArray

REFINED = 8
"""How much smaller the step of the default numerics is."""


@dataclass(frozen=True)
class Gate:
    """How near the bodies stay to those of a case at equal dt, and why not nearer.

    Attributes:
        distance: [m].
        angle: [rad].
        until: Time up to which it holds [s].
        later: Largest distance from then on [m].
        reason: Why it is not that of all cases.
    """

    distance: float = 1e-9
    angle: float = 1e-8
    until: float = inf
    later: float = inf
    reason: str = ""


EQUAL = Gate()
GATES = {
    "cube_numdamp": Gate(
        2e-8, 2e-7, reason="rounding flips the sign of force times velocity (its README, fact 10)"
    ),
    "avalanche_cube_step": Gate(
        until=0.155,
        later=6.4e-4,  # what its own run changes at dt/4
        reason="rounding flips loading and unloading of four lasting contacts (fact 10)",
    ),
    "beam6_break": Gate(
        until=0.03912, reason="compared up to its first rupture (its README, fact 10)"
    ),
    **{
        f"tumbling_{name}": Gate(
            angle=inf, reason=f"position alone; {name}'s scheme of turning is not reproduced"
        )
        for name in ("Beeman", "Euler", "RungeKutta4")
    },
}
RUPTURES = {"beam6_break": 0.03912}
"""When the first bond of a case breaks in the reference [s]."""
UNREFINED = dict.fromkeys(
    ("beam6_elastic_damped", "outer_chain5_spheres"),
    "its dashpots add up to a stiffness that grows as dt falls (its README, fact 7)",
)
"""Cases whose reference has no limit as dt falls."""
BROKEN = "up to its first rupture: contacts that were bonds keep the bonds' dashpots in the program"


def compare(simulation: Simulation, rows: FloatArray) -> tuple[float, float]:
    """Largest distance [m] and angle [rad] of the bodies from those of a trajectory.

    Args:
        simulation: At its start.
        rows: Of `COLUMNS`, shape [row_count, 15].
    """
    distance = angle = 0.0
    for instant in np.unique(rows[:, 0]):
        simulation.advance(float(instant))
        now = simulation.snapshot()
        there = rows[rows[:, 0] == instant]
        body = there[:, 1].astype(int)
        away = now.position[body] - there[:, 2:5]
        distance = max(distance, float(np.linalg.norm(away, axis=1).max()))
        angle = max(angle, float(angles(now.orientation[body], there[:, 5:9]).max()))
    return distance, angle


def angles(first: FloatArray, second: FloatArray) -> FloatArray:
    """Angles between orientations [rad], shape [count]."""
    apart = product(first, second * np.array([1.0, -1.0, -1.0, -1.0]))
    return 2.0 * np.arctan2(np.linalg.norm(apart[:, 1:], axis=1), np.abs(apart[:, 0]))


def repeat(case: Case) -> bool:
    """Run a case at equal dt, print how far it gets from the reference; whether it passes."""
    if case.is_packing:
        return rockable_packing.repeat(case)
    gate = GATES.get(case.name, EQUAL)
    rows = case.trajectory()
    simulation = Simulation(equal(case), device="cpu", threads=1)
    begin = time.perf_counter()
    distance, angle = compare(simulation, rows[rows[:, 0] < gate.until])
    passes = distance <= gate.distance and angle <= gate.angle
    word = "PART" if passes and gate.angle == inf else verdict(passes)
    note = gate.reason
    if np.isfinite(gate.later):
        later, _ = compare(simulation, rows[rows[:, 0] >= gate.until])
        passes = passes and later <= gate.later
        note += f"; up to {gate.until:g} s, from then on {later:.1e} m"
    if case.name in RUPTURES:
        step, there = first_rupture(simulation), round(RUPTURES[case.name] / simulation.dt)
        passes = passes and step == there
        note += f"; the first bond breaks in step {step}, there in step {there}"
    spent = time.perf_counter() - begin
    theirs = case.definition["wall_s"][0]
    print(
        f"{case.name:28s} {distance:9.1e} {angle:9.1e}  {word} "
        f"{simulation.step_count:7d} {spent:8.2f} {theirs:8.2f}" + (f"  {note}" if note else ""),
        flush=True,
    )
    return passes


def first_rupture(simulation: Simulation) -> int:
    """The step in which the first interface breaks; the run goes on to the end."""
    simulation.advance(simulation.scene.run.duration)
    breakage = simulation.snapshot().breakage
    assert breakage is not None
    return int(breakage.step[~breakage.intact].min())


def refine(case: Case) -> bool:
    """Run a case with the default numerics at a finer dt and print its distance; as ``repeat``."""
    simulation = Simulation(refined(case, REFINED), device="cpu", threads=1)
    begin = time.perf_counter()
    until = RUPTURES.get(case.name, inf)
    rows = case.trajectory(case.finest)
    distance, angle = compare(simulation, rows[rows[:, 0] < until])
    spent = time.perf_counter() - begin
    own = case.definition["self_diff_vs_refined_dt"][str(case.finest)]
    near, turned = (max(2.0 * own[key], EQUAL.distance) for key in ("pos", "ang"))
    passes = distance <= near and angle <= turned
    print(
        f"{case.name:28s} {distance:9.1e} {own['pos']:9.1e} {angle:9.1e} {own['ang']:9.1e}  "
        f"{verdict(passes)} {spent:8.2f}" + (f"  {BROKEN}" if until < inf else ""),
        flush=True,
    )
    return passes


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", nargs="*", help="names of cases; default: all")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="of the cases")
    parser.add_argument("--excerpt", type=Path, help="folder for excerpts; nothing is run")
    asked = parser.parse_args()
    cases = chosen_cases(asked.folder, asked.case)
    if asked.excerpt:
        for case in cases:
            excerpt(case, asked.excerpt)
        return 0
    gate = f"{EQUAL.distance:g} m, {EQUAL.angle:g} rad"
    print(f"at equal dt; gate {gate}; seconds of one thread here and of the reference's run")
    print(f"{'case':28s} {'|dx| [m]':>9s} {'[rad]':>9s} {'steps':>13s} {'here':>8s} {'there':>8s}")
    passes = [repeat(case) for case in cases]
    print(f"\ndefault numerics at dt/{REFINED}; gate: twice the reference's own difference")
    print(f"{'case':28s} {'|dx| [m]':>9s} {'own':>9s} {'[rad]':>9s} {'own':>9s} {'seconds':>14s}")
    for case in cases:
        if case.name in UNREFINED:
            print(f"{case.name:28s} not demanded: {UNREFINED[case.name]}")
        elif not case.is_packing:
            passes.append(refine(case))
    return 0 if all(passes) else 1


if __name__ == "__main__":
    sys.exit(main())
