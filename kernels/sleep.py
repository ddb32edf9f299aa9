"""Sleep: what a body at rest leaves out, and when it wakes.

A body that sleeps does not move, and a pair of which neither body can move is not evaluated: its
wrench, what it remembers and what it stores stay as they are. A body wakes within the step in which
the wrench of its contacts has changed by more than a tolerance, by whatever cause; so what disturbs
a pile goes on through it, contact by contact. See falling_asleep.py for the way in.
"""

import functools

import warp as wp
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.precision import vec3, wide
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Bonds, Geometry, Incidence, Joints, Pairs, Sleep


@inlined()
def stand_still(sleep: Sleep, i: int, j: int) -> bool:
    """Whether neither body of a pair can move: each sleeps, or is fixed and not driven."""
    return sleep.asleep[i] != 0 and sleep.asleep[j] != 0


@inlined()
def kept_wrench(pairs: Pairs, pair: int, d: vec3):
    """Force [N] and torque [N m] on the owner of a pair of spheres that was not evaluated."""
    force = vec3()
    torque = vec3()
    if pairs.touching[pair] != 0:
        force = pairs.force[pair]
        torque = -pairs.torque_partner[pair] - wp.cross(d, force)
    return force, torque


@inlined()
def time_slow(geometry: Geometry, bodies: Bodies, body: int, dt: wide):
    """Time for how long the farthest point of a body has been slow."""
    pace = wp.length(bodies.velocity[body]) + geometry.bound[body] * wp.length(bodies.spin[body])
    slow = wide(0.0)
    if pace < bodies.sleep.speed:
        slow = bodies.sleep.slow[body] + dt
    bodies.sleep.slow[body] = slow


@inlined()
def stir(pairs: Pairs, incidence: Incidence, bodies: Bodies, body: int):
    """Have all bodies in the pairs of one that wakes look at their forces.

    Some look in this pass already and some in the next one, with the same outcome: forces change
    later.
    """
    first, others, count = pairs_of(incidence, body)
    for k in range(count):
        code = pair_at(incidence, body, first, others, k)
        if (code & 1) == 0:
            bodies.sleep.deep[pairs.partner[code >> 1]] = 0
        else:
            bodies.sleep.deep[pairs.owner[code >> 1]] = 0
    bodies.sleep.deep[body] = 0


@functools.cache
def dormancy(gather_all: wp.Function) -> wp.Function:
    """Function that says whether a body goes on sleeping, and wakes it where not.

    Looked at where forces are known, at a kick; ``gather_all`` sums those of a body.
    """

    @inlined()
    def dormant(
        geometry: Geometry,
        pairs: Pairs,
        incidence: Incidence,
        glue: Bonds,
        joined: Joints,
        bodies: Bodies,
        body: int,
        kicks: int,
    ) -> bool:
        if bodies.sleep.asleep[body] == 0:
            return False
        if kicks != 0 and bodies.sleep.deep[body] == 0:
            force, torque = gather_all(pairs, incidence, glue, joined, bodies, body)
            allowed = bodies.sleep.allowed[body]
            pushed = wp.length(force - bodies.sleep.force[body])
            turned = wp.length(torque - bodies.sleep.torque[body])
            if not (pushed <= allowed and turned <= allowed * geometry.bound[body]):
                bodies.sleep.asleep[body] = 0
                bodies.sleep.allowed[body] = wide(-1.0)
                bodies.sleep.slow[body] = wide(0.0)
                bodies.sleep.woken[body] = bodies.sleep.woken[body] + 1
                stir(pairs, incidence, bodies, body)
                return False
        return True

    return dormant
