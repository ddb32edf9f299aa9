"""Falling asleep, between two steps, and what sleepers keep when the lists are made anew.

A body falls asleep when it and all that it touches have been slow for long enough: so an island at
rest does as a whole, and a part of a pile whose other part is stirred does too.
"""

import functools

import warp as wp
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.neighbours import lower_bound
from warpdem.kernels.precision import wide, wide3, wide4, wide33
from warpdem.kernels.refresh import pace
from warpdem.kernels.sleep import stand_still
from warpdem.kernels.variant import inlined, plain, variant
from warpdem.kernels.views import Account, Bodies, Candidates, Geometry, Incidence, Inertia, Pairs


@inlined()
def calm(geometry: Geometry, inertia: Inertia, bodies: Bodies, body: int) -> bool:
    """Whether a body lets those that touch it sleep."""
    if bodies.sleep.asleep[body] != 0:
        return True
    if inertia.inverse_mass[body] == wide(0.0):
        return pace(geometry, bodies, body) < bodies.sleep.speed
    return bodies.sleep.slow[body] >= bodies.sleep.after


@plain
def choose_sleepers(
    # model
    geometry: Geometry,
    inertia: Inertia,
    gravity: wide3,
    # in
    pairs: Pairs,
    incidence: Incidence,
    # in and out
    bodies: Bodies,
):
    """Write for those that shall fall asleep which change of the contact force wakes them [N]."""
    body = wp.tid()
    if inertia.inverse_mass[body] == wide(0.0) or bodies.sleep.asleep[body] != 0:
        return
    if bodies.sleep.slow[body] < bodies.sleep.after:
        return
    largest = wp.length(gravity) * inertia.mass[body]
    first, others, count = pairs_of(incidence, body)
    for k in range(count):
        code = pair_at(incidence, body, first, others, k)
        pair = code >> 1
        if pairs.touching[pair] > 0:
            other = pairs.partner[pair]
            if (code & 1) != 0:
                other = pairs.owner[pair]
            if not calm(geometry, inertia, bodies, other):
                return
            largest = wp.max(largest, wide(wp.length(pairs.force[pair])))
    bodies.sleep.allowed[body] = bodies.sleep.tolerance * largest


@functools.cache
def fall_asleep(gather: wp.Function, *, acted: bool) -> wp.Kernel:
    """Kernel that stops the chosen bodies and notes what their contacts exert on them.

    ``gather`` sums that up; ``acted``: account is kept of forces on single bodies.
    """

    @variant
    def fall_asleep(
        # model
        inertia: Inertia,
        # in
        pairs: Pairs,
        incidence: Incidence,
        # in and out
        bodies: Bodies,
        # out
        energy: Account,
    ):
        body = wp.tid()
        if bodies.sleep.asleep[body] != 0 or bodies.sleep.allowed[body] < wide(0.0):
            return
        force, torque, _acting = gather(pairs, incidence, body)
        bodies.sleep.force[body] = force
        bodies.sleep.torque[body] = torque
        momentum = bodies.momentum[body]
        spun = wp.transpose(wide33(bodies.rotation[body])) * bodies.angular_momentum[body]
        moving = wp.dot(momentum, momentum) * inertia.inverse_mass[body]
        turning = wp.dot(spun, wp.cw_mul(spun, inertia.inverse_moment[body]))
        taken = bodies.sleep.taken[body]
        bodies.sleep.taken[body] = taken + wide(0.5) * (moving + turning)
        bodies.momentum[body] = wide3()
        bodies.angular_momentum[body] = wide3()
        bodies.velocity[body] = wide3()
        bodies.spin[body] = wide3()
        bodies.velocity_end[body] = wide3()
        bodies.spin_end[body] = wide3()
        if wp.static(acted):
            energy.body_power[body] = wide(0.0)
        bodies.sleep.asleep[body] = 1

    return fall_asleep


@plain
def deepen(
    # in
    anew: int,
    pairs: Pairs,
    incidence: Incidence,
    # in and out
    bodies: Bodies,
):
    """Find out whose pairs all stand still; where ``anew`` is 0, of those that did so before.

    The sums of the wrenches of these must be up to date.
    """
    body = wp.tid()
    if bodies.sleep.asleep[body] == 0 or (anew == 0 and bodies.sleep.deep[body] == 0):
        return
    deep = int(1)
    first, others, count = pairs_of(incidence, body)
    for k in range(count):
        pair = pair_at(incidence, body, first, others, k) >> 1
        if not stand_still(bodies.sleep, pairs.owner[pair], pairs.partner[pair]):
            deep = 0
    bodies.sleep.deep[body] = deep


@plain
def end_powers(
    # in
    dt: wide,
    pairs: Pairs,
    bodies: Bodies,
    # in and out
    energy: Account,
):
    """End the losses of pairs that have come to stand still: half of a step was counted ahead."""
    pair = wp.tid()
    if stand_still(bodies.sleep, pairs.owner[pair], pairs.partner[pair]):
        power = energy.power[pair]
        account = energy.pair[pair] - power * (wide(0.5) * dt)
        energy.pair[pair] = wide4(energy.pair[pair][0], account[1], account[2], account[3])
        energy.power[pair] = wide4()


@functools.cache
def carry_wrenches(*, packed: bool, account: bool) -> wp.Kernel:
    """Kernel that moves what pairs that stand still exert, and store, into new lists.

    ``packed``: what touches is packed in a list, too.
    """

    @variant
    def carry_wrenches(
        # in
        old_ends: wp.array(dtype=wp.int32),
        old: Pairs,
        before: Candidates,
        stored: wp.array(dtype=wide4),
        bodies: Bodies,
        # in and out
        pairs: Pairs,
        # out
        candidates: Candidates,
        energy: Account,
    ):
        pair = wp.tid()
        i = pairs.owner[pair]
        j = pairs.partner[pair]
        if not stand_still(bodies.sleep, i, j):
            return
        low = int(0)
        if i > 0:
            low = old_ends[i - 1]
        k = lower_bound(old.partner, low, old_ends[i], j)
        if k == old_ends[i]:
            return
        if old.partner[k] != j or old.touching[k] == 0:
            return
        pairs.touching[pair] = old.touching[k]
        pairs.force[pair] = old.force[k]
        pairs.torque_partner[pair] = old.torque_partner[k]
        if wp.static(account):
            energy.pair[pair] = wide4(stored[k][0], wide(0.0), wide(0.0), wide(0.0))
        if wp.static(packed):
            pairs.torque[pair] = old.torque[k]
            first = old.start[k]
            to = pairs.start[pair]
            for slot in range(old.touching[k]):
                code = before.code[before.which[first + slot]]
                for c in range(to, pairs.start[pair + 1]):
                    if candidates.code[c] == code:
                        candidates.which[to + slot] = c
                candidates.normal[to + slot] = before.normal[first + slot]
                candidates.point[to + slot] = before.point[first + slot]
                candidates.gap[to + slot] = before.gap[first + slot]

    return carry_wrenches
