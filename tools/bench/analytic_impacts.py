"""Reference families of impacts: balls head-on, oblique, spinning, bouncing; a box on its corner.

Errors are rms over eight phases of the step: of head-on impacts relative (instants over the time of
contact, overlaps over the largest, energies over that of the approach), else over the speed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from analytic_row import Row, averaged, compared, order_row
from blocks import corner_impact
from impacts import (
    Collision,
    Grazing,
    bounces,
    largest_force,
    order_of,
    parting,
    release,
    restitution,
    rms,
    turning,
)

from scenes import law
from warpdem.checks.restitution import zeta_bilateral, zeta_clamped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

Case = dict[str, Any]
STEPS = (25, 50, 100, 200)


def normal_impact(cases: list[Case], _: object) -> Iterator[Row]:
    for case in cases:
        yield from _normal(case["id"], case["params"], case["expected"])


def _normal(name: str, params: Case, x: Case) -> Iterator[Row]:
    speed, duration = params["v_approach"], x["t_force_zero_clamped"]
    mass, other = params["m1"], params["m2"]
    collision = {
        "mass": mass,
        "other": other,
        "rules": law(params["kn"], zeta=params["zeta"]),
        "speed": speed,
        "duration": duration,
    }
    hit = Collision(steps=50, **collision)
    top, out = hit.each(turning), hit.each(release)
    lost = 0.5 * mass * (speed**2 - hit.first**2) - 0.5 * (other or 0.0) * hit.second**2
    got = {
        "e_clamped": (hit.second - hit.first) / speed,
        "t_max_overlap": top[:, 0],
        "max_overlap": top[:, 1],
        "t_force_zero_clamped": out[:, 0],
        "overlap_at_force_zero": out[:, 1],
        "t_geometric_separation_clamped": hit.each(parting),
        "energy_dissipated_clamped": lost,
    }
    if other is not None:
        got |= {"v1_after": hit.first, "v2_after": hit.second}
    unit = {
        "t_max_overlap": duration,
        "overlap_at_force_zero": x["max_overlap"],
        "energy_dissipated_clamped": 0.5 * mass * speed**2,
    }
    for quantity, values in got.items():
        scale = unit.get(quantity, abs(x[quantity]))
        yield averaged(name, quantity, values, x[quantity], unit=scale, gate=1e-3)
    yield _largest_force(name, hit.each(largest_force), x["max_force"], params["zeta"])

    def error(steps: int) -> float:
        return rms(restitution(steps=steps, **collision) - x["e_clamped"])

    yield order_row(name, order_of(error, STEPS))


def _largest_force(name: str, values: NDArray[np.float64], expected: float, zeta: float) -> Row:
    """Beyond z = 1/2 it is the jump at the touch, an instant on which no step falls.

    It is then extrapolated, to the mean of which the gate applies.
    """
    if zeta < 0.5:
        return averaged(name, "max_force", values, expected, unit=expected, gate=1e-3)
    note = f"at the touch; rms over phases {rms(values / expected - 1.0):.1e}"
    return compared(name, "max_force", np.mean(values), expected, gate=1e-3, note=note)


def restitution_inverse(cases: list[Case], _: object) -> Iterator[Row]:
    for case in cases:
        name, e, x = case["id"], case["params"]["e_target"], case["expected"]
        yield compared(name, "zeta_clamped", zeta_clamped(e), x["zeta_clamped"], gate=1e-12)
        yield compared(name, "zeta_bilateral", zeta_bilateral(e), x["zeta_bilateral"], gate=1e-12)
        realised = x["e_realised_if_bilateral_zeta_is_used_with_clamp"]
        for quantity, how, zeta, wanted in (
            ("e delivered", "clamped", x["zeta_clamped"], e),
            ("e delivered, bilateral zeta", "bilateral", x["zeta_bilateral"], realised),
        ):
            duration = _contact_time(zeta) / np.sqrt(1e5)
            delivered = restitution(
                mass=1.0,
                rules=law(1e5, e=e),
                speed=1.0,
                steps=50,
                duration=duration,
                restitution=how,
            )
            yield averaged(name, quantity, delivered, wanted, gate=1e-3)


def _contact_time(zeta: float) -> float:
    """Times w0: until the force of a clamped contact ends."""
    if zeta == 1.0:
        return 2.0
    root = np.emath.sqrt(1.0 - zeta**2)
    return float(abs(2.0 * np.emath.arccos(zeta) / root))


def _grazing(params: Case, duration: float, steps: int, **motion: float) -> Grazing:
    how = {"friction_cap": "elastic"} if params["friction_cap"] == "fne" else {}
    kn = params["kn"]
    rules = law(kn, kt=params["kt_over_kn"] * kn, mu=params["mu"], zeta=params["zeta"])
    return Grazing(
        mass=params["m"],
        rules=rules,
        beta=params["beta"],
        steps=steps,
        duration=duration,
        **motion,
        **how,
    )


def oblique_impact(cases: list[Case], _: object) -> Iterator[Row]:
    def run(case: Case, steps: int) -> Grazing:
        params = case["params"]
        angle = np.radians(params["angle_from_normal_deg"])
        motion = {"fall": params["speed"] * np.cos(angle), "slide": params["speed"] * np.sin(angle)}
        return _grazing(params, case["expected"]["t_end_friction"], steps, **motion)

    def error(steps: int) -> float:
        return rms(
            [
                (run(case, steps).slip - case["expected"]["u_contact_after"])
                / case["params"]["speed"]
                for case in cases
            ]
        )

    for case in cases:
        name, params, x = case["id"], case["params"], case["expected"]
        hit, speed = run(case, 100), params["speed"]
        fall = speed * np.cos(np.radians(params["angle_from_normal_deg"]))
        impulse = (hit.along - speed * np.sin(np.radians(params["angle_from_normal_deg"]))) / (
            params["mu"] * (fall + hit.rebound)
        )
        for quantity, values, wanted, unit in (
            ("vn_after", hit.rebound, x["vn_after"], speed),
            ("vt_after", hit.along, x["vt_after"], speed),
            ("omega_after", hit.turning / params["R"], x["omega_after"], speed / params["R"]),
            ("u_contact_after", hit.slip, x["u_contact_after"], speed),
            (
                "rebound_angle_cm_rad",
                np.arctan2(hit.along, hit.rebound),
                x["rebound_angle_cm_rad"],
                1.0,
            ),
            ("impulse_ratio", -impulse, x["impulse_ratio"], 1.0),
        ):
            yield averaged(name, quantity, values, wanted, unit=unit, gate=1e-3)
    yield order_row("oblique_impact", order_of(error, (*STEPS, 400)))


def spin_impact(cases: list[Case], _: object) -> Iterator[Row]:
    for case in cases:
        name, params, x = case["id"], case["params"], case["expected"]
        spin = params["R"] * params["omega0"]
        duration = _contact_time(params["zeta"]) * np.sqrt(params["m"] / params["kn"])
        hit = _grazing(params, duration, 100, fall=params["vn"], spin=-spin)
        speed = max(spin, params["vn"])
        for quantity, values, unit in (
            ("vn_after", hit.rebound, speed),
            ("vt_after", hit.along, speed),
            ("omega_after", hit.turning / params["R"], speed / params["R"]),
            ("u_contact_after", -hit.slip, speed),
        ):
            yield averaged(name, quantity, values, x[quantity], unit=unit, gate=1e-3)


def soft_bounce_gravity(cases: list[Case], _: object) -> Iterator[Row]:
    for case in cases:
        p, x = case["params"], case["expected"]
        times, speeds, peaks = bounces(
            mass=p["m"],
            kn=p["kn"],
            zeta=p["zeta"],
            height=p["h0"],
            g=p["g"],
            steps=100,
            count=len(x["touch_times"]),
        )
        yield compared(case["id"], "touch_times", times, x["touch_times"], gate=1e-3)
        yield compared(case["id"], "touch_speeds", speeds, x["touch_speeds"], gate=1e-3)
        yield compared(case["id"], "peak_heights", peaks, x["peak_heights"], gate=1e-3)


def box_impulse(cases: list[Case], _: object) -> Iterator[Row]:
    """A corner of negligible rounding; the floor's rounding receives it.

    With friction the formula is Moreau's law: one impulse, its direction opposed to the final slip.
    The smooth law turns friction with the slip of every instant and gives back what the frictional
    spring stores; the difference does not vanish with the stiffness and is only shown.
    """
    for case in cases:
        p, x = case["params"], case["expected"]
        smooth = p["mu"] == 0
        unit = np.linalg.norm(p["v0"])
        errors = {}
        for kn in (1e8, 1e10):
            after = corner_impact(
                size=p["dims"],
                density=p["density"],
                angles=p["rotation_zyx_from_xyz"],
                velocity=p["v0"],
                spin=p["omega0_world"],
                rules=law(kn, kt=0.0 if smooth else 0.8 * kn, mu=p["mu"], e=p["e"]),
                m_eff=x["m_eff_normal"],
                steps=200,
            )
            errors[kn] = np.linalg.norm(after[0] - x["v_after"])
        note = "" if smooth else "Moreau's law"
        gate = 1e-3 if smooth else None
        arm = np.linalg.norm(x["contact_arm"])
        for quantity, got, scale in (
            ("v_after", after[0], unit),
            ("omega_after", after[1], unit / arm),
        ):
            wanted = np.array(x[quantity])
            yield compared(case["id"], quantity, got, wanted, unit=scale, gate=gate, note=note)
        if smooth:
            order = np.log(errors[1e8] / errors[1e10]) / np.log(100.0)
            yield order_row(case["id"], order, least=0.45, of="order in 1/kn")


FAMILIES = {
    function.__name__: function
    for function in (
        normal_impact,
        restitution_inverse,
        oblique_impact,
        spin_impact,
        soft_bounce_gravity,
        box_impulse,
    )
}
