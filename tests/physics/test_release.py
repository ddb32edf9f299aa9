"""What the contacts take over from a broken interface, and what it releases."""

from pathlib import Path

import pytest
from glued import SIDE, bond, cube, scene

from warpdem.simulation import Simulation

OWN = str(Path(__file__).with_name("own_laws.py"))
HERTZ = {"law": "custom", "en2": None, "file": OWN, "normal": "hertz", "parameters": [3e7]}
LAWS = {
    "sum": ({}, {}),
    "avalanche": ({}, {"law": "avalanche"}),
    "custom": ({}, HERTZ),
    "pnorm": ({"partnership": "pnorm"}, {}),
    "fc": ({}, {"fc": 20.0}),
    "dncut": ({}, {"fc": 20.0, "dncut": 2e-3}),
    "gamma, pnorm": ({"partnership": "pnorm"}, {"gamma": 500.0}),
}


def sheared(law, dt):
    """Two cubes pressed and drawn over one another; they come apart within the first steps."""
    run, contact = LAWS[law]
    # offset: aligned borders make contacts come and go
    offset = [SIDE, 0.13 * SIDE, 0.07 * SIDE]
    bodies = [
        cube(0, velocity=[0.4, 0.5, 0.1]),
        cube(1, velocity=[-0.4, -0.5, -0.1]) | {"position": offset},
    ]
    asked = scene(bodies, [bond(ft0=30.0)], dt=dt, rounding=0.01, contact=contact, **run)
    return Simulation(asked, device="cpu", threads=1)


@pytest.mark.parametrize("law", LAWS)
def test_energy_is_accounted_across_a_break(law):
    errors = []
    for dt in (4e-6, 2e-6):
        simulation = sheared(law, dt)
        simulation.advance(4e-4)
        now = simulation.snapshot()
        assert not now.breakage.intact.any()
        assert now.energy.contact_count >= 4
        errors.append(abs(now.energy.balance) / now.energy.kinetic)

    assert errors[1] < errors[0] / 3.0
    assert errors[1] < 2e-6
