"""A periodic cell that deforms: homogeneous flow, stress control, energy, threads and pauses."""

import numpy as np
import pytest
from periodic import ELASTIC, SHEAR, STATE, lattice, momentum, peculiar, scene, start

import warpdem.simulation
from warpdem.simulation import Simulation

GENERAL = [[-1.0, 1.0, 0.5], [0.3, -2.0, 0.0], [0.0, 1.0, 0.5]]
PRESS = {"xx": 1e4, "yy": 1e4, "zz": 1e4}
MIXED = {"size": [1.0] * 3, "strain_rate": SHEAR, "stress": PRESS, "damping": 20.0}


def exponential(rate):
    """Matrix exponential by its series."""
    total, term = np.eye(3), np.eye(3)
    for k in range(1, 30):
        term = term @ rate / k
        total = total + term
    return total


@pytest.mark.parametrize("rate", [SHEAR, GENERAL], ids=["shear", "general"])
def test_cell_and_free_bodies_follow_the_exponential_of_the_rate_to_second_order(rate):
    bodies = lattice(2, [1.0] * 3, shapes=("ball",))
    exact = exponential(0.2 * np.array(rate))
    errors = []
    for dt in (4e-3, 2e-3):
        simulation = start(bodies, {"size": [1.0] * 3, "strain_rate": rate}, dt=dt)
        simulation.advance(0.2)
        shot = simulation.snapshot()
        centre = shot.cell.centre
        x = (simulation.placement.position - centre) @ exact.T + centre
        assert np.abs(peculiar(shot)).max() < 1e-4
        errors.append(
            [np.abs(shot.cell.deformation - exact).max(), np.abs(shot.position - x).max()]
        )
    coarse, fine = errors
    assert fine[0] < 1e-5
    for a, b in zip(coarse, fine, strict=True):
        assert b < a / 3.7 or b < 1e-12


def test_flow_begins_and_ends_when_it_is_told():
    cell = {"size": [1.0] * 3, "strain_rate": SHEAR, "start": 0.1, "stop": 0.2}
    simulation = start(lattice(2, [1.0] * 3), cell, dt=1e-3)
    for until, rate, strain in ((0.09, 0.0, 0.0), (0.15, 5.0, 0.25), (0.3, 0.0, 0.5)):
        simulation.advance(until)
        shot = simulation.snapshot()
        assert shot.cell.velocity_gradient[0, 1] == pytest.approx(rate, abs=1e-12)
        assert shot.cell.edges[0, 1] == pytest.approx(strain, abs=1e-9)
        assert np.abs(peculiar(shot)).max() < 1e-12


def test_position_across_the_boundary_makes_no_difference_to_a_flow():
    """The same packing with bodies replaced by their images, in compression and shear."""
    size = [0.6] * 3
    bodies = lattice(3, size, seed=2, speed=0.3, jitter=0.004)
    cell = {"size": size, "strain_rate": GENERAL}
    steps = np.random.default_rng(5).integers(-1, 2, size=(len(bodies), 3))
    moved = [
        {**body, "position": list(np.array(body["position"]) + 0.6 * n)}
        for body, n in zip(bodies, steps, strict=True)
    ]
    one, other = (start(these, cell, dt=1e-4) for these in (bodies, moved))
    for simulation in (one, other):
        simulation.advance(0.02)
    first, second = one.snapshot(), other.snapshot()
    assert first.energy.friction > 0.01
    there = first.position + steps @ first.cell.edges.T
    assert np.abs(second.position - there).max() < 1e-11
    assert np.abs(peculiar(first) - peculiar(second)).max() < 1e-9


def test_dense_packing_in_simple_shear_flows_with_a_linear_profile():
    size = [0.74] * 3
    bodies = lattice(4, size, seed=1, speed=0.1, jitter=0.002)
    simulation = start(bodies, {"size": size, "strain_rate": SHEAR}, dt=1e-4)
    rows = []
    for until in np.arange(0.2, 0.6, 0.02):
        simulation.advance(float(until))
        shot = simulation.snapshot()
        rows.append(np.column_stack([shot.cell.wrapped(shot.position)[:, 1], *shot.velocity.T]))
        # as seen in the cell: an image moves with the flow of its place
        flow = shot.position[:, 1] - shot.cell.wrapped(shot.position)[:, 1]
        rows[-1][:, 1] -= 5.0 * flow
    y, vx, _, _ = np.concatenate(rows).T
    slope, offset = np.polyfit(y - 0.37, vx, 1)
    assert simulation.snapshot().energy.contact_count > 50
    assert slope == pytest.approx(5.0, rel=0.1)
    assert abs(offset) < 0.1


def test_a_cell_that_shears_on_is_described_by_shorter_edges(monkeypatch):
    size = [0.6] * 3
    bodies = lattice(3, size, seed=2, speed=0.3, jitter=0.004, shapes=("ball", "cube"))
    cell = {"size": size, "strain_rate": [[0.0, 40.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]}
    deep = {"overlap": "note"}
    short = start(bodies, cell, dt=1e-5, run=deep)
    short.advance(0.02)
    monkeypatch.setattr("warpdem.images.LEAN", 1e9)
    long = start(bodies, cell, dt=1e-5, run=deep)
    long.advance(0.02)
    first, second = short.snapshot(), long.snapshot()
    assert second.cell.edges[0, 1] == pytest.approx(0.8 * 0.6, rel=1e-9)
    assert first.cell.edges[0, 1] == pytest.approx(-0.2 * 0.6, rel=1e-9)
    assert first.energy.friction > 1.0
    assert np.abs(first.cell.deformation - second.cell.deformation).max() < 1e-12
    assert np.abs(first.position - second.position).max() < 1e-9
    assert np.abs(first.velocity - second.velocity).max() < 1e-6
    assert first.energy.friction == pytest.approx(second.energy.friction, rel=1e-9)


def test_momentum_is_conserved_to_rounding_in_shear():
    size = [0.7] * 3
    bodies = lattice(3, size, seed=1, speed=1.0, jitter=0.01, shapes=("ball",))
    simulation = start(bodies, {"size": size, "strain_rate": SHEAR}, dt=5e-5)
    before = momentum(simulation)
    simulation.advance(0.1)
    assert simulation.snapshot().energy.friction > 1.0
    assert np.abs(momentum(simulation) - before).max() < 1e-11


def test_isotropic_compression_reaches_its_pressure():
    bodies = lattice(4, [1.0] * 3, seed=1, speed=0.1, jitter=0.01)
    simulation = start(bodies, {"size": [1.0] * 3, "stress": PRESS}, dt=1e-4)
    simulation.advance(2.0)
    cell = simulation.snapshot().cell
    assert np.abs(np.diag(cell.stress) / 1e4 - 1.0).max() < 1e-3
    assert np.abs(cell.velocity_gradient).max() < 1e-2
    off = cell.edges - np.diag(np.diag(cell.edges))
    assert np.abs(off).max() < 1e-12
    assert 0.5 < cell.solid_fraction < 0.7


def test_energy_account_closes_in_a_flow():
    """Work of the cell against what is stored: to 1e-6 of it, and to second order."""
    size = [0.61] * 3
    bodies = lattice(3, size, seed=1, jitter=1e-3)
    errors = []
    for dt in (4e-5, 1e-5):
        cell = {"size": size, "strain_rate": GENERAL}
        simulation = start(bodies, cell, dt=dt, law=ELASTIC)
        simulation.advance(0.06)
        energy = simulation.snapshot().energy
        errors.append(abs(energy.balance / energy.work))
    assert energy.elastic > 0.3 * energy.work
    assert errors[1] < 1e-6
    assert errors[1] < errors[0] / 6.0


def test_energy_account_closes_with_friction_and_damping_under_stress_control():
    bodies = lattice(3, [0.7] * 3, seed=1, speed=0.2, jitter=1e-3)
    errors = []
    for dt in (4e-5, 1e-5):
        cell = {"size": [0.7] * 3, "strain_rate": SHEAR, "stress": PRESS, "damping": 20.0}
        simulation = start(bodies, cell, dt=dt)
        simulation.advance(0.1)
        energy = simulation.snapshot().energy
        errors.append(abs(energy.balance / energy.work))
    assert energy.friction > 0.1 * energy.work
    assert errors[1] < 2e-4
    assert errors[1] < errors[0] / 3.0


def test_threads_and_pauses_leave_no_trace_in_a_cell_under_control(monkeypatch):
    monkeypatch.setattr(warpdem.simulation, "CREW_BODIES", 2)
    monkeypatch.setattr("warpdem.crews.WORTH", 1e9)  # two, though one be faster
    monkeypatch.setattr(warpdem.simulation.os, "cpu_count", lambda: 2)
    bodies = lattice(3, [0.7] * 3, seed=1, speed=0.2, jitter=1e-3, shapes=("ball", "cube"))
    built = scene(bodies, {**MIXED, "size": [0.9] * 3}, dt=5e-5)
    alone, together, resumed = (
        Simulation(built, device="cpu", threads=threads) for threads in (1, 2, 2)
    )
    alone.advance(0.11)  # sheared by over half: its edges have been exchanged
    assert alone.snapshot().cell.edges[0, 1] < 0.0
    resumed.restore(alone.checkpoint())
    for simulation in (alone, together, resumed):
        simulation.advance(0.15)
    first = alone.snapshot()
    assert first.energy.contact_count > 20
    assert together.report()["cycles_by_threads"][2] > 0
    for other in (together.snapshot(), resumed.snapshot()):
        for name in STATE:
            assert np.array_equal(getattr(first, name), getattr(other, name))
        assert np.array_equal(first.cell.edges, other.cell.edges)
        assert np.array_equal(first.cell.velocity_gradient, other.cell.velocity_gradient)
        assert first.energy == other.energy
