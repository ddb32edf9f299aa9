"""Impacts of balls, measured: what one simulation of eight onset phases says of a collision.

A ball touches at a random instant of a step, so each impact is run at eight phases of the step at
once, side by side, and its time counts from the touch.
"""

import numpy as np
from gates import gate

from scenes import ball, body, laboratory, law, record

PHASES = 8
# times of contact until even balls with a strong dashpot have parted
LASTING = 3
# of balls that are to meet no floor [m]
HIGH = 10.0
RADIUS = 0.1


def order_of(error, steps):
    """Slope of log ``error(steps)`` over log 1/steps, the number of steps in a contact."""
    return -np.polyfit(np.log(steps), np.log([error(n) for n in steps]), 1)[0]


def rms(values):
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def approaching(*, mass, other=None, rules, speed, dt, **run):
    """Simulation of eight head-on collisions, and the time until each pair touches [s].

    Args:
        mass: Of the balls that move [kg].
        other: Of the balls that they hit at rest, None for the floor [kg].
        rules: Law of contact.
        speed: Of the approach [m/s].
        dt: Time step [s].
        run: Further keys of the scene's run.
    """
    wait = dt * (np.arange(PHASES) + 0.5) / PHASES
    base = 0.0 if other is None else HIGH + RADIUS
    bodies = [
        body("ball", [k, 0.0, base + RADIUS + gap], mass=mass, velocity=[0.0, 0.0, -speed])
        for k, gap in enumerate(speed * wait)
    ]
    if other is not None:
        bodies += [body("ball", [k, 0.0, HIGH], mass=other) for k in range(PHASES)]
    return laboratory([ball("ball", RADIUS)], bodies, rules, dt=dt, **run), wait


def restitution(*, speed, steps, duration, **collision):
    """Speed of parting over that of approach, shape [phase_count], at so many steps a contact."""
    simulation, _ = approaching(speed=speed, dt=duration / steps, **collision)
    simulation.advance((LASTING + 2.0 / steps) * duration)
    after = simulation.snapshot().velocity[:, 2]
    under = after[PHASES : 2 * PHASES] if len(after) > PHASES + 1 else 0.0
    return (after[:PHASES] - under) / speed


class Collision:
    """Overlap, approach and force of eight head-on collisions over the time since the touch.

    Args:
        speed, collision: As of ``approaching``.
        steps: In the time of contact.
        duration: Time of contact [s].

    Attributes:
        time: Since the touch [s], shape [shot_count, phase_count].
        overlap, approach, force: [m], [m/s], [N], same shape.
        first, second: Velocities of the two balls along the approach at the end [m/s], shape
            [phase_count].
        spent: What the dashpots took in all, by the simulation's account [J].
    """

    def __init__(self, *, steps, duration, **collision):
        simulation, wait = approaching(dt=duration / steps, **collision)
        shots = record(simulation, LASTING * steps + 2)
        z, v, force = (
            np.array([getattr(shot, name)[:-1, 2] for shot in shots])
            for name in ("position", "velocity", "force")
        )
        self.time = np.array([shot.time for shot in shots])[:, None] - wait
        self.overlap, self.approach = RADIUS - z[:, :PHASES], -v[:, :PHASES]
        if z.shape[1] > PHASES:
            self.overlap += z[:, PHASES:] + RADIUS
            self.approach += v[:, PHASES:]
        self.force = force[:, :PHASES]
        self.first = -v[-1, :PHASES]
        self.second = -v[-1, PHASES:] if z.shape[1] > PHASES else np.zeros(PHASES)
        self.spent = shots[-1].energy.dashpot

    def each(self, measure):
        """A measure of one collision, for each phase."""
        columns = (self.time, self.overlap, self.approach, self.force)
        return np.array([measure(*(c[:, k] for c in columns)) for k in range(PHASES)])


def turning(time, overlap, approach, force):
    """Time and value of the largest overlap: cubic through the two states around it."""
    after = int(np.argmax(approach < 0.0))
    h = time[after] - time[after - 1]
    slope = np.poly1d(hermite(overlap, approach, after, h)).deriv()
    s = min((r.real for r in slope.r if abs(r.imag) < 1e-9), key=lambda r: abs(r - 0.5))
    return time[after - 1] + s * h, np.polyval(hermite(overlap, approach, after, h), s)


def hermite(x, v, after, h):
    """Cubic in s from 0 to 1 between the states ``after`` - 1 and ``after``."""
    a, b, da, db = x[after - 1], x[after], h * v[after - 1], h * v[after]
    return [2 * (a - b) + da + db, 3 * (b - a) - 2 * da - db, da, a]


def largest_force(time, overlap, approach, force):
    """Peak of the parabola through the three largest forces, or the force of the first instant.

    The first force of a contact stands for all the time before it: left out.
    """
    settled = int(np.argmax(force > 0.0)) + 1
    top = settled + int(np.argmax(force[settled:]))
    if top > settled:
        t = time[top - 1 : top + 2] - time[top]
        c = np.polyfit(t, force[top - 1 : top + 2], 2)
        return float(c[2] - c[1] ** 2 / (4.0 * c[0]))
    sample = slice(settled, settled + 4)
    return float(np.polyfit(time[sample], force[sample], 3)[-1])


def release(time, overlap, approach, force):
    """Time and overlap where the force ends: parabola through its last three values."""
    last = int(np.flatnonzero(force > 0.0)[-1])
    t = time[last - 2 : last + 1] - time[last]
    roots = np.roots(np.polyfit(t, force[last - 2 : last + 1], 2))
    s = float(min(abs(roots.real)))
    deceleration = np.polyfit(t, approach[last - 2 : last + 1], 2)
    gained = np.polyval(np.polyint(deceleration), s)
    return time[last] + s, overlap[last] + gained


def parting(time, overlap, approach, force):
    """Time at which the balls part, in free flight."""
    return time[-1] - overlap[-1] / approach[-1]


class Grazing:
    """A ball that hits the floor obliquely or spinning, free of gravity.

    The laws are homogeneous, so the motion is run at ``SLOW`` times its velocities: the overlap is
    then too small to shorten the arm of friction, which the formulas take as the radius.

    Args:
        beta: Moment of inertia over m R^2.
        rules: Law of contact.
        fall, slide: Velocities of the centre towards the floor and along it [m/s].
        spin: Speed of the contact point by rotation, along the slide where positive [m/s].
        steps: In the time of contact.
        duration: Time of contact [s].

    Attributes:
        rebound, along: Velocity from the floor and along it after the impact [m/s], shape
            [phase_count].
        turning: Speed that rotation then gives the contact point against the slide [m/s].
        slip: Of the contact point along the slide, the difference of the two [m/s].
    """

    SLOW = gate(1e-5, mixed=1e-2)

    def __init__(self, *, mass, rules, fall, slide=0.0, spin=0.0, steps, duration, beta=0.4, **run):
        dt = duration / steps
        late = self.SLOW * fall * dt * (np.arange(PHASES) + 0.5) / PHASES
        bodies = [
            body(
                "ball",
                [k, 0.0, RADIUS + gap],
                mass=mass,
                velocity=[self.SLOW * slide, 0.0, -self.SLOW * fall],
                spin=[0.0, -self.SLOW * spin / RADIUS, 0.0],
            )
            for k, gap in enumerate(late)
        ]
        shapes = [ball("ball", RADIUS, beta=beta)]
        simulation = laboratory(shapes, bodies, rules, dt=dt, **run)
        simulation.advance(2.0 * duration + 2.0 * dt)
        while (end := simulation.snapshot(contacts=True)).contacts.gap.size:
            simulation.advance(simulation.time + duration)
        self.rebound = end.velocity[:PHASES, 2] / self.SLOW
        self.along = end.velocity[:PHASES, 0] / self.SLOW
        self.turning = end.spin[:PHASES, 1] * RADIUS / self.SLOW
        self.slip = self.along - self.turning


def bounces(*, mass, kn, zeta, height, g, steps, count):
    """Touch times [s], touch speeds [m/s] and peak heights [m] of a ball let fall on the floor.

    Free flight is exact in the simulation, so a snapshot of a flight says when and how it ends.
    """
    duration = np.pi * np.sqrt(mass / kn)
    rules = law(kn, zeta=zeta)
    shapes, bodies = [ball("ball", RADIUS)], [body("ball", [0.0, 0.0, RADIUS + height], mass=mass)]
    simulation = laboratory(shapes, bodies, rules, dt=duration / steps, gravity=[0.0, 0.0, -g])
    flights, flying = [], False
    while len(flights) < count or flying:
        shot = simulation.snapshot()
        gap, v = shot.position[0, 2] - RADIUS, shot.velocity[0, 2]
        if gap > 0.0:
            speed = float(np.sqrt(v * v + 2.0 * g * gap))
            flight = (shot.time + (v + speed) / g, speed, speed**2 / (2.0 * g))
            flights[len(flights) - flying :] = [flight]
        flying = gap > 0.0
        simulation.advance(simulation.time + duration / 4.0)
    times, speeds, peaks = zip(*flights[:count], strict=True)
    return times, speeds, peaks[1:]
