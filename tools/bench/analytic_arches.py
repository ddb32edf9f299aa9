"""Reference families of semicircular arches: least thickness, hinges, least friction.

Chosen, for what the closed forms leave open (R = 1 m, arch of 1 kg):
- stands at 1.04 t and 1.05 mu, falls at .96 t and .9 mu; hinging with mu = 2, which never slips.
- stiffness: a corner that carries a quarter of the arch sinks in by 1e-6 R, 1e-5 of the thickness.
  With 1e-5 R the shock of the start makes 40 voussoirs fall at 1.04 t (at a third of the step too);
  10 and 20 stand.
- start: at rest, joints closed without overlap, all of gravity at once. Voussoirs sink by 1e-5 R
  (hinging) to 2e-4 R (slipping to where friction suffices); the margin of 4 % of t is 4e-3 R.
- damping: restitution .5 in the joints and no other, dt = "auto". At .3 and below the predicted
  update is unstable at this step in chains of thin blocks: the balance of energy shows it.
- "stands": after 6 sqrt(R/g) no voussoir has moved by 1e-3 R and the kinetic energy is below
  1e-7 m g R; "falls": within this time one has sunk by .05 R, and goes on: more than 1e-4 m g R.
- sharp (r = 0): the core is the whole wedge, its hinges where the formula has them; 1e-4 R around
  it carry the contact. Otherwise the rounding lies within the thickness.
- continuous: 40 voussoirs. Their least thickness is 2e-4 less (as that of any number divisible by
  10: the joint at 54 degrees decides), a two-hundredth of the margin.
- equal weights, and joints of four corners against a slightly larger face: tests/physics/arches.py.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from analytic_row import Row, compared, fact
from arches import Arch, thrust_bounds

if TYPE_CHECKING:
    from collections.abc import Iterator

Case = dict[str, Any]
STIFF = {"squash": 1e-6}
ROUGH = 2.0
"""Friction coefficient where only hinges are wanted."""
CONTINUOUS = 40
"""Voussoirs of an arch without joints."""
MOMENTS = 6.0
"""How long an arch is watched, over sqrt(R/g)."""


def _stands(case: str, arch: Arch, what: str) -> Row:
    moved, kinetic = arch.moved(), arch.kinetic()
    note = f"moved {moved:.1e} R, kinetic {kinetic:.0e} m g R at {arch.simulation.time:.2f} s"
    return fact(case, f"stands at {what}", true=moved < 1e-3 and kinetic < 1e-7, note=note)


def _falls(case: str, arch: Arch, what: str) -> Row:
    sunk, kinetic = arch.sunk(), arch.kinetic()
    note = f"sunk {sunk:.3f} R, kinetic {kinetic:.0e} m g R at {arch.simulation.time:.2f} s"
    return fact(case, f"falls at {what}", true=sunk > 0.05 and kinetic > 1e-4, note=note)


def arch(cases: list[Case], _: object) -> Iterator[Row]:
    """Hinging: verdicts, the joint that opens at the haunch, the thrust of the one that stands."""
    for case in cases:
        name, p, x = case["id"], case["params"], case["expected"]
        count, rounding = p.get("N", CONTINUOUS), p["r_over_R"]
        solid = {"count": count, "rounding": rounding, "mu": ROUGH, **STIFF}
        thick = 1.04 * x["t_over_R"]
        standing = Arch(thickness=thick, **solid).watch(MOMENTS)
        yield _stands(name, standing, "1.04 t")
        least, most = thrust_bounds(thick, rounding, count)
        thrust = standing.thrust()
        between = least - 1e-3 < thrust < most + 1e-3
        note = f"{thrust:.4f} in {least:.4f} .. {most:.4f} w R t"
        yield fact(name, "thrust within its bounds", true=between, note=note)
        falling = Arch(thickness=0.96 * x["t_over_R"], **solid).watch(MOMENTS)
        yield _falls(name, falling, "0.96 t")
        joint = 180.0 / count
        note = f"one joint is {joint:g} degrees"
        yield compared(
            name, "beta_deg", falling.haunch(), x["beta_deg"], unit=1.0, gate=joint, note=note
        )


def arch_friction(cases: list[Case], _: object) -> Iterator[Row]:
    """Sliding: an arch thick enough against hinges, on little friction."""
    for case in cases:
        name, p = case["id"], case["params"]
        least = case["expected"]["min_mu"]
        solid = {"count": p["N"], "thickness": p["t_over_R"], "rounding": p["r_over_R"], **STIFF}
        yield _stands(name, Arch(mu=1.05 * least, **solid).watch(MOMENTS), "1.05 mu")
        yield _falls(name, Arch(mu=0.9 * least, **solid).watch(MOMENTS), "0.9 mu")


FAMILIES = {"arch": arch, "arch_friction": arch_friction}
