"""The pair kernel: contact wrench of each body pair, composed of the laws the scene chose.

A thread owns one body pair. Pass 1 finds the gaps and packs what touches; the pair's own frequency
follows from all of them. Pass 2 applies the laws, contact by contact, and writes the wrench once.
"""

import functools

import warp as wp
from warpdem.kernels.contact import apply_laws
from warpdem.kernels.laws import Laws
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.sharing import total_of
from warpdem.kernels.touching import find_touching, frequency
from warpdem.kernels.variant import variant
from warpdem.kernels.views import (
    Account,
    Bodies,
    Candidates,
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
    frequency_of = frequency(laws)
    shares = laws.partnership != "sum"
    total_shares = total_of(laws.partnership) if shares else None

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
        law = materials[pairs.material[pair]]
        touching, freed, unrolled = find(
            geometry, bodies, candidates, i, j, law, d, start, end, margin
        )
        pairs.touching[pair] = touching
        account = vec4()
        power = vec4()
        if wp.static(laws.account):
            if freed > real(0.0):
                account[2] = freed / (real(2.0) * law.kt)
            if unrolled > real(0.0):
                account[3] = unrolled / (real(2.0) * law.kr)
        force = vec3()
        torque = vec3()
        if touching > 0:
            total = real(1.0)
            if wp.static(shares):
                total = total_shares(candidates, start, touching, law.exponent)
            tau = real(0.0)
            beta = real(0.0)
            if wp.static(laws.damped):
                inverse_mass = inertia.inverse_mass[i] + inertia.inverse_mass[j]
                square = inverse_mass
                if wp.static(laws.pair_damping or laws.predicted):
                    square = frequency_of(
                        inertia, bodies, candidates, i, j, d, start, touching, total, law.exponent
                    )
                omega = wp.sqrt(law.kn * square)
                tau = real(2.0) * law.zeta / omega
                beta = law.zeta * omega * dt
                if wp.static(not laws.pair_damping):
                    tau = real(2.0) * law.zeta / wp.sqrt(law.kn * inverse_mass)
                    beta = real(0.5) * dt * tau * omega * omega
            for slot in range(start, start + touching):
                f, t, a, p = apply(
                    geometry, inertia, bodies, candidates, law, i, j, d, slot, total, tau, beta, dt
                )
                force += f
                torque += t
                account += a
                power += p
        pairs.force[pair] = force
        pairs.torque[pair] = torque - wp.cross(d, force)
        pairs.torque_partner[pair] = -torque
        if wp.static(laws.account):
            since = energy.pair[pair]
            lost = since + account + power * dt
            energy.pair[pair] = vec4(account[0], lost[1], lost[2], lost[3])
            energy.power[pair] = power

    return pair_forces
