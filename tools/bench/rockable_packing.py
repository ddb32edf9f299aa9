"""Rockable's chaotic packing, repeated: its means beside those of the reference's two runs."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np
from rockable_cases import equal, read_columns, verdict

from warpdem.simulation import Simulation

if TYPE_CHECKING:
    from rockable_cases import Case

    from warpdem.arrays import FloatArray
    from warpdem.snapshot import Snapshot

SPREAD = 5.5
"""Half width of a packing's band, in root mean square differences of the two reference runs.

Nine of ten further runs lie within (Student's distribution, one degree of freedom).
"""
RESTING = 0.5
"""Part of a packing's run that its means leave out at the start."""


def repeat(case: Case) -> bool:
    """Run a packing at equal dt and print its means beside those of the reference."""
    assert case.folder
    names = ("t", "z_mean", "ke_trans", "ke_rot", "n_contacts")
    first, second = (
        read_columns(path, names)
        for path in (case.folder / "global_dt.csv", *case.folder.glob("global_dt_over_*.csv"))
    )
    simulation = Simulation(equal(case), device="cpu", threads=1)
    begin = time.perf_counter()
    ours = np.array([bulk(simulation, instant) for instant in first[:, 0]])
    spent = time.perf_counter() - begin
    rows = [measures(table) for table in (ours, bulk_of(first), bulk_of(second))]
    passes = True
    for (what, mine), (_, one), (_, other) in zip(*(row.items() for row in rows), strict=True):
        band = SPREAD * float(np.sqrt(np.mean((one - other) ** 2)))
        middle = 0.5 * float(np.mean(one) + np.mean(other))
        inside = abs(float(np.mean(mine)) - middle) <= band
        passes = passes and inside
        print(
            f"{case.name:28s} {what}: {np.mean(mine):.6g}, reference {np.mean(one):.6g} and "
            f"{np.mean(other):.6g} at dt/2, band {middle:.6g} +- {band:.2g}  {verdict(inside)}"
        )
    theirs = case.definition["wall_s"][0]
    print(
        f"{case.name:28s} {'means':>9s} {'':9s}  {verdict(passes)} {simulation.step_count:7d} "
        f"{spent:8.2f} {theirs:8.2f}",
        flush=True,
    )
    return passes


def bulk(simulation: Simulation, instant: float) -> tuple[float, float, float, float]:
    """Time [s], mean height [m], kinetic energy [J] and number of sub-contacts of a packing."""
    simulation.advance(float(instant))
    now = simulation.snapshot(contacts=True)
    free = ~simulation.placement.fixed
    touching = now.contacts
    assert touching is not None
    return (
        instant,
        float(now.position[free, 2].mean()),
        kinetic(simulation, now),
        float(len(touching.gap)),
    )


def kinetic(simulation: Simulation, now: Snapshot) -> float:
    """Kinetic energy of the free bodies, all alike cubes [J]."""
    free = ~simulation.placement.fixed
    shape = list(simulation.polyhedra.values())[simulation.placement.shape[free][0]]
    mass = shape.volume * simulation.placement.density[free]
    moment = mass * shape.inertia_over_mass[0]
    speeds = (now.velocity[free] ** 2).sum(axis=1), (now.spin[free] ** 2).sum(axis=1)
    return float(0.5 * (mass * speeds[0] + moment * speeds[1]).sum())


def bulk_of(table: FloatArray) -> FloatArray:
    """The columns of `bulk` from a reference's global series."""
    return np.stack([table[:, 0], table[:, 1], table[:, 2] + table[:, 3], table[:, 4]], axis=1)


def measures(table: FloatArray) -> dict[str, FloatArray]:
    """What a packing is judged by, as series whose means count."""
    late = table[:, 0] > RESTING * table[-1, 0]
    fall = (table[:, 0] > 0.2 * table[-1, 0]) & ~late
    return {
        "resting height [m]": table[late, 1],
        "log10 of the kinetic energy while settling [J]": np.log10(table[fall, 2]),
        "sub-contacts at rest": table[late, 3],
    }
