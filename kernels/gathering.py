"""Forces and torques on a body, gathered from its pairs and its bonds in a fixed order."""

import functools

import warp as wp
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.precision import wide3
from warpdem.kernels.variant import inlined, place
from warpdem.kernels.views import Bodies, Bonds, Incidence, Joints, Pairs


@functools.cache
def gather(*, summed: bool) -> wp.Function:
    """Function of the contact force and torque on a body, and how many pairs act on it.

    Summed over its pairs in a fixed order; ``summed``: over those it owns by the pair kernel.
    """

    @inlined()
    def one_by_one(pairs: Pairs, incidence: Incidence, body: int):
        acting = int(0)
        force = wide3()
        torque = wide3()
        first, others, count = pairs_of(incidence, body)
        for k in range(count):
            code = pair_at(incidence, body, first, others, k)
            pair = code >> 1
            if pairs.touching[pair] > 0:
                acting += 1
                if (code & 1) == 0:
                    force += wide3(pairs.force[pair])
                    torque += wide3(pairs.torque[pair])
                else:
                    force -= wide3(pairs.force[pair])
                    torque += wide3(pairs.torque_partner[pair])
        return force, torque, acting

    @inlined()
    def beyond_own(pairs: Pairs, incidence: Incidence, body: int):
        force = incidence.own_force[body]
        torque = incidence.own_torque[body]
        for k in range(incidence.start[body], incidence.start[body + 1]):
            pair = place(incidence.pair[k])
            if pairs.touching[pair] > 0:
                force -= wide3(pairs.force[pair])
                torque += wide3(pairs.torque_partner[pair])
        return force, torque, 0

    return beyond_own if summed else one_by_one


@inlined()
def gather_bonds(bonds: Bonds, joined: Joints, body: int):
    """Force and torque of the bonds on a body, summed over its interfaces in a fixed order."""
    force = wide3()
    torque = wide3()
    for k in range(joined.start[body], joined.start[body + 1]):
        code = joined.interface[k]
        interface = code >> 1
        if bonds.state[interface] != 0:
            if (code & 1) == 0:
                force += bonds.force[interface]
                torque += bonds.torque[interface]
            else:
                force -= bonds.force[interface]
                torque += bonds.torque_partner[interface]
    return force, torque


@functools.cache
def gathering(*, contacts: bool, summed: bool, braking: bool, bonds: bool) -> wp.Function:
    """Function of the force and torque on a body from its pairs and bonds."""
    gather_pairs = gather(summed=summed)

    @inlined()
    def gathering(
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        bodies: Bodies,
        body: int,
    ):
        force = wide3()
        torque = wide3()
        if wp.static(contacts):
            force, torque, acting = gather_pairs(pairs, incidence, body)
            if wp.static(braking):
                bodies.braked[body] = acting
        if wp.static(bonds):
            held, turning = gather_bonds(glue, joined, body)
            force += held
            torque += turning
        return force, torque

    return gathering
