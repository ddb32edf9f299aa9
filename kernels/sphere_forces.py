"""The pair kernel of spheres: one contact a pair, found and followed in one go.

A thread takes the pairs that one body owns and sums their wrenches on it; the partners gather
theirs, see gathering.py. There are no lists of features: a candidate has the number of its pair.
"""

import functools

import warp as wp
from warpdem.kernels.cell import real_vector
from warpdem.kernels.contact import apply_laws
from warpdem.kernels.forces import given_up
from warpdem.kernels.incidence import owned_from
from warpdem.kernels.kinematics import Flow
from warpdem.kernels.laws import Laws
from warpdem.kernels.narrow import FAR
from warpdem.kernels.precision import real, vec3, wide, wide3, wide4
from warpdem.kernels.sleep import kept_wrench, stand_still
from warpdem.kernels.touching import find_single, gaps
from warpdem.kernels.variant import compiled, inlined, place, variant
from warpdem.kernels.views import (
    Account,
    Bodies,
    Candidates,
    Cell,
    Clock,
    Geometry,
    Incidence,
    Inertia,
    Material,
    Pairs,
)


@functools.cache
def single_dashpot(laws: Laws) -> wp.Function:
    """Function of a single contact's dashpot: its time tau [s], its implicit share beta."""

    @inlined()
    def single_dashpot(inertia: Inertia, law: Material, i: int, j: int, dt: real):
        tau = real(0.0)
        beta = real(0.0)
        if wp.static(laws.damped):
            inverse_mass = real(inertia.inverse_mass[i] + inertia.inverse_mass[j])
            omega = wp.sqrt(law.kn * inverse_mass)
            tau = real(2.0) * law.zeta / omega
            beta = law.zeta * omega * dt
        return tau, beta

    return single_dashpot


@functools.cache
def one_pair(laws: Laws) -> wp.Function:
    """Function of the contact wrench of one pair; it is written for the partner, too."""
    find = find_single(laws)
    apply = apply_laws(laws)
    dashpot_of = single_dashpot(laws)

    @inlined()
    def one_pair(
        geometry: Geometry,
        inertia: Inertia,
        materials: wp.array(dtype=Material),
        dt: wide,
        margin: real,
        bodies: Bodies,
        cell: Cell,
        pairs: Pairs,
        candidates: Candidates,
        energy: Account,
        i: int,
        pair: int,
    ):
        """Force [N] and torque [N m] on the owner, about its centre."""
        pair = place(pair)
        j = place(pairs.partner[pair])
        apart = bodies.position[i] - bodies.position[j]
        if wp.static(laws.sleeps):
            if stand_still(bodies.sleep, i, j):
                f, t = kept_wrench(pairs, pair, vec3(apart))
                return f, t
        flow = Flow()
        if wp.static(laws.periodic):
            image = real_vector(pairs.image[pair])
            apart -= cell.edges[0] * image
            if wp.static(laws.deforming):
                flow.half = cell.rate[0] * image
                flow.end = cell.rate_end[0] * image
        d = vec3(apart)
        step = real(dt)
        law = materials[pairs.material[pair]]
        hit, near, freed, unrolled = find(
            geometry, bodies, candidates, i, j, law, apart, pair, margin
        )
        account = given_up(law, freed, unrolled)
        power = wide4()
        force = vec3()
        own = vec3()
        if near:
            tau, beta = dashpot_of(inertia, law, i, j, step)
            # fmt: off
            force, torque, a, p = apply(
                geometry, inertia, bodies, candidates, law, flow, i, j, d, pair, hit.normal,
                hit.point, -hit.gap, real(1.0), tau, beta, step,
            )
            # fmt: on
            account += a
            power = p
            own = torque - wp.cross(d, force)
            pairs.touching[pair] = 1
            pairs.force[pair] = force
            pairs.torque_partner[pair] = -torque
        else:
            pairs.touching[pair] = 0
        if wp.static(laws.account):
            since = energy.pair[pair]
            lost = since + account + power * dt
            energy.pair[pair] = wide4(account[0], lost[1], lost[2], lost[3])
            energy.power[pair] = power
        return force, own

    return one_pair


@functools.cache
def sphere_forces(laws: Laws) -> wp.Kernel:
    """Kernel of the contact wrenches of the pairs that each body owns."""
    wrench_of = one_pair(laws)

    @compiled(fuses=laws.fused)
    def sphere_forces(
        # model
        geometry: Geometry,
        inertia: Inertia,
        materials: wp.array(dtype=Material),
        # in
        dt: wide,
        margin: real,
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        clock: Clock,
        cell: Cell,
        # in and out
        pairs: Pairs,
        candidates: Candidates,
        # out
        incidence: Incidence,
        energy: Account,
    ):
        body = place(wp.tid() + span[0])
        if body >= span[1] or clock.halted[0] != 0:
            return
        if wp.static(laws.sleeps):
            if bodies.sleep.deep[body] != 0:
                return
        force = wide3()
        torque = wide3()
        for pair in range(owned_from(incidence, body), incidence.ends[body]):
            # fmt: off
            f, t = wrench_of(
                geometry, inertia, materials, dt, margin, bodies, cell, pairs, candidates, energy,
                body, pair,
            )
            # fmt: on
            force += wide3(f)
            torque += wide3(t)
        incidence.own_force[body] = force
        incidence.own_torque[body] = torque

    return sphere_forces


@functools.cache
def locate_contacts(laws: Laws) -> wp.Kernel:
    """Kernel that writes where the spheres touch, for those who look at contacts."""
    gap_of = gaps(laws)

    @variant
    def locate_contacts(
        # model
        geometry: Geometry,
        # in
        bodies: Bodies,
        pairs: Pairs,
        cell: Cell,
        # out
        candidates: Candidates,
    ):
        pair = wp.tid()
        candidates.which[pair] = pair
        if pairs.touching[pair] != 0:
            i = pairs.owner[pair]
            j = pairs.partner[pair]
            d = bodies.position[i] - bodies.position[j]
            if wp.static(laws.periodic):
                d -= cell.edges[0] * real_vector(pairs.image[pair])
            hit = gap_of(geometry, bodies, i, j, d, FAR, True, candidates.code[pair])
            candidates.normal[pair] = hit.normal
            candidates.point[pair] = hit.point
            candidates.gap[pair] = hit.gap

    return locate_contacts
