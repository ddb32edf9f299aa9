"""Reference families of rolling balls, resting blocks, columns, stacks, tops and mass properties."""

import csv

import numpy as np
from analytic_row import Row, compared, order_row
from blocks import Column, growth, limit_of_stability, mode_frequency, on_slope, overhang
from impacts import order_of
from rolling import decay, descent, slip_to_roll
from tops import angle_between, euler_zxz, free_rotor, heavy_top, principal_momentum

from warpdem.orientation import turned
from warpdem.polyhedron import build
from warpdem.shapes import box

KN = 1e5


def _falling(name, run, x, quantities, *, unit=None):
    """Rows at 1 %, and one that the errors fall with the stiffness."""
    soft, stiff = run(KN), run(16.0 * KN)
    for quantity in quantities:
        scale = None if unit is None else unit[quantity]
        yield compared(name, quantity, soft[quantity], x[quantity], unit=scale, gate=1e-2)
    first = quantities[0]
    before, after = (abs(run[first] - x[first]) for run in (soft, stiff))
    note = f"16 kn: {after:.1e} off instead of {before:.1e}"
    yield Row(name, f"{first}, error falls", after, before, after, 0.5 * before + 1e-9, note)


def slip_to_roll_family(cases, _):
    for case in cases:
        p = case["params"]

        def run(kn, p=p):
            return slip_to_roll(
                v0=p["v0"], mu=p["mu"], beta=p["beta"], radius=p["R"], g=p["g"], kn=kn
            )

        quantities = ("t_roll", "v_final", "omega_final", "distance_at_roll")
        yield from _falling(case["id"], run, case["expected"], quantities)


def sphere_on_incline(cases, _):
    for case in cases:
        p = case["params"]
        angle = np.radians(p["theta_deg"])

        def run(kn, p=p, angle=angle):
            return descent(
                angle=angle,
                mu=p["mu"],
                mur=p["mu_r_length"],
                beta=p["beta"],
                radius=p["R"],
                g=p["g"],
                kn=kn,
            )

        fall = p["g"] * np.sin(angle)
        unit = {"x_after_1s": 0.5 * fall, "acc": fall, "alpha": fall / p["R"]}
        yield from _falling(case["id"], run, case["expected"], list(unit), unit=unit)


def rolling_decay(cases, _):
    for case in cases:
        p = case["params"]

        def run(kn, p=p):
            return decay(
                spin=p["omega0"],
                mur=p["mu_r_length"],
                beta=p["beta"],
                radius=p["R"],
                g=p["g"],
                kn=kn,
                upright=p["mode"] == "spin",
            )

        yield from _falling(case["id"], run, case["expected"], ["t_stop", "deceleration"])


def block_incline(cases, _):
    """The regime at the given stiffness; loads with springs 100 times as stiff.

    The formulas of the loads are those of rest: while the block slides its friction is mu N, while
    it tips the back corners are free. Where the cap of a back corner is less than an equal share of
    the friction, the offset of four equal springs is not reached.
    """
    for case in cases:
        p, x = case["params"], case["expected"]
        angle = np.radians(p["theta_deg"])
        block = {
            "angle": angle,
            "mu": p["mu"],
            "base": p["base"],
            "height": p["height"],
            "rounding": p["sphero_radius"],
            "g": p["g"],
            "kn": p["kn"],
            "kt": p["kt"],
        }
        name, end = case["id"], on_slope(duration=0.5, **block)
        regime = "tip" if end["tilt"] > 0.1 else "slide" if end["speed"] > 1e-3 else "static"
        right = float(regime == x["regime"])
        yield Row(name, f"regime: {regime}", right, 1.0, 1.0 - right, 0.0)
        if x["regime"] == "slide":
            fall = p["g"] * np.sin(angle)
            yield compared(name, "acc_slide", end["acc_slide"], x["acc_slide"], unit=fall, gate=1e-3)
        if x["regime"] != "static":
            continue
        end = on_slope(duration=0.05, stiffer=100.0, **block)
        for side in ("front", "back"):
            wanted = x[f"N_{side}_per_vertex_over_mg"]
            yield compared(name, f"N_{side}", end[side] / p["g"], wanted, unit=1.0, gate=1e-6)
        mean = x["mean_overlap_4_springs"]
        yield compared(name, "mean_overlap", end["mean_overlap"], mean, gate=1e-6)
        if p["mu"] * x["N_back_per_vertex_over_mg"] > 0.25 * np.sin(angle):
            offset = x["tangential_offset_4_springs"]
            yield compared(name, "tangential_offset", end["offset"], offset, gate=1e-4)


def spring_column(cases, _):
    for case in cases:
        p, x = case["params"], case["expected"]
        count, k, g = p["N"], p["k"], p["g"]
        wanted = np.array(x["overlaps_bottom_to_top"])
        limit = x["dt_crit_undamped"]
        column = Column(count=count, k=k, g=g, dt=0.3 * limit, zeta=1.0, overlaps=1.1 * wanted)
        # until the slowest mode has decayed by exp(-22)
        column.simulation.advance(22.0 * np.sqrt(2.0 * k) / x["omega_min"] ** 2)
        got = column.overlaps()
        yield compared(case["id"], "overlaps", got, wanted, unit=wanted.max(), gate=1e-8)
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
        low = float(0.7 * limit <= bound <= limit)
        yield Row(case["id"], "step_bound() below it", bound, limit, 1.0 - low, 0.0)


def verlet_stability(cases, _):
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
                right = float((grown > 1e3) == (share > 1.0))
                note = f"{how}: grows {grown:.1e} in 2000 steps"
                yield Row(case["id"], f"{share} of the limit", right, 1.0, 1 - right, 0.0, note)
        w0 = np.sqrt(p["k"] / p["m"])
        mode = mode_frequency(count=1, number=1, k=p["k"], g=9.81, dt=0.2 / w0)
        key = "relative_frequency_error_at_w0dt_0.2"
        yield compared(case["id"], "frequency error", mode / w0 - 1.0, x[key], gate=1e-5)


def overhang_stack(cases, _):
    for case in cases:
        p = case["params"]
        shifts = np.array(case["expected"]["shifts_top_to_bottom"])
        for share in (0.98, 1.02):
            tilt = overhang(shifts=shifts, length=p["L"], share=share, duration=1.5)
            right = float((tilt > 0.05) == (share > 1.0) and (tilt < 2e-3) == (share < 1.0))
            note = f"tilts {tilt:.1e} rad in 1.5 s"
            yield Row(case["id"], f"at {share} of the shifts", right, 1.0, 1.0 - right, 0.0, note)


def _orientation_rows(name, run, table):
    """Order over three steps, and the error at those of the table of design/numerics.md."""
    errors = {dt: run(dt) for dt in {*table, *(max(table) / n for n in (1, 2, 4, 8))}}
    for dt, most in table.items():
        if most is not None:
            yield Row(name, f"angle at dt {dt:g}", errors[dt], 0.0, errors[dt], most, "table")
    finer = np.array([1.0, 2.0, 4.0, 8.0])
    yield order_row(name, order_of(lambda n: errors[max(table) / n], finer))


def free_rotor_family(cases, folder):
    with (folder / "free_rotor_series.csv").open() as file:
        rows = list(csv.reader(file))[1:]
    for case in cases:
        p, x = case["params"], case["expected"]
        series = np.array([row[1:] for row in rows if row[0] == p["name"]], float)
        moments, momentum = np.array(p["I"]), np.array(x["L_world"])
        # a step that turns the body as far as that of the table turns the first rotor
        unit = np.sqrt(3.0) / np.linalg.norm(p["omega0_body"])
        worst = {}

        def run(dt, p=p, series=series, moments=moments, momentum=momentum, unit=unit, worst=worst):
            step = series[1, 0] / round(series[1, 0] / (dt * unit))
            shots = free_rotor(moments, p["omega0_body"], series[:, 0], dt=step)
            q = np.array([shot.orientation[0] for shot in shots])
            spun = principal_momentum(shots, moments)
            world = turned(q, spun)
            energy = 0.5 * np.sum(spun**2 / moments, axis=1)
            worst["L"] = np.abs(world - momentum).max() / np.linalg.norm(momentum)
            worst["E"] = np.abs(energy / energy[0] - 1.0).max()
            worst["w"] = np.abs(spun / moments - series[:, 5:]).max()
            return angle_between(q[-1], series[-1, 1:5])

        table = {0.05: 9.75e-3, 0.01: 3.95e-4, 0.001: 3.95e-6} if p["name"] == "generic" else {}
        yield from _orientation_rows(case["id"], run, table or {0.05: None})
        run(0.001)
        size = np.linalg.norm(p["omega0_body"])
        yield Row(case["id"], "L_world, drift", worst["L"], 0.0, worst["L"], 1e-12)
        yield Row(case["id"], "E, excursion", worst["E"], 0.0, worst["E"], 8e-6, "table")
        yield Row(case["id"], "omega_body", worst["w"], 0.0, worst["w"] / size, 1e-4)


def heavy_top_family(cases, _):
    """No joint in the product: kick-drift-kick of its rotation about the pinned point."""
    for case in cases:
        p, x = case["params"], case["expected"]
        end = euler_zxz(x["phi_T"], x["theta_T"], x["psi_T"])
        samples = {}

        def run(dt, p=p, end=end, samples=samples):
            orientation, momentum = heavy_top(
                moments=[p["I1"], p["I1"], p["I3"]],
                weight=p["mgl"],
                tilt=p["theta0"],
                spin=p["omega3"],
                times=np.linspace(0.0, p["T"], 21),
                dt=dt,
            )
            axis = turned(orientation, np.array([0.0, 0.0, 1.0]))
            samples["theta"] = np.arccos(axis[:, 2])
            samples["phi"] = np.unwrap(np.arctan2(axis[:, 0], -axis[:, 1]))
            samples["Lz"] = np.ptp(momentum[:, 2]) / abs(momentum[0, 2])
            return angle_between(orientation[-1], end)

        slow = p["omega3"] < 10.0
        table = {0.005: 1.85e-4} if slow else {0.005: None}
        yield from _orientation_rows(case["id"], run, table)
        run(0.0005)
        for angle in ("theta", "phi"):
            wanted = x[f"{angle}_samples"]
            off = np.angle(np.exp(1j * (samples[angle] - wanted)))
            yield compared(case["id"], f"{angle}_samples", off, 0.0, gate=1e-4)
        yield Row(case["id"], "L_z, drift", samples["Lz"], 0.0, samples["Lz"], 1e-12)


def sphero_box_mass(cases, _):
    """The closed form of boxes, and Steiner's formula over the faces where there are faces."""
    for case in cases:
        p, x = case["params"], case["expected"]
        core, r = np.array(p["core"], float), p["r"]
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


def sphero_tetra_mass(cases, _):
    for case in cases:
        p = case["params"]
        corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * p["edge"] / 8**0.5
        faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
        solid = build(corners, faces, name="tetra", radius=p["r"])
        yield compared(case["id"], "volume", solid.volume, case["expected"]["volume"], gate=1e-12)


FAMILIES = {
    "slip_to_roll": slip_to_roll_family,
    "sphere_on_incline": sphere_on_incline,
    "rolling_decay": rolling_decay,
    "block_incline": block_incline,
    "spring_column": spring_column,
    "verlet_stability": verlet_stability,
    "overhang_stack": overhang_stack,
    "free_rotor": free_rotor_family,
    "heavy_top": heavy_top_family,
    "sphero_box_mass": sphero_box_mass,
    "sphero_tetra_mass": sphero_tetra_mass,
}
