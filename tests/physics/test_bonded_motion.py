"""Bonded bodies in motion: order, energy, rupture, what follows it."""

import numpy as np
import pytest
from glued import SIDE, bond, cube, scene, tumbling

from warpdem.simulation import Simulation

WEAK = {"kr": 50.0, "en2": 0.5, "fn0": 300.0}
TAME = {"kr": 50.0, "en2": 0.5, "fn0": 1e9}


def run(asked, until=0.02, threads=1):
    simulation = Simulation(asked, device="cpu", threads=threads)
    simulation.advance(until)
    return simulation


def momenta(simulation):
    """Linear and angular momentum of all bodies about the origin."""
    state, model = simulation._state.bodies, simulation._model
    p, x = state.momentum.numpy(), state.position.numpy()
    spin = state.angular_momentum.numpy() + np.cross(x, p)
    return np.concatenate([p[model.free].sum(axis=0), spin[model.free].sum(axis=0)])


def test_motion_is_of_second_order():
    dts = (4e-5, 2e-5, 1e-5)
    finest = run(tumbling(dt=2.5e-6, **TAME)).snapshot().position
    errors = [np.abs(run(tumbling(dt=dt, **TAME)).snapshot().position - finest).max() for dt in dts]

    assert np.log2(errors[0] / errors[1]) > 1.8
    assert np.log2(errors[1] / errors[2]) > 1.8


@pytest.mark.parametrize("strength", [TAME, WEAK], ids=["whole", "breaking"])
def test_energy_is_accounted_to_second_order(strength):
    errors = []
    for dt in (2e-5, 1e-5):
        simulation = run(tumbling(dt=dt, **strength), until=0.01)
        now = simulation.snapshot()
        assert now.breakage.intact.all() == (strength is TAME)
        errors.append(abs(now.energy.balance) / now.energy.dashpot)

    assert errors[1] < errors[0] / 3.0
    assert errors[1] < 2e-4


@pytest.mark.slow
def test_energy_is_accounted_to_a_millionth_with_a_small_step():
    energy = run(tumbling(dt=1e-6, **WEAK)).snapshot().energy

    assert energy.broken > 0.0
    assert abs(energy.balance) < 1e-6 * energy.dashpot


def test_breaking_conserves_momentum():
    before = run(tumbling(dt=2e-5, **WEAK), until=0.0)
    after = run(tumbling(dt=2e-5, **WEAK))

    assert not after.snapshot().breakage.intact.all()
    assert np.allclose(momenta(after), momenta(before), rtol=0.0, atol=1e-13)


def test_an_interface_breaks_as_a_whole_when_its_bonds_reach_their_strength():
    # a row drawn apart evenly: no waves; each gap grows as v t and breaks beyond fn0/kn
    speed, dt = 0.1, 1e-5
    rows = [cube(0, fixed=True), cube(1, velocity=[speed, 0.0, 0.0])]
    asked = scene(rows, [bond(walls=True, fn0=50.0)], dt=dt)
    simulation = run(asked, until=1e-3)
    broken = simulation.snapshot().breakage
    # free oscillation of the cube on four bonds
    omega = np.sqrt(4e6 / simulation._model.mass[1])
    instant = np.arcsin(50.0 / 1e6 * omega / speed) / omega

    assert not broken.intact[0]
    assert instant <= broken.time[0] <= instant + dt * (1.0 + 1e-6)
    assert broken.step[0] == round(broken.time[0] / dt)
    assert broken.mode[0] == 1
    # its forces act for half a step more
    pull = speed / omega * np.sin(omega * (broken.time[0] + 0.5 * dt))
    assert broken.released[0] == pytest.approx(0.5 * 4e6 * pull**2, rel=3e-4)


def test_energy_criterion_breaks_at_two_area_times_fracture_energy():
    speed, gc, dt = 0.1, 0.5, 1e-5
    rows = [cube(0, fixed=True), cube(1, velocity=[speed, 0.0, 0.0])]
    simulation = run(scene(rows, [bond(walls=True, gc=gc)], dt=dt), until=1.5e-3)
    broken = simulation.snapshot().breakage
    omega = np.sqrt(4e6 / simulation._model.mass[1])
    pull = np.sqrt(2.0 * (SIDE - 0.01) ** 2 * gc / (0.5 * 4e6))
    instant = np.arcsin(pull * omega / speed) / omega

    assert broken.mode[0] == 4
    assert instant <= broken.time[0] <= instant + dt * (1.0 + 1e-6)


def test_bonded_bodies_have_no_contact_until_they_break():
    speed = -0.5
    rows = [cube(0, fixed=True), cube(1, velocity=[speed, 0.0, 0.0])]
    whole = run(scene(rows, [bond(walls=True)], dt=1e-5), until=2e-4).snapshot(contacts=True)
    broken = run(scene(rows, [bond(walls=True, ft0=1e-9, kt=1.0)], dt=1e-5), until=2e-4)
    after = broken.snapshot(contacts=True)

    assert whole.contacts.bonded.all()
    assert len(whole.contacts.gap) == 4
    assert whole.contacts.gap.max() < 0.0
    assert after.breakage.intact.all()
    broken._state.bonding.bonds.state.fill_(2)
    broken._state.clock.moved.fill_(1)
    broken.advance(3e-4)
    after = broken.snapshot(contacts=True)
    assert not after.contacts.bonded.any()
    assert len(after.contacts.gap) > 0


def test_result_does_not_depend_on_threads():
    bodies = [cube(k, spin=[0.0, 1.0 + 0.1 * k, 40.0]) for k in range(120)]
    asked = scene(bodies, [bond(**WEAK)], dt=4e-5)
    one, two = (run(asked, until=4e-3, threads=threads).snapshot() for threads in (1, 2))

    assert not one.breakage.intact.all()
    assert np.array_equal(one.position, two.position)
    assert np.array_equal(one.breakage.time, two.breakage.time, equal_nan=True)


@pytest.mark.parametrize("pause", [50, 145, 146, 147, 160])
def test_a_restored_run_goes_on_bitwise_across_a_break(pause):
    asked = tumbling(dt=2e-5, **WEAK)
    straight = run(asked, until=0.008)
    assert straight.snapshot().breakage.step.max() == 146
    first = run(asked, until=pause * 2e-5)
    second = Simulation(asked, device="cpu", threads=1)
    second.restore(first.checkpoint())
    second.advance(0.008)
    one, two = straight.snapshot(contacts=True), second.snapshot(contacts=True)

    assert np.array_equal(one.position, two.position)
    assert np.array_equal(one.breakage.released, two.breakage.released)
    assert np.array_equal(one.contacts.tangential_force, two.contacts.tangential_force)
    assert one.energy == two.energy


def test_step_is_bounded_by_the_bonds():
    simulation = Simulation(scene([cube(0), cube(1)], [bond(kn=1e9)]), device="cpu", threads=1)
    # two cubes on four springs each: sqrt(4 kn / m_eff) along their line
    period = 2.0 / np.sqrt(4e9 / (0.5 * 2500.0 * SIDE**3))

    assert simulation.dt < 0.5 * period
    assert 0.3 * period < simulation.step_bound() < period
