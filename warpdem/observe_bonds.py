"""The bonds of a simulation as a snapshot shows them."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from warpdem.snapshot import Contacts

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.bonding import Bonding


def add_forces(bonding: Bonding, chosen: BoolArray, force: FloatArray, torque: FloatArray) -> None:
    """Add the bonds' force and torque to those of the chosen bodies, shapes [body_count, 3]."""
    bonds = bonding.bonds
    standing = bonding.standing
    owner, partner = bonding.made.bodies[standing].T
    mine, theirs = chosen[owner], chosen[partner]
    f = bonds.force.numpy()[standing]
    np.add.at(force, owner[mine], f[mine])
    np.subtract.at(force, partner[theirs], f[theirs])
    np.add.at(torque, owner[mine], bonds.torque.numpy()[standing][mine])
    np.add.at(torque, partner[theirs], bonds.torque_partner.numpy()[standing][theirs])


def with_bonds(contacts: Contacts, bonding: Bonding, position: FloatArray) -> Contacts:
    """The contacts, and after them the bonds that stand."""
    parts = (contacts, _bonds(bonding, position))
    names = [field.name for field in fields(Contacts)]
    return Contacts(
        **{name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    )


def _bonds(bonding: Bonding, position: FloatArray) -> Contacts:
    made, bonds = bonding.made, bonding.bonds
    chosen = np.repeat(bonding.standing, made.counts)
    bodies = np.repeat(made.bodies, made.counts, axis=0)[chosen]
    held = bonds.held.numpy()[chosen]
    viscous, bent = bonds.viscous.numpy(), bonds.bent.numpy()
    tangential = held[:, :3] + (viscous[chosen] if len(viscous) == len(chosen) else 0.0)
    normal = bonds.normal.numpy()[chosen]
    moment = np.zeros_like(normal)
    if len(bent) == len(chosen):
        moment = bent[chosen, :3] + bent[chosen, 3:] * normal
    return Contacts(
        bodies=bodies.astype(np.int32),
        kind=made.sites.kind[chosen].astype(np.int32),
        features=made.sites.features[chosen].astype(np.int32),
        point=bonds.point.numpy()[chosen] + position[bodies[:, 1]],
        normal=normal,
        gap=bonds.gap.numpy()[chosen],
        normal_force=held[:, 3],
        tangential_force=tangential,
        moment=moment,
        bonded=np.ones(len(bodies), dtype=bool),
    )
