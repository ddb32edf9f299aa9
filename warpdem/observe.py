"""State to snapshot: what is read off the device at output times, and the energy account."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem import observe_bonds
from warpdem.build import rotate, rotate_back
from warpdem.periodic import cell_state, flow, shifts
from warpdem.snapshot import Contacts, Energy, Snapshot

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State


def snapshot(
    model: Model,
    state: State,
    lists: Lists,
    *,
    time: float,
    step: int,
    dt: float,
    energy_start: float,
    contacts: bool,
) -> Snapshot:
    """All bodies at a full step, with contacts and energies when asked for."""
    velocity, spin = velocities(model, state)
    force, torque = _forces(model, state, lists)
    energy = None
    if model.features.account:
        energy = _energy(model, state, lists, energy_start, dt)
    return Snapshot(
        time=time,
        step=step,
        position=state.bodies.position.numpy().copy(),
        orientation=_orientation(state),
        velocity=velocity,
        spin=spin,
        force=force,
        torque=torque,
        contacts=_contacts(model, state, lists) if contacts else None,
        energy=energy,
        cell=cell_state(model, state, lists, velocity),
        work=state.account.work.numpy().copy() if model.features.work else None,
        breakage=state.bonding.breakage(model.free) if state.bonding else None,
    )


def _orientation(state: State) -> FloatArray:
    return state.bodies.orientation.numpy()[:, [3, 0, 1, 2]]


def velocities(model: Model, state: State) -> tuple[FloatArray, FloatArray]:
    """Velocities [m/s] and spins [rad/s] at the full step, shapes [body_count, 3]."""
    bodies = state.bodies
    q = _orientation(state)
    free = model.free[:, None]
    with np.errstate(invalid="ignore"):
        velocity = np.where(free, bodies.momentum.numpy() / model.mass[:, None], 0.0)
        spin = rotate_back(q, bodies.angular_momentum.numpy()) / model.moment
    spin = rotate(q, np.where(free, spin, 0.0))
    velocity = np.where(free, velocity, bodies.velocity_end.numpy())
    return velocity, np.where(free, spin, bodies.spin_end.numpy())


def _forces(model: Model, state: State, lists: Lists) -> tuple[FloatArray, FloatArray]:
    """Resultants; those of fixed bodies, which no step needs, are summed here."""
    force = state.bodies.force.numpy().copy()
    torque = state.bodies.torque.numpy().copy()
    fixed = ~model.free
    if model.features.deforming:
        # without what makes the homogeneous flow accelerate
        x = state.bodies.position.numpy() - state.cell.centre.numpy()[0]
        mass = np.where(fixed, 0.0, model.mass)
        force -= mass[:, None] * (x @ state.cell.acceleration.numpy()[0].T)
    force[fixed] = 0.0
    torque[fixed] = 0.0
    pairs = lists.pairs
    n = lists.pair_count
    on = np.flatnonzero(pairs.touching.numpy()[:n])
    owner, partner = pairs.owner.numpy()[on], pairs.partner.numpy()[on]
    f = pairs.force.numpy()[on]
    mine, theirs = fixed[owner], fixed[partner]
    np.add.at(force, owner[mine], f[mine])
    np.add.at(torque, owner[mine], _torque_of_owners(model, state, lists, on[mine]))
    np.subtract.at(force, partner[theirs], f[theirs])
    np.add.at(torque, partner[theirs], pairs.torque_partner.numpy()[on][theirs])
    if state.bonding:
        observe_bonds.add_forces(state.bonding, fixed, force, torque)
    return force, torque


def _torque_of_owners(model: Model, state: State, lists: Lists, pair: IntArray) -> FloatArray:
    """Contact torques on the owners of pairs about their centres [N m], shape [len(pair), 3]."""
    pairs = lists.pairs
    if not model.features.single:
        return pairs.torque.numpy()[pair]
    position = state.bodies.position.numpy()
    d = position[pairs.owner.numpy()[pair]] - position[pairs.partner.numpy()[pair]]
    d = d - shifts(state, lists, pair)
    return -pairs.torque_partner.numpy()[pair] - np.cross(d, pairs.force.numpy()[pair])


def _contacts(model: Model, state: State, lists: Lists) -> Contacts:
    """Touching sub-contacts, then the bonds."""
    found = touching(state, lists, rolling=model.features.rolling)
    if not state.bonding:
        return found
    return observe_bonds.with_bonds(found, state.bonding, state.bodies.position.numpy())


def slots(lists: Lists) -> tuple[IntArray, IntArray]:
    """Places of the touching contacts in the packed lists, and their pairs."""
    n = lists.pair_count
    count = lists.pairs.touching.numpy()[:n].astype(np.int64)
    start = lists.pairs.start.numpy()[:n].astype(np.int64)
    pair = np.repeat(np.arange(n), count)
    within = np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
    return start[pair] + within, pair


def touching(state: State, lists: Lists, *, rolling: bool) -> Contacts:
    """The touching sub-contacts, sorted by pair and feature."""
    place, pair = slots(lists)
    pairs, candidates = lists.pairs, lists.candidates
    which = candidates.which.numpy()[place]
    code = candidates.code.numpy()[which]
    past = candidates.past.numpy()[which]
    normal = candidates.normal.numpy()[place]
    partner = pairs.partner.numpy()[pair]
    rolled = np.zeros((len(which), 4))
    if rolling:
        rolled = candidates.rolled.numpy()[which]
    mask = (1 << 29) - 1
    return Contacts(
        bodies=np.column_stack([pairs.owner.numpy()[pair], partner]).astype(np.int32),
        kind=(code >> 58).astype(np.int32),
        features=np.column_stack([(code >> 29) & mask, code & mask]).astype(np.int32),
        point=candidates.point.numpy()[place]
        + state.bodies.position.numpy()[partner]
        + shifts(state, lists, pair),
        normal=normal,
        gap=candidates.gap.numpy()[place],
        normal_force=past[:, 3],
        tangential_force=past[:, :3],
        moment=rolled[:, :3] + rolled[:, 3:] * normal,
        bonded=np.zeros(len(which), dtype=bool),
    )


def total_energy(model: Model, state: State, lists: Lists) -> float:
    """Kinetic, potential and elastic energy now [J]."""
    bond = state.bonding.energies()[0] if state.bonding else 0.0
    return sum(_stored(model, state, lists)) + bond


def pair_energies(model: Model, state: State, lists: Lists) -> tuple[IntArray, FloatArray]:
    """Owner of each body pair, and the elastic energy of its contacts [J], shapes [pair_count]."""
    count = lists.pair_count
    elastic = np.zeros(count)
    if model.features.account and count:
        elastic = state.account.pair.numpy()[:count, 0].copy()
    return lists.pairs.owner.numpy()[:count].copy(), elastic


def _kinetic(model: Model, state: State) -> FloatArray:
    """Kinetic energy of each free body, against the cell's flow [J], shape [free_count]."""
    free = model.free
    velocity, spin = velocities(model, state)
    velocity = velocity - flow(model, state)
    body_spin = rotate_back(_orientation(state), spin)[free]
    moving = model.mass[free] * np.sum(velocity[free] ** 2, axis=1)
    return 0.5 * (moving + np.sum(model.moment[free] * body_spin**2, axis=1))


def _potential(model: Model, state: State) -> FloatArray:
    """Potential energy of each free body [J], shape [free_count]."""
    free = model.free
    return -model.mass[free] * (state.bodies.position.numpy()[free] @ model.gravity)


def stored_by(model: Model, state: State) -> FloatArray:
    """Kinetic and potential energy of each body; 0 of fixed ones [J], shape [body_count]."""
    energy = np.zeros(model.body_count)
    energy[model.free] = _kinetic(model, state) + _potential(model, state)
    return energy


def balance_of(model: Model, state: State, lists: Lists) -> tuple[float, float]:
    """Kinetic and elastic energy, and all that is stored less the work done on it [J]."""
    kinetic, potential, elastic = _stored(model, state, lists)
    bond = state.bonding.energies()[0] if state.bonding else 0.0
    moving = kinetic + elastic + bond
    return moving, moving + potential - sum(_works(model, state))


def _stored(model: Model, state: State, lists: Lists) -> tuple[float, float, float]:
    kinetic, potential = np.sum(_kinetic(model, state)), np.sum(_potential(model, state))
    elastic = 0.0
    if model.features.account:
        elastic = np.sum(state.account.pair.numpy()[: lists.pair_count, 0])
    return float(kinetic), float(potential), float(elastic)


def _works(model: Model, state: State) -> tuple[float, float]:
    """What drivers and the cell have done, and what forces but gravity have [J]."""
    done = state.account.work.numpy()
    work = external = 0.0
    if len(done) == model.body_count:
        work, external = float(done[~model.free].sum()), float(done[model.free].sum())
    if model.features.deforming:
        work += float(state.cell.work.numpy()[0])
    return work, external


def _energy(model: Model, state: State, lists: Lists, start: float, dt: float) -> Energy:
    kinetic, potential, elastic = _stored(model, state, lists)
    lost = lists.spent + lists.since() - 0.5 * dt * lists.power()
    bond, dashpot, broken = state.bonding.energies() if state.bonding else (0.0, 0.0, 0.0)
    lost[0] += dashpot
    if model.features.sleeps:
        lost[0] += state.bodies.sleep.taken.numpy().sum()
    stored = kinetic + potential + elastic + bond
    work, external = _works(model, state)
    place, _ = slots(lists)
    gap = lists.candidates.gap.numpy()[place]
    return Energy(
        kinetic=kinetic,
        potential=potential,
        elastic=elastic,
        dashpot=float(lost[0]),
        friction=float(lost[1]),
        rolling=float(lost[2]),
        work=work,
        external=external,
        balance=stored + float(lost.sum()) + broken - work - external - start,
        contact_count=len(place),
        largest_overlap=float(-gap.min(initial=0.0)),
        bond=bond,
        broken=broken,
    )
