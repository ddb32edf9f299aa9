"""Signorini-Coulomb contact of one rock with fixed ground, by projections.

Percussions P of the closed contacts solve P = prox_C(P - r (gamma + bias)) with the contact
velocities gamma at the step's end, C = R+ x disc of radius mu P_N: in-place Gauss-Seidel on the
rock's velocity and world spin, without a Delassus matrix. Slow convergence (several contacts, mu
about 1) is helped by Anderson acceleration of depth 2, then by friction bounds frozen for a while,
a convex problem; a step still unconverged is scaled down until it adds no energy.

Leine et al. (2014), doi:10.1007/s11044-013-9393-4; Anderson (1965), doi:10.1145/321296.321305.
"""

import warp as wp
from warpdem.kernels.fall_views import Contact, Iterates
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.variant import inlined

# sweeps between two renewals of frozen friction bounds
RENEWAL = wp.constant(15)
# growth of the residual at which the acceleration forgets what it knew
ASTRAY = wp.constant(wide(10.0))
# squared sine between two differences below which the older one tells nothing new
PARALLEL = wp.constant(wide(1.0e-8))


@wp.struct
class Twist:
    """Velocity of the centre of mass and spin, along the world's axes."""

    velocity: wide3
    spin: wide3


@wp.struct
class Solved:
    """Outcome of the sweeps."""

    twist: Twist
    sweeps: int
    residual: wide  # largest change of a contact velocity in the last sweep [m/s]
    frozen: int
    converged: int


@wp.struct
class Body:
    """What percussions act on."""

    inverse_mass: wide
    inverse_inertia: wide33  # along the world's axes, of the implicit gyroscopic term; unsymmetric
    cofactor: wide33  # of the inverse of inertia without that term


@wp.func
def struck(twist: Twist, body: Body, arm: wide3, percussion: wide3) -> Twist:
    """The twist after a percussion at ``arm`` from the centre of mass."""
    after = Twist()
    after.velocity = twist.velocity + body.inverse_mass * percussion
    after.spin = twist.spin + body.inverse_inertia @ wp.cross(arm, percussion)
    return after


@wp.func
def velocity_at(twist: Twist, arm: wide3) -> wide3:
    """Velocity of the rock's point at ``arm``."""
    return twist.velocity + wp.cross(twist.spin, arm)


@wp.func
def capped(tangential: wide3, most: wide) -> wide3:
    """Projection onto the disc of radius ``most``."""
    length = wp.length(tangential)
    cut = tangential
    if length > most:
        cut = tangential * (most / length)
    return cut


@wp.func
def projected(percussion: wide3, normal: wide3, friction: wide) -> wide3:
    """Normal part into R+, then the tangential one onto the disc of radius mu P_N."""
    along = wp.dot(percussion, normal)
    pressed = wp.max(wide(0.0), along)
    return pressed * normal + capped(percussion - along * normal, friction * pressed)


@wp.func
def prepared(contact: Contact, body: Body) -> Contact:
    """The contact with its own parts of the Delassus operator G = 1/m + a~^T I^-1 a~.

    Of the tangential block of a~^T I^-1 a~ the trace is |a|^2 tr I^-1 - a.I^-1 a - G_nn and the
    determinant (a.cof(I^-1) a) (a.n)^2, because a itself is its null vector.
    """
    arm = contact.arm
    n = contact.normal
    ready = contact
    ready.turn = body.inverse_inertia @ wp.skew(arm)
    ready.push = body.inverse_mass * n + wp.cross(ready.turn @ n, arm)
    ready.normal_yield = wp.dot(n, ready.push)
    ready.normal_relief = wide(1.0) / ready.normal_yield
    trace = wp.length_sq(arm) * wp.trace(body.inverse_inertia)
    trace -= wp.dot(arm, body.inverse_inertia @ arm) + ready.normal_yield - body.inverse_mass
    along = wp.dot(arm, n)
    determinant = wp.dot(arm, body.cofactor @ arm) * along * along
    spread = wp.sqrt(wp.max(wide(0.0), trace * trace - wide(4.0) * determinant))
    ready.tangent_yield = body.inverse_mass + wide(0.5) * (trace + spread)
    ready.tangent_relief = wide(1.0) / ready.tangent_yield
    ready.percussion = projected(contact.percussion, n, contact.friction)
    return ready


@inlined()
def sweep(
    contacts: wp.array(dtype=Contact, ndim=2),
    slot: int,
    count: int,
    body: Body,
    frozen: int,
    solved: Solved,
) -> Solved:
    """One pass of Gauss-Seidel over the contacts, normal part first."""
    twist = solved.twist
    residual = wide(0.0)
    for c in range(count):
        arm = contacts[slot, c].arm
        n = contacts[slot, c].normal
        p = contacts[slot, c].percussion
        pressed = wp.dot(p, n)
        tangential = p - pressed * n
        seen = velocity_at(twist, arm)
        along = wp.dot(seen, n)
        pull = contacts[slot, c].normal_relief * (along + contacts[slot, c].bias)
        change = wp.max(wide(0.0), pressed - pull) - pressed
        gained = contacts[slot, c].normal_yield * change
        pressed += change
        slide = seen + change * contacts[slot, c].push - (along + gained) * n
        most = contacts[slot, c].friction * pressed
        if frozen == 1:
            most = contacts[slot, c].limit
        grip = capped(tangential - contacts[slot, c].tangent_relief * slide, most)
        moved = grip - tangential
        kick = change * n + moved
        twist.velocity += body.inverse_mass * kick
        twist.spin += contacts[slot, c].turn @ kick
        contacts[slot, c].percussion = pressed * n + grip
        slipped = contacts[slot, c].tangent_yield * wp.length(moved)
        residual = wp.max(residual, wp.max(wp.abs(gained), slipped))
    after = solved
    after.twist = twist
    after.residual = residual
    after.sweeps = solved.sweeps + 1
    return after


@inlined()
def freeze(contacts: wp.array(dtype=Contact, ndim=2), slot: int, count: int, share: wide):
    """Move the frozen friction bounds by ``share`` of the way to mu P_N."""
    for c in range(count):
        n = contacts[slot, c].normal
        pressed = wp.max(wide(0.0), wp.dot(contacts[slot, c].percussion, n))
        bound = contacts[slot, c].friction * pressed
        limit = contacts[slot, c].limit
        contacts[slot, c].limit = limit + share * (bound - limit)


@inlined()
def remember(
    contacts: wp.array(dtype=Contact, ndim=2),
    iterates: wp.array(dtype=Iterates, ndim=2),
    slot: int,
    count: int,
    known: int,
) -> wp.vec2d:
    """Take in a sweep's result; weights of the last two differences that minimise the change."""
    s11 = wide(0.0)
    s12 = wide(0.0)
    s22 = wide(0.0)
    b1 = wide(0.0)
    b2 = wide(0.0)
    for c in range(count):
        p = contacts[slot, c].percussion
        change = p - iterates[slot, c].before
        if known > 0:
            iterates[slot, c].step2 = iterates[slot, c].step1
            iterates[slot, c].turn2 = iterates[slot, c].turn1
            step = p - iterates[slot, c].last
            turn = change - iterates[slot, c].change
            iterates[slot, c].step1 = step
            iterates[slot, c].turn1 = turn
            s11 += wp.dot(turn, turn)
            b1 += wp.dot(turn, change)
            if known > 1:
                older = iterates[slot, c].turn2
                s12 += wp.dot(turn, older)
                s22 += wp.dot(older, older)
                b2 += wp.dot(older, change)
        iterates[slot, c].last = p
        iterates[slot, c].change = change
    weights = wp.vec2d(wide(0.0), wide(0.0))
    determinant = s11 * s22 - s12 * s12
    if known > 1 and determinant > PARALLEL * s11 * s22:
        weights = wp.vec2d(s22 * b1 - s12 * b2, s11 * b2 - s12 * b1) / determinant
    elif known > 0 and s11 > wide(0.0):
        weights = wp.vec2d(b1 / s11, wide(0.0))
    return weights


@inlined()
def extrapolate(
    contacts: wp.array(dtype=Contact, ndim=2),
    iterates: wp.array(dtype=Iterates, ndim=2),
    slot: int,
    count: int,
    body: Body,
    weights: wp.vec2d,
    twist: Twist,
) -> Twist:
    """Take the differences off the percussions, back into their cones."""
    after = twist
    for c in range(count):
        p = contacts[slot, c].percussion
        wanted = p - weights[0] * iterates[slot, c].step1
        if weights[1] != wide(0.0):
            wanted -= weights[1] * iterates[slot, c].step2
        kept = projected(wanted, contacts[slot, c].normal, contacts[slot, c].friction)
        after = struck(after, body, contacts[slot, c].arm, kept - p)
        contacts[slot, c].percussion = kept
    return after


@inlined()
def solve(
    contacts: wp.array(dtype=Contact, ndim=2),
    iterates: wp.array(dtype=Iterates, ndim=2),
    slot: int,
    count: int,
    body: Body,
    twist: Twist,
    tolerance: wide,
    most: int,
    accelerate_from: int,
) -> Solved:
    """Sweep until no contact velocity changes by more than ``tolerance`` [m/s].

    ``most`` sweeps as they are, then as many with frozen friction bounds.
    """
    solved = Solved()
    solved.twist = twist
    best = wide(wp.inf)
    known = int(0)
    running = int(1)
    while running == 1:
        accelerate = int(0)
        if accelerate_from > 0 and solved.sweeps + 1 >= accelerate_from and solved.frozen == 0:
            accelerate = 1
            for c in range(count):
                iterates[slot, c].before = contacts[slot, c].percussion
        solved = sweep(contacts, slot, count, body, solved.frozen, solved)
        if solved.residual <= tolerance:
            solved.converged = 1
            running = 0
        elif solved.sweeps >= 2 * most:
            running = 0
        elif solved.frozen == 0 and solved.sweeps >= most:
            solved.frozen = 1
            freeze(contacts, slot, count, wide(1.0))
        elif solved.frozen == 1 and solved.sweeps % RENEWAL == 0:
            freeze(contacts, slot, count, wide(0.5))
        if accelerate == 1 and running == 1 and solved.frozen == 0:
            if solved.residual > ASTRAY * best:
                known = 0
            best = wp.min(best, solved.residual)
            weights = remember(contacts, iterates, slot, count, known)
            known = wp.min(known + 1, 2)
            if weights[0] != wide(0.0) or weights[1] != wide(0.0):
                solved.twist = extrapolate(
                    contacts, iterates, slot, count, body, weights, solved.twist
                )
    return solved


@inlined()
def passive_share(
    contacts: wp.array(dtype=Contact, ndim=2),
    slot: int,
    count: int,
    start: Twist,
    free: Twist,
    end: Twist,
) -> wide:
    """Largest share a <= 1 of all percussions that adds no energy; the cones allow any.

    Their work is a S1 / 2 + a^2 S2 / 2, S1 = sum P.(gamma_start + gamma_free), S2 = sum
    P.(gamma_end - gamma_free).
    """
    s1 = wide(0.0)
    s2 = wide(0.0)
    for c in range(count):
        p = contacts[slot, c].percussion
        arm = contacts[slot, c].arm
        unmoved = velocity_at(free, arm)
        s1 += wp.dot(p, velocity_at(start, arm) + unmoved)
        s2 += wp.dot(p, velocity_at(end, arm) - unmoved)
    share = wide(1.0)
    if s1 + s2 > wide(0.0):
        share = wide(0.0)
        if s1 < wide(0.0):
            share = -s1 / s2
    return share
