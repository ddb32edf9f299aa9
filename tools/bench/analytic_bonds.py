"""Reference family of a cantilever of bonded cubes: statics, modes, loads at which it fails.

Loads are masses in a field of gravity so weak that the beam stays straight; deflections, forces and
extensions of the loaded beam less those of the unloaded one, scaled to the reference's load.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from analytic_row import Row, compared
from beams import Beam, root_force

if TYPE_CHECKING:
    from collections.abc import Iterator

Case = dict[str, Any]
STRAIGHT = 1e-4
"""Largest deflection, in lengths of the beam: what is not linear is its square."""
MODES = 3


def bonded_cantilever(cases: list[Case], _: object) -> Iterator[Row]:
    for case in cases:
        p = case["params"]
        stiffness = p["kn_per_vertex_bond"], p["kt_per_vertex_bond"]
        beam = Beam(p["N"], p["cube"], *stiffness, p["density"])
        yield from _statics(case["id"], beam, p, case["expected"])
        yield from _modes(case["id"], beam, case["expected"])
        yield _tension(case["id"], beam, p, case["expected"])


def _statics(name: str, beam: Beam, p: Case, x: Case) -> Iterator[Row]:
    length = p["N"] * p["cube"]
    weak = p["g"] * min(1.0, STRAIGHT * length / x["tip_deflection_self_weight"])
    down, away = (0.0, 0.0, -weak), (weak, 0.0, 0.0)
    load = beam.mass
    scale = p["tip_load"] / (load * weak)

    def measure(shot: Any) -> np.ndarray:
        return np.append(beam.tip(shot), root_force(shot))

    own, loaded = (beam.at_rest(measure, gravity=down, load=mass) for mass in (0.0, load))
    bent = (loaded - own) * scale
    drawn = [beam.at_rest(beam.tip, gravity=away, load=mass)[0] for mass in (0.0, load)]
    failure = p["fn_max"] * p["tip_load"] / bent[3]
    for quantity, value in (
        ("tip_deflection_self_weight", -own[2] * p["g"] / weak),
        ("tip_deflection_end_load", -bent[2]),
        ("tip_extension_axial_load", (drawn[1] - drawn[0]) * scale),
        ("bending_failure_tip_load", failure),
    ):
        yield compared(name, quantity, value, x[quantity], gate=1e-4)


def _modes(name: str, beam: Beam, x: Case) -> Iterator[Row]:
    n, a = beam.count, beam.side
    omega, shapes = beam.bending()
    weights = np.repeat([beam.mass, beam.mass * a**2 / 6.0], n)
    got = [beam.frequency(shapes[:, k], weights, along=2, expected=omega[k]) for k in range(MODES)]
    yield compared(name, "omega_bending", got, x["omega_bending"], gate=5e-3)
    omega, shapes = beam.axial()
    first, last = (
        beam.frequency(shapes[:, k], weights, along=0, expected=omega[k]) for k in (0, n - 1)
    )
    yield compared(name, "omega_axial_first", first, x["omega_axial_first"], gate=5e-3)
    yield compared(name, "omega_axial_last", last, x["omega_axial_last"], gate=5e-3)
    speed = a * first / (2.0 * np.sin(np.pi / (2.0 * (2 * n + 1))))
    yield compared(name, "axial_wave_speed_long", speed, x["axial_wave_speed_long"], gate=5e-3)


def _tension(name: str, beam: Beam, p: Case, x: Case) -> Row:
    """A beam drawn evenly by its far end: every interface bears the same."""
    n, strain = beam.count + 1, p["fn_max"] / p["kn_per_vertex_bond"]
    speed = 1e-2 * strain * beam.axial()[0][-1] * n
    velocity = [[speed * k / n, 0.0, 0.0] for k in range(n + 1)]
    spin = [[0.0] * 3] * (n + 1)
    simulation = beam.run(motion=(velocity, spin), bond={"fn0": p["fn_max"]}, ends=1)
    simulation.advance(1.2 * strain * n / speed)
    broken = simulation.snapshot().breakage
    pull = speed / n * np.nanmin(broken.time)
    load = 4.0 * p["kn_per_vertex_bond"] * pull
    step = simulation.dt * speed / n / strain
    note = f"a step is {step:.0e} of it"
    return compared(
        name, "tension_failure_load", load, x["tension_failure_load"], gate=step, note=note
    )


FAMILIES = {"bonded_cantilever": bonded_cantilever}
