"""The pair kernel: contact wrench of each body pair, composed of the laws the scene chose.

A thread owns one body pair. Pass 1 finds the gaps and packs what touches; the pair's own frequency
follows from all of them. Pass 2 applies the laws, contact by contact, and writes the wrench once.
"""

import functools

import warp as wp
from warpdem.kernels.braking import fastest_mode, implicit_share
from warpdem.kernels.cell import real_vector
from warpdem.kernels.contact import apply_laws
from warpdem.kernels.excess import Excess, share_out
from warpdem.kernels.kinematics import Flow
from warpdem.kernels.laws import Laws
from warpdem.kernels.precision import real, vec3, wide, wide4
from warpdem.kernels.sharing import total_of
from warpdem.kernels.sleep import stand_still
from warpdem.kernels.touching import find_touching, frequency
from warpdem.kernels.variant import compiled, inlined, place
from warpdem.kernels.views import (
    Account,
    Bodies,
    Candidates,
    Cell,
    Clock,
    Drives,
    Geometry,
    Inertia,
    Material,
    Pairs,
)


@wp.func
def given_up(law: Material, freed: wide, unrolled: wide) -> wide4:
    """What the springs of contacts that opened lose: squares of their force and moment [J]."""
    account = wide4()
    if freed > wide(0.0):
        account[2] = freed / wide(real(2.0) * law.kt)
    if unrolled > wide(0.0):
        account[3] = unrolled / wide(real(2.0) * law.kr)
    return account


@functools.cache
def dashpot(laws: Laws) -> wp.Function:
    """Function of what all contacts of a pair share: see sharing.py and normal.py.

    The measure of their shares, the time tau of their dashpot [s], its implicit share beta.
    """
    frequency_of = frequency(laws)
    fastest_of = fastest_mode(laws.partnership, controlled=laws.controlled)
    total_shares = total_of(laws.partnership) if laws.moving else None

    @inlined()
    def dashpot(
        inertia: Inertia,
        drives: Drives,
        bodies: Bodies,
        clock: Clock,
        pairs: Pairs,
        candidates: Candidates,
        law: Material,
        pair: int,
        i: int,
        j: int,
        d: vec3,
        start: int,
        touching: int,
        excess: Excess,
        dt: real,
    ):
        total = real(1.0)
        if wp.static(laws.moving):
            total = total_shares(candidates, start, touching, law.exponent)
        tau = real(0.0)
        beta = real(0.0)
        if wp.static(laws.damped):
            inverse_mass = real(inertia.inverse_mass[i] + inertia.inverse_mass[j])
            square = inverse_mass
            if wp.static(laws.pair_damping or laws.predicted):
                square = frequency_of(
                    inertia, bodies, candidates, i, j, d, start, touching, total, law.exponent,
                    excess,
                )  # fmt: skip
            omega = wp.sqrt(law.kn * square)
            tau = real(2.0) * law.zeta / omega
            beta = law.zeta * omega * dt
            if wp.static(not laws.pair_damping):
                tau = real(2.0) * law.zeta / wp.sqrt(law.kn * inverse_mass)
                beta = real(0.5) * dt * tau * omega * omega
            if wp.static(laws.predicted):
                several = touching > 1
                if wp.static(laws.controlled):
                    # a wall may be lighter than what it carries
                    several = several or inertia.driven[i] > 0 or inertia.driven[j] > 0
                if several:
                    # fmt: off
                    fastest = fastest_of(
                        inertia, drives, bodies, clock, pairs, candidates, pair, i, j, d, start,
                        touching, total, law.exponent,
                    )
                    # fmt: on
                    beta = wp.max(beta, implicit_share(dt * tau * law.kn * fastest))
        return total, tau, beta

    return dashpot


@functools.cache
def pair_forces(laws: Laws) -> wp.Kernel:
    """Kernel of the contact wrench of each body pair."""
    find = find_touching(laws)
    apply = apply_laws(laws)
    dashpot_of = dashpot(laws)

    @compiled(fuses=laws.fused)
    def pair_forces(
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
        drives: Drives,
        # in and out
        pairs: Pairs,
        candidates: Candidates,
        # out
        energy: Account,
    ):
        pair = place(wp.tid() + span[0])
        if pair >= span[1] or clock.halted[0] != 0:
            return
        start = pairs.start[pair]
        end = int(0)
        if wp.static(laws.polyhedra):
            end = pairs.hot_end[pair]
        else:
            end = pairs.start[pair + 1]
        if start == end:
            return
        i = place(pairs.owner[pair])
        j = place(pairs.partner[pair])
        if wp.static(laws.sleeps):
            if stand_still(bodies.sleep, i, j):
                return
        apart = bodies.position[i] - bodies.position[j]
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
        touching, freed, unrolled = find(
            geometry, bodies, candidates, i, j, law, apart, start, end, margin
        )
        pairs.touching[pair] = touching
        if wp.static(laws.damped and laws.predicted):
            if touching == 0:
                pairs.looked[pair] = 0
        account = given_up(law, freed, unrolled)
        power = wide4()
        force = vec3()
        torque = vec3()
        if touching > 0:
            excess = Excess()
            if wp.static(laws.once):
                excess = share_out(geometry, bodies, candidates, i, j, apart, start, touching)
                force = excess.force * law.kn
                torque = excess.torque * law.kn
                account[0] = wide(real(0.5) * law.kn * excess.square)
            # fmt: off
            total, tau, beta = dashpot_of(
                inertia, drives, bodies, clock, pairs, candidates, law, pair, i, j, d, start,
                touching, excess, step,
            )
            # fmt: on
            for slot in range(start, start + touching):
                # fmt: off
                f, t, a, p = apply(
                    geometry, inertia, bodies, candidates, law, flow, i, j, d,
                    place(candidates.which[slot]), candidates.normal[slot], candidates.point[slot],
                    -candidates.gap[slot], total, tau, beta, step,
                )
                # fmt: on
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
            energy.pair[pair] = wide4(account[0], lost[1], lost[2], lost[3])
            energy.power[pair] = power

    return pair_forces
