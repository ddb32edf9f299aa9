"""The pair kernel: contact wrench of each body pair, composed of the laws the scene chose.

A thread owns one body pair. Pass 1 finds the gaps and packs what touches; the pair's own frequency
follows from all of them. Pass 2 applies the laws, contact by contact, and writes the wrench once.
"""

import functools

import warp as wp
from warpdem.kernels.cell import real_vector
from warpdem.kernels.kinematics import Flow
from warpdem.kernels.laws import Laws, apply_laws
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.touching import find_touching, frequency
from warpdem.kernels.variant import variant
from warpdem.kernels.views import (
    Account,
    Bodies,
    Candidates,
    Cell,
    Clock,
    Geometry,
    Inertia,
    Material,
    Pairs,
)


@functools.cache
def pair_forces(laws: Laws) -> wp.Kernel:
    """Kernel of the contact wrench of each body pair."""
    find = find_touching(laws)
    apply = apply_laws(laws)
    frequency_of = frequency()

    @variant
    def pair_forces(
        # model
        geometry: Geometry,
        inertia: Inertia,
        materials: wp.array(dtype=Material),
        # in
        dt: real,
        margin: real,
        span: wp.array(dtype=wp.int32),
        bodies: Bodies,
        clock: Clock,
        cell: Cell,
        # in and out
        pairs: Pairs,
        candidates: Candidates,
        # out
        energy: Account,
    ):
        pair = wp.tid() + span[0]
        if pair >= span[1] or clock.halted[0] != 0:
            return
        start = pairs.start[pair]
        end = pairs.start[pair + 1]
        if start == end:
            return
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        d = bodies.position[i] - bodies.position[j]
        flow = Flow()
        if wp.static(laws.periodic):
            image = real_vector(pairs.image[pair])
            d -= cell.edges[0] * image
            if wp.static(laws.deforming):
                flow.half = cell.rate[0] * image
                flow.end = cell.rate_end[0] * image
        touching, freed, unrolled = find(geometry, bodies, candidates, i, j, d, start, end, margin)
        pairs.touching[pair] = touching
        law = materials[pairs.material[pair]]
        account = vec4()
        if wp.static(laws.account):
            if freed > real(0.0):
                account[2] = freed / (real(2.0) * law.kt)
            if unrolled > real(0.0):
                account[3] = unrolled / (real(2.0) * law.kr)
        force = vec3()
        torque = vec3()
        if touching > 0:
            tau = real(0.0)
            beta = real(0.0)
            if wp.static(laws.damped):
                inverse_mass = inertia.inverse_mass[i] + inertia.inverse_mass[j]
                square = inverse_mass
                if wp.static(laws.pair_damping or laws.predicted):
                    square = frequency_of(inertia, bodies, candidates, i, j, d, start, touching)
                omega = wp.sqrt(law.kn * square)
                tau = real(2.0) * law.zeta / omega
                beta = law.zeta * omega * dt
                if wp.static(not laws.pair_damping):
                    tau = real(2.0) * law.zeta / wp.sqrt(law.kn * inverse_mass)
                    beta = real(0.5) * dt * tau * omega * omega
            for slot in range(start, start + touching):
                f, t, a = apply(
                    inertia, bodies, candidates, law, flow, i, j, d, slot, tau, beta, dt
                )
                force += f
                torque += t
                account += a
        pairs.force[pair] = force
        pairs.torque[pair] = torque - wp.cross(d, force)
        pairs.torque_partner[pair] = -torque
        if wp.static(laws.account):
            since = energy.pair[pair]
            energy.pair[pair] = vec4(
                account[0], since[1] + account[1], since[2] + account[2], since[3] + account[3]
            )

    return pair_forces
