"""Scenes of the physics tests: balls and boxes over one floor.

All have the same needs (friction, damping, rolling resistance, energies, a large fixed box) whether
or not their laws use them, so that their kernels are compiled once: the law of the floor with
itself, which nothing obeys, asks for them.
"""

from math import acos, acosh, exp, sqrt

import numpy as np

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

# rounding of the floor; sharp corners sink into it and stay clear of its core
DEPTH = 0.05
# of the lists, generous: few bodies, and some are fast
SKIN = 0.5
FLOOR = {"name": "floor", "kind": "box", "size": [400.0, 400.0, 4.0], "rounding": DEPTH}
GROUND = {"shape": "floor", "group": "floor", "position": [0.0, 0.0, -2.0], "fixed": True}
UNUSED = {
    "groups": ["floor", "floor"],
    "kn": 1.0,
    "kt": 1.0,
    "en2": 0.5,
    "mu": 1.0,
    "kr": 1.0,
    "mur": 1.0,
}


def clamped_restitution(zeta):
    """e = exp(-2 z acos(z)/sqrt(1 - z^2)) of a dashpot that never pulls, acosh beyond z = 1."""
    if zeta == 1.0:
        return exp(-2.0)
    ratio = acos(zeta) / sqrt(1 - zeta**2) if zeta < 1 else acosh(zeta) / sqrt(zeta**2 - 1)
    return exp(-2.0 * zeta * ratio)


def law(kn, *, kt=0.0, mu=0.0, zeta=0.0, e=None, kr=0.0, mur=0.0):
    """Contact parameters, of the damping ratio ``zeta`` or of the restitution ``e``."""
    e = clamped_restitution(zeta) if e is None else e
    return {"kn": kn, "kt": kt, "mu": mu, "en2": e * e, "kr": kr, "mur": mur}


def ball(name, radius, *, beta=0.4):
    """A ball of volume 1 whose moments of inertia are beta m R^2."""
    return {
        "name": name,
        "kind": "polyhedron",
        "vertices": [[0.0, 0.0, 0.0]],
        "rounding": radius,
        "volume": 1.0,
        "inertia_over_mass": [beta * radius**2] * 3,
    }


def box(name, size, *, rounding=1e-9, inertia_over_mass=None):
    """A box of volume 1; sharp unless ``rounding`` says otherwise; a cuboid's inertia."""
    if inertia_over_mass is None:
        inertia_over_mass = cuboid_inertia(size)
    return {
        "name": name,
        "kind": "box",
        "size": list(size),
        "rounding": rounding,
        "volume": 1.0,
        "inertia_over_mass": list(inertia_over_mass),
    }


def cuboid_inertia(size):
    """Principal moments over the mass of a homogeneous cuboid."""
    a, b, c = size
    return [(b * b + c * c) / 12.0, (a * a + c * c) / 12.0, (a * a + b * b) / 12.0]


def body(shape, position, *, mass=1.0, **motion):
    """A free body of a shape of volume 1."""
    return {
        "shape": shape,
        "group": "free",
        "position": list(position),
        "density": mass,
        **{key: list(value) for key, value in motion.items()},
    }


def laboratory(shapes, bodies, rules, *, dt, gravity=(0.0, 0.0, 0.0), contacts=(), **run):
    """A simulation of free bodies over the floor, the top of which is at z = 0.

    ``rules`` hold between all bodies of the group "free" and the floor, which is the last body;
    ``contacts`` are more laws.
    """
    scene = {
        "run": {"duration": 1e3, "dt": dt, "device": "cpu", "skin": SKIN, **run},
        "gravity": {"vector": list(gravity)},
        "output": {"orientation": True},
        "shape": [*shapes, FLOOR],
        "body": [*bodies, GROUND],
        "contact": [
            {"groups": ["free", "free"], **rules},
            {"groups": ["free", "floor"], **rules},
            UNUSED,
            *contacts,
        ],
    }
    return Simulation(Scene.model_validate(scene), threads=1)


def tilted(angle, g=9.81):
    """Gravity seen from a slope of ``angle`` [rad] that descends along x."""
    return (g * np.sin(angle), 0.0, -g * np.cos(angle))


def record(simulation, steps):
    """Snapshots of so many steps, the present one first."""
    shots = [simulation.snapshot()]
    for _ in range(steps):
        simulation.advance(simulation.time + simulation.dt)
        shots.append(simulation.snapshot())
    return shots
