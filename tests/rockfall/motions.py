"""Rocks whose motion is known in closed form, flown at a fixed step; what they do and should do."""

from functools import cache
from math import cos, pi, sin, sqrt, tan
from types import SimpleNamespace

import numpy as np
from slopes import G, ball, box, box_skin, corners, fixed_step, flyer, law, plane, site_on, starts

from warpdem.geometry.orientation import matrix, product
from warpdem.rockfall.flights import COUNTS, Fate
from warpdem.rockfall.rock import Rock

WEIGHTLESS = (0.0, 0.0, 0.0)


def flown(site, rock, method, begin):
    return flyer(site, [rock], method).fly(begin)


def sampled(site, rock, method, begin, every=0.0):
    return flyer(site, [rock], method).follow(begin, every)[0]


def about_y(angle):
    return (cos(angle / 2), 0.0, sin(angle / 2), 0.0)


def rotation_zyx(x, y, z):
    """R_z R_y R_x as a quaternion w, x, y, z."""
    turns = [
        (cos(z / 2), 0, 0, sin(z / 2)),
        (cos(y / 2), 0, sin(y / 2), 0),
        (cos(x / 2), sin(x / 2), 0, 0),
    ]
    return product(product(turns[0], turns[1]), turns[2])


def bouncing_balls(drop, restitution, dt, duration, phases=8, skip="jump"):
    """Ways of balls that fall from ``drop``, and their clocks' advance [s].

    Each has fallen already for another part of a step, so that it meets the ground at another
    phase of its steps.
    """
    site = site_on(plane(), law(0.0, restitution=restitution))
    early = dt * (np.arange(phases) + 0.5) / phases
    at = np.column_stack([0 * early, 0 * early, 0.1 + drop - 0.5 * G * early**2])
    begin = starts(at)
    begin.velocity[:, 2] = -G * early
    method = fixed_step(dt, duration, skip=skip)
    ways = flyer(site, [ball(0.1)], method).follow(begin, 0.0)
    return [(way.time + early[k], way) for k, way in enumerate(ways)]


def impacts_of(time, way):
    """Middles of the steps in which a ball turns up, and the heights it then rises to."""
    speed = way.velocity[:, 2]
    at = np.flatnonzero((speed[:-1] < 0.0) & (speed[1:] > 0.0))
    step = time[at + 1] - time[at]
    peak = way.position[at + 1, 2] - 0.1 + speed[at + 1] ** 2 / (2.0 * G)
    return time[at + 1] - 0.5 * step, peak


def resting_since(time, way, dt):
    """When a ball's speed has become less than 3 g dt for good."""
    return time[np.flatnonzero(np.abs(way.velocity[:, 2]) > 3.0 * G * dt)[-1] + 1]


def height_of_bounces(time, drop, restitution):
    """Height of a ball that falls from ``drop`` at each time [m]."""
    time = np.asarray(time)
    height = drop - 0.5 * G * time**2
    begin, speed = sqrt(2.0 * drop / G), sqrt(2.0 * G * drop)
    for _ in range(40):
        speed *= restitution
        after = time - begin
        height = np.where(after > 0.0, speed * after - 0.5 * G * after**2, height)
        begin += 2.0 * speed / G
    return height


def height_errors(dt, drop=1.0, restitution=0.8, duration=1.5):
    """Largest misses of the heights of balls that bounce until ``duration``, one a phase [m]."""
    errors = []
    for time, way in bouncing_balls(drop, restitution, dt, duration, skip="none"):
        exact = height_of_bounces(time, drop, restitution)
        errors.append(np.abs(way.position[:, 2] - 0.1 - exact).max())
    return np.array(errors)


def slide(mu, angle, speed):
    """Way on which friction stops a slider on a slope [m]."""
    return speed**2 / (2.0 * G * (mu * cos(angle) - sin(angle)))


def stop_of_slider(mu, angle, azimuth, dt, speed=5.0):
    """Way of a flat block that slides down until friction stops it [m]."""
    down = np.array([cos(azimuth), sin(azimuth)])
    site = site_on(plane(tuple(-tan(angle) * down)), law(mu))
    block = box((1.0, 1.0, 0.1))
    normal = np.array([sin(angle) * down[0], sin(angle) * down[1], cos(angle)])
    axis = np.array([-down[1], down[0], 0.0])
    turn = (cos(angle / 2), *(sin(angle / 2) * axis))
    along = np.array([cos(angle) * down[0], cos(angle) * down[1], -sin(angle)])
    # a nanometre deep, so that the first step has its contacts whatever the rounding
    begin = starts([(0.05 - 1e-9) * normal], velocity=speed * along, orientation=turn)
    end = flown(site, block, fixed_step(dt, 30.0), begin)
    assert end.fate[0] == Fate.REST
    return float((end.position[0] - end.start[0]) @ along)


def ball_that_slips(speed, mu, radius, part, dt, duration):
    """Way of a ball of inertia ``part`` m R^2 that starts without spin."""
    solid = ball(radius, 1.0)
    rock = Rock(
        "ball", solid.vertices, radius, solid.edges, 1.0, np.full(3, part * radius**2),
        solid.skin_points, solid.skin_triangles,
    )  # fmt: skip
    begin = starts([[0, 0, radius]], velocity=[speed, 0, 0])
    return sampled(site_on(plane(), law(mu)), rock, fixed_step(dt, duration), begin)


def rolling_since(way, radius):
    """Index of the first sample at which a ball does not slip any more."""
    slip = np.abs(way.velocity[:, 0] - way.spin[:, 1] * radius)
    return int(np.flatnonzero(slip > 1e-9 * way.velocity[0, 0])[-1]) + 1


def edge_roll(dt, side=1.0, spin=2.0):
    """Part of its spin that a cube keeps whose front lower edge lands while it turns on the rear.

    Without weight: what one percussion does.
    """
    arm = np.array([side / 2, 0.0, side / 2])
    velocity = np.cross([0.0, spin, 0.0], arm)
    begin = starts([[0, 0, side / 2]], velocity=velocity, spin=[0, spin, 0])
    method = fixed_step(dt, 0.5 * dt, skip="none", tolerance=1e-12, gravity=WEIGHTLESS)
    end = flown(site_on(plane(), law(50.0)), box((side,) * 3), method, begin)
    return end.spin[0, 1] / spin


def vertex_impact(size, density, turn, velocity, spin, mu, restitution, dt):
    """A box after one step in which its lowest corner hits the ground."""
    lowest = (matrix(turn) @ corners(size).T)[2].min()
    method = fixed_step(dt, dt / 2, gravity=WEIGHTLESS, tolerance=1e-14, skip="none")
    begin = starts([[0, 0, -lowest]], velocity=velocity, orientation=turn, spin=spin)
    rock = box(size, density * float(np.prod(size)))
    return flown(site_on(plane(), law(mu, restitution=restitution)), rock, method, begin)


def free_rotor(moments, spin, dt, duration, gyroscope="midpoint"):
    """Where a rotor without forces has turned to after a whole number of steps."""
    moments, skin = np.asarray(moments, float), box_skin((1, 1, 1))
    rotor = Rock("rotor", corners((1, 1, 1)), 0.0, box().edges, 1.0, moments, *skin)
    method = fixed_step(dt, duration - dt / 2, gravity=WEIGHTLESS, gyroscope=gyroscope, skip="none")
    return flown(site_on(plane(), law(0.5)), rotor, method, starts([[0, 0, 50]], spin=spin))


def body_spin(end):
    return matrix(end.orientation[0]).T @ end.spin[0]


def bipyramid():
    """Two pyramids on an upright square waist: it slides on two corners, its centre 1 m above."""
    waist = [[x, 0.0, z] for x in (-1.0, 1.0) for z in (-1.0, 1.0)]
    points = np.array([*waist, [0, 1.5, 0], [0, -1.5, 0]])
    # a square pyramid of height h: 3 (2 a)^2 / 60 + ... about the common base, both halves alike
    mass = 100.0
    square, across = mass * 4.0 / 20.0, mass * 1.5**2 / 10.0
    moments = np.array([square + across, 2.0 * square, square + across])
    return Rock("bipyramid", points, 0.0, np.array([[0, 1]]), mass, moments, *box_skin((1, 1, 1)))


LEINE = SimpleNamespace(
    mu_min=0.2,
    mu_max=1.3,
    kappa=0.7,
    way=tan(pi / 2 * (1.0 - 0.2) / (1.3 - 0.2)) / 0.7,
)
"""Example 5.1 of Leine et al. (2014): mu(s*) = 1 at s* = tan(pi/2 (1 - mu_min)/(mu_max - mu_min))
/ kappa, 3.1281 m."""


def way_until_it_opens(dt, tolerance=1e-8):
    """Way that the bipyramid of example 5.1 slides until its rear contact opens [m]."""
    kind = law(LEINE.mu_min, mu_max=LEINE.mu_max, kappa=LEINE.kappa)
    normal, along = np.array([1.0, 0, 1.0]) / sqrt(2.0), np.array([1.0, 0, -1.0]) / sqrt(2.0)
    # a micrometre deep, so that both contacts are closed from the start
    begin = starts([(1.0 - 1e-6) * normal], velocity=along, orientation=about_y(pi / 4))
    method = fixed_step(dt, 1.5, skip="none", tolerance=tolerance)
    way = sampled(site_on(plane((-1.0, 0.0)), kind), bipyramid(), method, begin)
    rear = np.einsum("nij,j->ni", matrix(way.orientation), [-1.0, 0.0, -1.0])
    opening = (way.velocity + np.cross(way.spin, rear)) @ normal
    slid = (way.position - way.position[0]) @ along
    return slid[opening <= 1e-7][-1]


def painleve(angle):
    """Least friction at which a sliding rod has no percussion: 4/3 at its least over all angles."""
    return (1.0 + 3.0 * cos(angle) ** 2) / (3.0 * sin(angle) * cos(angle))


@cache
def rod():
    points = np.array([[0.5, 0.0, 0.0], [-0.5, 0.0, 0.0]])
    moments = np.array([1e-3, 1.0 / 12.0, 1.0 / 12.0])
    return Rock("rod", points, 0.0, np.array([[0, 1]]), 1.0, moments, *box_skin((1, 1, 1)))


def rod_jams(mu, angle, dt=1e-6):
    """Whether a rod that slides on its tip needs frozen friction bounds in one step."""
    # it leans forward over its tip and slides backwards: friction turns the tip into the ground
    centre = [0.5 * cos(angle), 0.0, 0.5 * sin(angle)]
    begin = starts([centre], velocity=[-1.0, 0, 0], orientation=about_y(-angle))
    method = fixed_step(dt, 0.5 * dt, skip="none", tolerance=1e-10)
    end = flown(site_on(plane(), law(mu)), rod(), method, begin)
    assert end.counts[0, COUNTS.index("contact_steps")] == 1
    return bool(end.counts[0, COUNTS.index("frozen")] + end.counts[0, COUNTS.index("unconverged")])
