"""A ball on the floor or a slope, measured: sliding, rolling, coming to rest."""

import numpy as np

from scenes import ball, body, laboratory, law, record, tilted

RADIUS = 0.1


def supported(radius, kn, g, *, x=0.0, **motion):
    """A ball of mass 1 that lies on the floor at its static overlap."""
    return body("ball", [x, 0.0, radius - g / kn], **motion)


def slip_to_roll(*, v0, mu, beta, radius, g, kn, steps=40):
    """Time and distance at which a sliding ball rolls, then its mean velocity and spin."""
    rules = law(kn, kt=0.8 * kn, mu=mu, zeta=0.2)
    ball_at = supported(radius, kn, g, velocity=[v0, 0.0, 0.0])
    dt = np.pi / np.sqrt(kn) / steps
    gravity = [0.0, 0.0, -g]
    simulation = laboratory(
        [ball("ball", radius, beta=beta)], [ball_at], rules, dt=dt, gravity=gravity
    )
    simulation.advance(0.95 * v0 / (mu * g * (1.0 + 1.0 / beta)))
    while _slip(after := simulation.snapshot(), radius) > 0.0:
        before = after
        simulation.advance(simulation.time + dt)
    share = _slip(before, radius) / (_slip(before, radius) - _slip(after, radius))
    distance = before.position[0, 0] + share * (after.position[0, 0] - before.position[0, 0])
    # what is left is the vibration of the frictional spring: averaged over ten of its periods
    period = 2.0 * np.pi / np.sqrt(0.8 * kn * (1.0 + 1.0 / beta))
    shots = record(simulation, round(10.0 * period / dt))
    return {
        "t_roll": before.time + share * dt,
        "v_final": np.mean([shot.velocity[0, 0] for shot in shots]),
        "omega_final": np.mean([shot.spin[0, 1] for shot in shots]),
        "distance_at_roll": distance,
    }


def _slip(shot, radius):
    return shot.velocity[0, 0] - radius * shot.spin[0, 1]


def descent(*, angle, mu, mur, beta, radius, g, kn, steps=20):
    """Accelerations and path in one second of a ball let go on a slope."""
    # the rolling spring is as stiff as the frictional one at the radius
    kr = 0.8 * kn * radius**2 if mur else 0.0
    rules = law(kn, kt=0.8 * kn, mu=mu, zeta=0.2, kr=kr, mur=mur)
    start = supported(radius, kn, g * np.cos(angle))
    simulation = laboratory(
        [ball("ball", radius, beta=beta)],
        [start],
        rules,
        dt=np.pi / np.sqrt(kn) / steps,
        gravity=tilted(angle, g),
    )
    shots = []
    for t in np.linspace(0.1, 1.0, 181):
        simulation.advance(t)
        shots.append(simulation.snapshot())
    time = [shot.time for shot in shots]
    end = shots[-1]
    late = 1.0 - end.time
    return {
        "acc": np.polyfit(time, [shot.velocity[0, 0] for shot in shots], 1)[0],
        "alpha": np.polyfit(time, [shot.spin[0, 1] for shot in shots], 1)[0],
        "x_after_1s": end.position[0, 0] + late * end.velocity[0, 0],
    }


def decay(*, spin, mur, beta, radius, g, kn, upright, until=None, steps=20):
    """Angular deceleration of a ball that rolls, or spins ``upright``, and when it stops."""
    kr = 0.8 * kn * radius**2
    rules = law(kn, kt=0.8 * kn, mu=0.5, zeta=0.2, kr=kr, mur=mur)
    motion = {"spin": [0.0, 0.0, spin]} if upright else {"spin": [0.0, spin, 0.0]}
    if not upright:
        motion["velocity"] = [spin * radius, 0.0, 0.0]
    simulation = laboratory(
        [ball("ball", radius, beta=beta)],
        [supported(radius, kn, g, x=-100.0, **motion)],
        rules,
        dt=np.pi / np.sqrt(kn) / steps,
        gravity=[0.0, 0.0, -g],
    )
    axis = 2 if upright else 1
    time, rate, pace = [0.0], [spin], 0.01
    while rate[-1] > 0.0 and time[-1] < (until or np.inf):
        simulation.advance(time[-1] + pace)
        shot = simulation.snapshot()
        time.append(shot.time)
        rate.append(shot.spin[0, axis])
        # step by step near the end: the rolling spring swings back at once
        if rate[-1] < 3.0 * (rate[-2] - rate[-1]):
            pace = simulation.dt
    stop = np.interp(0.0, [rate[-1], rate[-2]], [time[-1], time[-2]])
    return {"deceleration": -np.polyfit(time[:-1], rate[:-1], 1)[0], "t_stop": stop}


def spinning_slide(*, speed, spin, mu, kn, kt, g, dt, time, beta=100.0):
    """Snapshot of a ball that slides along x and spins upright.

    Its large moment of inertia and small weight leave its motion almost as it is.
    """
    motion = {"velocity": [speed, 0.0, 0.0], "spin": [0.0, 0.0, spin]}
    simulation = laboratory(
        [ball("ball", RADIUS, beta=beta)],
        [supported(RADIUS, kn, g, **motion)],
        law(kn, kt=kt, mu=mu, zeta=0.5),
        dt=dt,
        gravity=[0.0, 0.0, -g],
    )
    simulation.advance(time)
    return simulation.snapshot(contacts=True)


def lag_of_friction(**slide):
    """Angle from the sliding velocity to friction in a ``spinning_slide`` [rad]."""
    friction = spinning_slide(**slide).contacts.tangential_force[0]
    return np.arctan2(-friction[1], -friction[0])
