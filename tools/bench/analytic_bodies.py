"""Reference families of rolling balls, resting blocks, columns, stacks and solids."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from analytic_row import Row, compared, fact
from blocks import Column, growth, limit_of_stability, mode_frequency, on_slope, overhang
from rolling import decay, descent, slip_to_roll

from warpdem.geometry.polyhedron import build
from warpdem.geometry.shapes import box

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

Case = dict[str, Any]
KN = 1e5
"""Stiffness of rolling balls of 1 kg [N/m]."""


def _rolling(
    case: Case,
    run: Callable[..., dict[str, float]],
    quantities: Sequence[str],
    unit: Mapping[str, float] | None = None,
) -> Iterator[Row]:
    """Rows at 1 %, and one that the first error falls with the stiffness."""
    name, x = case["id"], case["expected"]
    soft, stiff = run(kn=KN), run(kn=16.0 * KN)
    for quantity in quantities:
        scale = None if unit is None else unit[quantity]
        yield compared(name, quantity, soft[quantity], x[quantity], unit=scale, gate=1e-2)
    first = quantities[0]
    before, after = (abs(got[first] - x[first]) for got in (soft, stiff))
    note = f"16 kn: {after:.1e} off instead of {before:.1e}"
    yield fact(name, f"{first}: error falls", true=after < 0.5 * before + 1e-9, note=note)


def slip_and_roll(cases: list[Case], _: object) -> Iterator[Row]:
    """A sliding ball ends rolling."""
    for case in cases:
        p = case["params"]
        ball = {"v0": p["v0"], "mu": p["mu"], "beta": p["beta"], "radius": p["R"], "g": p["g"]}
        quantities = ("t_roll", "v_final", "omega_final", "distance_at_roll")
        yield from _rolling(case, partial(slip_to_roll, **ball), quantities)


def sphere_on_incline(cases: list[Case], _: object) -> Iterator[Row]:
    """Errors over those of free fall along the slope."""
    for case in cases:
        p = case["params"]
        angle = np.radians(p["theta_deg"])
        run = partial(
            descent,
            angle=angle,
            mu=p["mu"],
            mur=p["mu_r_length"],
            beta=p["beta"],
            radius=p["R"],
            g=p["g"],
        )
        fall = p["g"] * np.sin(angle)
        unit = {"x_after_1s": 0.5 * fall, "acc": fall, "alpha": fall / p["R"]}
        yield from _rolling(case, run, list(unit), unit)


def rolling_decay(cases: list[Case], _: object) -> Iterator[Row]:
    """A ball with rolling resistance comes to rest."""
    for case in cases:
        p = case["params"]
        run = partial(
            decay,
            spin=p["omega0"],
            mur=p["mu_r_length"],
            beta=p["beta"],
            radius=p["R"],
            g=p["g"],
            upright=p["mode"] == "spin",
        )
        yield from _rolling(case, run, ["t_stop", "deceleration"])


def block_incline(cases: list[Case], _: object) -> Iterator[Row]:
    """The regime at the given stiffness; loads with springs 100 times as stiff.

    A sharp corner has a rounding of 1e-9 m; the floor's rounding receives it.
    """
    for case in cases:
        p, x = case["params"], case["expected"]
        angle = np.radians(p["theta_deg"])
        keys = ("mu", "base", "height", "g", "kn", "kt")
        block = {key: p[key] for key in keys} | {"angle": angle, "rounding": p["sphero_radius"]}
        end = on_slope(duration=0.5, **block)
        regime = "tip" if end["tilt"] > 0.1 else "slide" if end["speed"] > 1e-3 else "static"
        yield fact(case["id"], f"regime: {regime}", true=regime == x["regime"])
        if x["regime"] == "slide":
            fall = p["g"] * np.sin(angle)
            got = end["acc_slide"]
            yield compared(case["id"], "acc_slide", got, x["acc_slide"], unit=fall, gate=1e-3)
        if x["regime"] == "static":
            yield from _loads(case, on_slope(duration=0.05, stiffer=100.0, **block), angle)


def _loads(case: Case, end: Case, angle: float) -> Iterator[Row]:
    """Of a block at rest; in sliding friction is mu N, and in tipping the back corners are free.

    Where the cap of a back corner is less than an equal share of the friction, the offset of four
    equal springs is not reached.
    """
    name, p, x = case["id"], case["params"], case["expected"]
    for side in ("front", "back"):
        wanted = x[f"N_{side}_per_vertex_over_mg"]
        yield compared(name, f"N_{side}", end[side] / p["g"], wanted, unit=1.0, gate=1e-6)
    mean = x["mean_overlap_4_springs"]
    yield compared(name, "mean_overlap", end["mean_overlap"], mean, gate=1e-6)
    if p["mu"] * x["N_back_per_vertex_over_mg"] > 0.25 * np.sin(angle):
        offset = x["tangential_offset_4_springs"]
        yield compared(name, "tangential_offset", end["offset"], offset, gate=1e-4)


def spring_column(cases: list[Case], _: object) -> Iterator[Row]:
    """Balls in line: one contact an interface."""
    for case in cases:
        p, x = case["params"], case["expected"]
        count, k, g = p["N"], p["k"], p["g"]
        wanted, limit = np.array(x["overlaps_bottom_to_top"]), x["dt_crit_undamped"]
        column = Column(count=count, k=k, g=g, dt=0.3 * limit, zeta=1.0, overlaps=1.1 * wanted)
        # until the slowest mode has decayed by exp(-22)
        column.simulation.advance(22.0 * np.sqrt(2.0 * k) / x["omega_min"] ** 2)
        got, largest = column.overlaps(), float(wanted.max())
        yield compared(case["id"], "overlaps", got, wanted, unit=largest, gate=1e-8)
        yield compared(case["id"], "top_settlement", got.sum(), x["top_settlement"], gate=1e-8)
        dt = 0.1 / np.sqrt(k)
        for number, name in ((1, "omega_min"), (count, "omega_max")):
            # of the time step's own oscillator
            exact = 2.0 / dt * np.arcsin(0.5 * x[name] * dt)
            mode = mode_frequency(count=count, number=number, k=k, g=g, dt=dt)
            yield compared(case["id"], f"{name} at this dt", mode, exact, gate=1e-6)
        found = limit_of_stability(0.9 * limit, 1.1 * limit, count=count, k=k, g=g)
        yield compared(case["id"], "dt_crit_undamped", found, limit, gate=2e-2)
        bound = column.simulation.step_bound()
        note = f"{bound / limit:.3f} of it"
        below = 0.7 * limit <= bound <= limit
        yield fact(case["id"], "step_bound() just below it", true=below, note=note)


def verlet_stability(cases: list[Case], _: object) -> Iterator[Row]:
    """A ball pressed to the floor by gravity; the predicted update keeps the undamped limit."""
    for case in cases:
        p, x = case["params"], case["expected"]
        for how, key in (
            ("lagged", "dt_crit_velocity_lagged_half_kick"),
            ("predicted", "dt_crit_undamped"),
        ):
            column = {"count": 1, "k": p["k"], "g": 9.81, "zeta": p["zeta"], "contact_update": how}
            found = limit_of_stability(0.9 * x[key], 1.1 * x[key], **column)
            yield compared(case["id"], f"limit, {how}", found, x[key], gate=2e-2)
            for share in (0.98, 1.02):
                grown = growth(dt=share * x[key], steps=2000, **column)
                right, note = (grown > 1e3) == (share > 1.0), f"grows {grown:.1e} in 2000 steps"
                yield fact(case["id"], f"{share} of it, {how}", true=right, note=note)
        w0 = np.sqrt(p["k"] / p["m"])
        mode = mode_frequency(count=1, number=1, k=p["k"], g=9.81, dt=0.2 / w0)
        key = "relative_frequency_error_at_w0dt_0.2"
        yield compared(case["id"], "frequency error", mode / w0 - 1.0, x[key], gate=1e-5)


def overhang_stack(cases: list[Case], _: object) -> Iterator[Row]:
    """Stands at .98 of the harmonic shifts, falls at 1.02."""
    for case in cases:
        shifts = np.array(case["expected"]["shifts_top_to_bottom"])
        for share in (0.98, 1.02):
            length = case["params"]["L"]
            tilt = overhang(shifts=shifts, length=length, share=share, duration=1.5)
            right = tilt > 0.05 if share > 1.0 else tilt < 2e-3
            note = f"tilts {tilt:.1e} rad in 1.5 s"
            yield fact(case["id"], f"at {share} of the shifts", true=right, note=note)


def sphero_box_mass(cases: list[Case], _: object) -> Iterator[Row]:
    """The closed form of boxes, and Steiner's formula over the faces where there are faces."""
    for case in cases:
        core, r, x = np.array(case["params"]["core"], float), case["params"]["r"], case["expected"]
        ways = {"": box("box", core + 2.0 * r, r)}
        if core.all():
            solid = ways[""]
            faces = [face.loops[0].tolist() for face in solid.faces]
            ways[", as a convex solid"] = build(solid.vertices, faces, name="solid", radius=r)
        for way, solid in ways.items():
            yield compared(case["id"], f"volume{way}", solid.volume, x["volume"], gate=1e-12)
            got = solid.volume * solid.inertia_over_mass
            wanted = [x[f"I{axis}{axis}_over_rho"] for axis in "xyz"]
            yield compared(case["id"], f"inertia{way}", got, wanted, gate=1e-12)


def sphero_tetra_mass(cases: list[Case], _: object) -> Iterator[Row]:
    """Steiner's formula of a regular tetrahedron."""
    for case in cases:
        p = case["params"]
        corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * p["edge"] / 8**0.5
        faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
        solid = build(corners, faces, name="tetra", radius=p["r"])
        yield compared(case["id"], "volume", solid.volume, case["expected"]["volume"], gate=1e-12)


FAMILIES = {
    "slip_to_roll": slip_and_roll,
    "sphere_on_incline": sphere_on_incline,
    "rolling_decay": rolling_decay,
    "block_incline": block_incline,
    "spring_column": spring_column,
    "verlet_stability": verlet_stability,
    "overhang_stack": overhang_stack,
    "sphero_box_mass": sphero_box_mass,
    "sphero_tetra_mass": sphero_tetra_mass,
}
