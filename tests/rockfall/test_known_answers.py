"""Rocks whose motion is known in closed form."""

from math import acos, atan2, cos, degrees, hypot, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from slopes import G, ball, box, corners, fixed_step, flyer, law, plane, site_on, starts

from warpdem.geometry.orientation import matrix, product
from warpdem.rockfall.flights import COUNTS, Fate, Method
from warpdem.rockfall.rock import Rock


def flown(site, rock, method, begin, **how):
    return flyer(site, [rock], method, **how).fly(begin)


def sampled(site, rock, method, begin, every=0.0):
    return flyer(site, [rock], method).follow(begin, every)[0]


def about_y(angle):
    return (cos(angle / 2), 0.0, sin(angle / 2), 0.0)


def bounce_error(dt):
    """Largest miss of the height of a ball that bounces twice."""
    site = site_on(plane(), law(0.0, restitution=0.8))
    way = sampled(site, ball(0.1), fixed_step(dt, 1.5, skip="none"), starts([[0, 0, 1.1]]))
    first = sqrt(2.0 / G)
    rise = 0.8 * G * first
    after = way.time - first
    second = 2.0 * rise / G
    height = np.where(
        way.time < first,
        1.0 - 0.5 * G * way.time**2,
        np.where(
            after < second,
            rise * after - 0.5 * G * after**2,
            0.8 * rise * (after - second) - 0.5 * G * (after - second) ** 2,
        ),
    )
    return np.abs(way.position[:, 2] - 0.1 - height).max()


def test_bouncing_ball_converges_with_order_one():
    coarse, fine = bounce_error(1e-2), bounce_error(1e-4)

    assert coarse < 0.08
    assert fine < 1e-3
    assert coarse / fine > 60.0


def test_ball_comes_to_rest_when_the_sum_of_its_bounces_says():
    # T = sqrt(2 h / g) (1 + e) / (1 - e), the family moreau_bounce
    site = site_on(plane(), law(0.0, restitution=0.5))
    method = fixed_step(1e-4, 10.0, skip="none")
    way = sampled(site, ball(0.1), method, starts([[0, 0, 2.1]]))

    moving = way.time[np.abs(way.position[:, 2] - 0.1) > 1e-3]
    assert moving[-1] == pytest.approx(1.9156525704423029, abs=0.05)
    assert way.position[-1, 2] == pytest.approx(0.1, abs=1e-3)


def stop_of_slider(mu, angle, azimuth, dt):
    """Way of a flat block that slides down at 5 m/s until friction stops it."""
    down = np.array([cos(azimuth), sin(azimuth)])
    site = site_on(plane(tuple(-tan(angle) * down)), law(mu))
    block = box((1.0, 1.0, 0.1))
    normal = np.array([sin(angle) * down[0], sin(angle) * down[1], cos(angle)])
    axis = np.array([-down[1], down[0], 0.0])
    turn = (cos(angle / 2), *(sin(angle / 2) * axis))
    along = np.array([cos(angle) * down[0], cos(angle) * down[1], -sin(angle)])
    begin = starts([0.05 * normal], velocity=5.0 * along, orientation=turn)
    end = flown(site, block, fixed_step(dt, 30.0), begin)
    assert end.fate[0] == Fate.REST
    return float((end.position[0] - end.start[0]) @ along)


@pytest.mark.parametrize("azimuth", [0.0, 0.7, 2.1, 4.0])
def test_slider_stops_where_friction_says(azimuth):
    # d = v0^2 / (2 g (mu cos a - sin a))
    mu, angle = 0.8, radians(25.0)
    exact = 25.0 / (2.0 * G * (mu * cos(angle) - sin(angle)))

    assert stop_of_slider(mu, angle, azimuth, 1e-2) == pytest.approx(exact, abs=2e-3)


def test_ball_rolls_at_five_sevenths_of_its_speed_when_friction_has_turned_it():
    site = site_on(plane(), law(0.3))
    begin = starts([[0, 0, 0.5]], velocity=[3.0, 0, 0])
    way = sampled(site, ball(0.5), fixed_step(1e-3, 2.0), begin)

    slipping = np.abs(way.velocity[:, 0] - way.spin[:, 1] * 0.5) > 1e-6
    assert way.time[slipping][-1] == pytest.approx(2.0 * 3.0 / (7.0 * 0.3 * G), abs=2e-3)
    assert way.velocity[-1, 0] == pytest.approx(5.0 / 7.0 * 3.0, rel=1e-12)


ROCKING = [
    # half width, half height, theta_0 / alpha, quarter times [s], spins before an impact [rad/s]
    (0.1, 0.4, 0.5, (0.3123085751126223, 0.25414182698498927), 0.8934143073025634, 0.9117647),
    (0.05, 0.25, 0.3, (0.16702115631528225, 0.1522432494228434), 0.7554534573107716, 0.9423077),
]


@pytest.mark.parametrize(("half", "tall", "part", "quarters", "before", "ratio"), ROCKING)
def test_rocking_block_follows_housner(half, tall, part, quarters, before, ratio):
    # theta'' = -p^2 sin(alpha - theta); r = 1 - 3/2 sin^2 alpha; the family rocking_block
    alpha = atan2(half, tall)
    angle = part * alpha
    radius = hypot(half, tall)
    block = box((2 * half, 0.5, 2 * tall))
    # turned about the edge x = half
    begin = starts(
        [[half - radius * sin(alpha - angle), 0, radius * cos(alpha - angle)]],
        orientation=about_y(angle),
    )
    site = site_on(plane(), law(5.0))
    method = fixed_step(1e-4, quarters[0] + 2 * quarters[1] - 0.02, skip="none")
    way = sampled(site, block, method, begin)
    spin = way.spin[:, 1]
    impact = int(np.argmax(np.diff(spin) > 0.02 * before))

    assert way.time[impact] == pytest.approx(quarters[0], abs=5e-4)
    assert -spin[impact] == pytest.approx(before, rel=2e-3)
    assert spin[impact + 2] / spin[impact] == pytest.approx(ratio, abs=2e-3)


def test_cube_that_lands_on_an_edge_keeps_a_quarter_of_its_spin():
    # about the edge it slides on: w+ / w- = 1 - 3/4 for a cube that trips over its next edge
    side, spin = 1.0, 2.0
    block = box((side,) * 3)
    site = site_on(plane(), law(50.0))
    # rotating about its lower rear edge at the moment when the front edge lands
    arm = np.array([side / 2, 0.0, side / 2])
    velocity = np.cross([0.0, spin, 0.0], arm)
    begin = starts([[0, 0, side / 2 + 1e-9]], velocity=velocity, spin=[0, spin, 0])
    way = sampled(site, block, fixed_step(1e-5, 2e-4, skip="none"), begin)

    assert way.spin[-1, 1] / spin == pytest.approx(0.25, abs=2e-3)


IMPULSES = [
    # size, mass, velocity, spin, mu, e -> velocity, spin after; the family box_impulse
    (
        (0.2, 0.2, 0.2), 8.0, (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), 0.0, 1.0,
        (0.0, 0.0, 0.066637709002479), (-19.00883425200138, -15.42718810220366, 0.0),
    ),
    (
        (0.2, 0.3, 0.5), 30.0, (1.0, 0.0, -2.0), (0.0, 3.0, 1.0), 0.0, 0.5,
        (1.0, 0.0, 0.3832637221819182),
        (-7.654072591122511, 5.156662585499514, -2.6926210517716695),
    ),
]  # fmt: skip


def rotation_zyx(x, y, z):
    """R_z R_y R_x as a quaternion w, x, y, z."""
    turns = [
        (cos(z / 2), 0, 0, sin(z / 2)),
        (cos(y / 2), 0, sin(y / 2), 0),
        (cos(x / 2), sin(x / 2), 0, 0),
    ]
    return product(product(turns[0], turns[1]), turns[2])


@pytest.mark.parametrize(("size", "mass", "v", "w", "mu", "e", "v_after", "w_after"), IMPULSES)
def test_vertex_impact_of_a_box_is_exact_in_one_step(size, mass, v, w, mu, e, v_after, w_after):
    turn = rotation_zyx(0.3, 0.4, 0.1)
    lowest = (matrix(turn) @ corners(size).T)[2].min()
    dt = 1e-9
    method = fixed_step(dt, dt / 2, gravity=(0.0, 0.0, 0.0), tolerance=1e-12)
    begin = starts([[0, 0, -lowest]], velocity=v, orientation=turn, spin=w)
    end = flown(site_on(plane(), law(mu, restitution=e)), box(size, mass), method, begin)

    assert end.counts[0, 0] == 1
    assert end.velocity[0] == pytest.approx(v_after, abs=1e-7)
    assert end.spin[0] == pytest.approx(w_after, abs=1e-6)


def free_rotor_error(dt, gyroscope="midpoint"):
    """Miss of the body spin after 1 s of a rotor without forces."""
    moments, spin = np.array([1.0, 2.0, 3.0]), np.array([1.0, 1.0, 1.0])
    skin = box().skin_points, box().skin_triangles
    rotor = Rock("rotor", corners((1, 1, 1)), 0.0, box().edges, 1.0, moments, *skin)
    method = fixed_step(dt, 1.0 - dt / 2, gravity=(0.0, 0.0, 0.0), gyroscope=gyroscope)
    begin = starts([[0, 0, 50]], spin=spin)
    end = flown(site_on(plane(), law(0.5)), rotor, method, begin, visits=gyroscope != "leine")
    body = matrix(end.orientation[0]).T @ end.spin[0]
    return np.abs(body - euler_spin(moments, spin, end.time[0])).max(), end


def euler_spin(moments, spin, until, steps=4000):
    """Euler's equations by a fine classical Runge-Kutta."""

    def rate(w):
        return -np.cross(w, moments * w) / moments

    h = until / steps
    w = spin.copy()
    for _ in range(steps):
        a = rate(w)
        b = rate(w + h / 2 * a)
        c = rate(w + h / 2 * b)
        w = w + h / 6 * (a + 2 * b + 2 * c + rate(w + h * c))
    return w


def test_free_spin_is_of_second_order_and_keeps_its_energy():
    coarse, end = free_rotor_error(1e-2)
    fine, _ = free_rotor_error(1e-3)

    body = matrix(end.orientation[0]).T @ end.spin[0]
    assert coarse / fine == pytest.approx(100.0, rel=0.1)
    assert np.array([1.0, 2.0, 3.0]) @ body**2 == pytest.approx(6.0, rel=1e-13)


def test_published_gyroscopic_term_is_of_first_order():
    coarse, _ = free_rotor_error(1e-2, "leine")
    fine, _ = free_rotor_error(1e-3, "leine")

    assert coarse / fine == pytest.approx(10.0, rel=0.2)


def bipyramid():
    """Two pyramids on an upright square waist: it slides on two corners, its centre 1 m above."""
    waist = [[x, 0.0, z] for x in (-1.0, 1.0) for z in (-1.0, 1.0)]
    points = np.array([*waist, [0, 1.5, 0], [0, -1.5, 0]])
    # a square pyramid of height h: 3 (2 a)^2 / 60 + ... about the common base, both halves alike
    mass = 100.0
    square, across = mass * 4.0 / 20.0, mass * 1.5**2 / 10.0
    moments = np.array([square + across, 2.0 * square, square + across])
    skin = box().skin_points, box().skin_triangles
    return Rock("bipyramid", points, 0.0, np.array([[0, 1]]), mass, moments, *skin)


def test_rear_contact_of_leines_bipyramid_opens_where_friction_reaches_one():
    # mu(s*) = 1: s* = tan(pi/2 (1 - mu_min) / (mu_max - mu_min)) / kappa; Leine et al., 5.1
    kind = law(0.2, mu_max=1.3, kappa=0.7)
    exact = tan(pi / 2 * (1.0 - 0.2) / (1.3 - 0.2)) / 0.7
    assert exact == pytest.approx(3.1281, abs=5e-5)
    normal, along = np.array([1.0, 0, 1.0]) / sqrt(2.0), np.array([1.0, 0, -1.0]) / sqrt(2.0)
    # a micrometre deep, so that both contacts are closed from the start
    begin = starts([(1.0 - 1e-6) * normal], velocity=along, orientation=about_y(pi / 4))
    method = fixed_step(2e-4, 1.5, skip="none", tolerance=1e-8)
    way = sampled(site_on(plane((-1.0, 0.0)), kind), bipyramid(), method, begin)

    rear = np.einsum("nij,j->ni", matrix(way.orientation), [-1.0, 0.0, -1.0])
    opening = (way.velocity + np.cross(way.spin, rear)) @ normal
    slid = (way.position - way.position[0]) @ along
    assert slid[opening <= 1e-6][-1] == pytest.approx(exact, abs=1e-2)


def frozen_steps_of_a_rod(mu, angle):
    """Steps, out of one, in which a rod that slides on its tip needs frozen friction bounds."""
    half = 0.5
    points = np.array([[half, 0.0, 0.0], [-half, 0.0, 0.0]])
    moments = np.array([1e-3, 1.0 / 12.0, 1.0 / 12.0])
    skin = box().skin_points, box().skin_triangles
    rod = Rock("rod", points, 0.0, np.array([[0, 1]]), 1.0, moments, *skin)
    # it leans forward over its tip and slides backwards: friction turns the tip into the ground
    centre = [half * cos(angle), 0.0, half * sin(angle)]
    begin = starts([centre], velocity=[-1.0, 0, 0], orientation=about_y(-angle))
    method = fixed_step(1e-6, 0.5e-6, skip="none", tolerance=1e-10)
    end = flown(site_on(plane(), law(mu)), rod, method, begin)
    assert end.counts[0, COUNTS.index("contact_steps")] == 1
    return end.counts[0, COUNTS.index("frozen")]


@pytest.mark.parametrize("angle", [atan2(2.0, 1.0), radians(50.0)])
def test_painleves_paradox_is_noticed_where_it_begins(angle):
    # mu_P = (1 + 3 cos^2) / (3 sin cos), 4/3 at its least: beyond it no sliding percussion exists
    critical = (1.0 + 3.0 * cos(angle) ** 2) / (3.0 * sin(angle) * cos(angle))

    assert frozen_steps_of_a_rod(0.99 * critical, angle) == 0
    assert frozen_steps_of_a_rod(1.01 * critical, angle) == 1


def test_rest_is_not_declared_while_a_rock_turns_over_its_edge():
    # nearly balanced on an edge, it hardly moves for longer than the window, then falls over
    block = box((1.0, 1.0, 1.0))
    angle = pi / 4 - 2e-3
    height = sqrt(0.5) * cos(pi / 4 - angle)
    begin = starts([[0, 0, height]], orientation=about_y(angle))
    end = flown(site_on(plane(), law(1.0)), block, Method(duration=20.0), begin)

    lying = degrees(acos(min(1.0, np.abs(matrix(end.orientation[0])[2]).max())))
    assert end.fate[0] == Fate.REST
    assert lying < 0.5
