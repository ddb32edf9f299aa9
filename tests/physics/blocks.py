"""Blocks, measured: on a slope, in columns and stacks, on one corner."""

import numpy as np

from scenes import DEPTH, ball, body, box, laboratory, law, record, tilted
from warpdem.geometry.orientation import product
from warpdem.geometry.orientation import turned as rotated

SHARP = 1e-9


def on_slope(*, angle, mu, base, height, rounding, g, kn, kt, duration, stiffer=1.0):
    """A block let go on a slope down its base's edge; what it does, and the loads of its corners.

    The formulas are those of a rigid block: an overlap d shortens the arm of friction by d/2. With
    ``stiffer`` springs that is small.
    """
    rounding = rounding or SHARP
    kn, kt = stiffer * kn, stiffer * kt
    overlap = g * np.cos(angle) / (4.0 * kn)
    shape = box("block", (base, base, height), rounding=rounding)
    start = body("block", [0.0, 0.0, 0.5 * height - overlap])
    rules = law(kn, kt=kt, mu=mu, zeta=0.5)
    simulation = laboratory(
        [shape], [start], rules, dt="auto", gravity=tilted(angle, g), duration=duration
    )
    simulation.advance(0.5 * duration)
    middle = simulation.snapshot()
    simulation.advance(duration)
    shot = simulation.snapshot(contacts=True)
    front = shot.contacts.point[:, 0] > shot.position[0, 0]
    force = shot.contacts.normal_force
    tangential = np.linalg.norm(shot.contacts.tangential_force, axis=1)
    return {
        "tilt": 2.0 * abs(shot.orientation[0, 2]),
        "speed": shot.velocity[0, 0],
        "acc_slide": (shot.velocity - middle.velocity)[0, 0] / (shot.time - middle.time),
        "front": force[front],
        "back": force[~front],
        "mean_overlap": -stiffer * shot.contacts.gap.mean() if force.size else 0.0,
        "offset": stiffer * tangential.mean() / kt if force.size else 0.0,
        "steps": shot.step,
    }


class Column:
    """Balls of mass 1 one upon another, exactly in line: springs k in series.

    Attributes:
        simulation: Of the column; ball 0 at the bottom.
    """

    RADIUS = 0.05

    def __init__(self, *, count, k, g, dt, zeta=0.0, overlaps=None, **run):
        overlaps = np.zeros(count) if overlaps is None else np.asarray(overlaps)
        heights = self.RADIUS * (2.0 * np.arange(count) + 1.0) - np.cumsum(overlaps)
        bodies = [body("ball", [0.0, 0.0, z]) for z in heights]
        shapes, rules, gravity = [ball("ball", self.RADIUS)], law(k, zeta=zeta), [0.0, 0.0, -g]
        self.count = count
        self.simulation = laboratory(shapes, bodies, rules, dt=dt, gravity=gravity, **run)

    def overlaps(self):
        """Of each ball with the one below or the floor [m], shape [count]."""
        z = self.simulation.snapshot().position[: self.count, 2]
        return 2.0 * self.RADIUS - np.diff(z, prepend=-self.RADIUS)


def leap(simulation, dt):
    """Go on with a step that the scene would be refused with."""
    simulation._next_dt = dt
    simulation._change_step()


def chain_mode(count, number):
    """Frequency over sqrt(k/m), and shape, of a mode of a column: fixed below, free above."""
    angle = (2 * number - 1) * np.pi / (2 * count + 1)
    return 2.0 * np.sin(0.5 * angle), np.sin(angle * np.arange(1, count + 1))


def mode_frequency(*, count, number, k, g, dt):
    """Frequency [rad/s] of a mode of an undamped column, from three states a radian apart."""
    static = g * np.arange(count, 0, -1) / k
    ratio, shape = chain_mode(count, number)
    start = static - 1e-3 * static[-1] * np.diff(shape, prepend=0.0)
    column = Column(count=count, k=k, g=g, dt=dt, overlaps=start)
    rest = column.RADIUS * (2.0 * np.arange(count) + 1.0) - np.cumsum(static)
    apart = max(1, round(1.0 / (ratio * np.sqrt(k) * dt)))
    shots = record(column.simulation, 2 * apart)[::apart]
    a, b, c = ((shot.position[:count, 2] - rest) @ shape for shot in shots)
    return np.arccos((a + c) / (2.0 * b)) / (apart * dt)


def growth(*, count, k, g, dt, zeta=0.0, steps=400, **run):
    """By how much a small disturbance of a resting column grows in so many steps."""
    static = g * np.arange(count, 0, -1) / k
    small = 1e-8 * static[-1]
    start = static.copy()
    start[0] += small
    column = Column(count=count, k=k, g=g, dt=0.1 * dt, zeta=zeta, overlaps=start, **run)
    leap(column.simulation, dt)
    most = 0.0
    while column.simulation.step_count < steps and most < 1e4:
        column.simulation.advance(column.simulation.time + 20 * dt)
        shots = record(column.simulation, 4)
        z = np.array([shot.position[:count, 2] for shot in shots])
        overlaps = 2.0 * column.RADIUS - np.diff(z, axis=1, prepend=-column.RADIUS)
        most = np.abs(overlaps - static).max() / small
    return most


def limit_of_stability(low, high, **column):
    """The step at which disturbances of a column begin to grow [s], to 0.1 %."""
    while high > 1.001 * low:
        middle = 0.5 * (low + high)
        grows = growth(dt=middle, **column) > 1e3
        low, high = (low, middle) if grows else (middle, high)
    return 0.5 * (low + high)


def overhang(*, shifts, length, share, duration, g=9.81, kn=1e6, height=0.2, rounding=0.01):
    """Largest tilt [rad] of a stack in which each block overhangs the next by ``share`` of shifts.

    ``shifts`` are from the top to the floor's edge; ``length`` is that of the cores, on whose edges
    the blocks stand. Each block is narrower than the next, so that the edges in between cross.
    """
    count = len(shifts)
    edge = 200.0 - DEPTH
    # the foremost point of block k lies so far beyond the edge of the floor
    ahead = share * np.cumsum(shifts[::-1])[::-1]
    shapes, bodies = [], []
    for k in range(count):
        width = 0.3 + 0.02 * k
        size = (length + 2 * rounding, width + 2 * rounding, height)
        shapes.append(box(f"block {k}", size, rounding=rounding))
        middle = (edge + ahead[k] - 0.5 * length, 0.0, (count - k - 0.5) * height)
        bodies.append(body(f"block {k}", middle))
    rules = law(kn, kt=0.8 * kn, mu=0.6, e=0.2)
    gravity = [0.0, 0.0, -g]
    simulation = laboratory(shapes, bodies, rules, dt="auto", duration=duration, gravity=gravity)
    simulation.advance(duration)
    vector = simulation.snapshot().orientation[:count, 1:]
    return 2.0 * np.linalg.norm(vector, axis=1).max()


def corner_impact(*, size, density, angles, velocity, spin, rules, m_eff, steps=50):
    """Velocity and spin of a sharp box after its lowest corner struck the floor, without gravity.

    ``angles`` turn it about x, then y, then z.
    """
    q = turned_about(angles)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    arms = rotated(q, corners * (0.5 * np.array(size) - SHARP))
    depth = -arms[:, 2].min() + SHARP
    mass = density * float(np.prod(size))
    block = body(
        "box",
        [0.0, 0.0, depth],
        mass=mass,
        orientation=q,
        velocity=velocity,
        spin=spin,
    )
    dt = np.pi * np.sqrt(m_eff / rules["kn"]) / steps
    simulation = laboratory([box("box", size)], [block], rules, dt=dt)
    shots = record(simulation, 2)
    while shots[-1].force[0, 2] > 0.0:
        shots += record(simulation, 1)[1:]
    return shots[-1].velocity[0], shots[-1].spin[0]


def turned_about(angles):
    """Unit quaternion w, x, y, z of turns about the fixed axes x, y, z in this order."""
    q = np.array([1.0, 0.0, 0.0, 0.0])
    for axis, angle in zip(np.eye(3), angles, strict=True):
        q = product(np.append(np.cos(angle / 2.0), np.sin(angle / 2.0) * axis), q)
    return q
