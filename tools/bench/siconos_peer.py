"""A rock slides down a plane in Siconos: body-steps per second and where the rock ends, as JSON.

    /usr/bin/python3 tools/bench/siconos_peer.py [--rocks N] [--dt DT] [--duration T] ...

Run by the Python that has Siconos 4.4 (Debian: siconos, python3-siconos), not by warpdem's own.
Moreau-Jean time stepping, theta 1/2; Signorini, Coulomb and Newton's impact law; each rock is the
convex hull of the eight corners of a box, whose contact points Bullet finds, in compiled code. The
ground is flat and gravity tilted: the friction of 4.4 is wrong on tilted ground. Rocks are far
apart and independent, in one model. Bullet's own safety margins are zero.

Only the time loop is timed, building the model is not. ``ahead`` and ``speeding`` say whether the
physics is right: how far a rock slides in the last quarter, and its mean acceleration there, which
for a block sliding on a face is g (sin a - mu cos a).
"""

# ruff: noqa: E402 - threads are chosen before the libraries load
import argparse
import itertools
import json
import math
import os
import sys
import time

# one thread, as the peer has: must be said before NumPy and Siconos load their libraries
for library in ("OPENBLAS", "OMP", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")

import numpy as np
from siconos import kernel, numerics
from siconos.mechanics.collision import (
    RigidBodyDS,
    SiconosContactor,
    SiconosContactorSet,
    SiconosConvexHull,
    SiconosPlane,
)
from siconos.mechanics.collision.bullet import SiconosBulletCollisionManager, SiconosBulletOptions

GRAVITY = 9.81
DENSITY = 2700.0
APART = 9.0
"""Distance between rocks [m]; Bullet's plane reaches 500 m."""


def options() -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rocks", type=int, default=1)
    parser.add_argument("--dt", type=float, default=5e-3, help="[s]")
    parser.add_argument("--duration", type=float, default=8.0, help="[s]")
    parser.add_argument("--size", type=float, nargs=3, default=[2.5, 3.0, 1.0], help="[m]")
    parser.add_argument("--slope", type=float, default=35.0, help="[degrees]")
    parser.add_argument("--mu", type=float, default=0.6)
    parser.add_argument("--restitution", type=float, default=0.0)
    parser.add_argument("--tolerance", type=float, default=1e-4, help="of the contact solver")
    parser.add_argument("--iterations", type=int, default=1000, help="of it, at most")
    parser.add_argument("--height", type=float, default=2.5, help="of the centre at the start [m]")
    parser.add_argument("--speed", type=float, default=2.0, help="downhill at the start [m/s]")
    parser.add_argument("--seed", type=int, default=1, help="of the orientations")
    return parser.parse_args()


def contactors(shape: object) -> SiconosContactorSet:
    """A set of one shape without margins."""
    shape.setInsideMargin(0.0)
    shape.setOutsideMargin(0.0)
    contacts = SiconosContactorSet()
    contacts.append(SiconosContactor(shape))
    return contacts


def orientations(asked: argparse.Namespace) -> np.ndarray:
    """Random unit quaternions w, x, y, z, shape [rock_count, 4]."""
    numbers = np.random.default_rng(asked.seed).normal(size=(asked.rocks, 4))
    return numbers / np.linalg.norm(numbers, axis=1, keepdims=True)


def bodies(asked: argparse.Namespace) -> list[RigidBodyDS]:
    """The rocks, each under the weight that a slope would give it."""
    size = np.array(asked.size)
    corners = np.array(list(itertools.product((-0.5, 0.5), repeat=3))) * size
    mass = DENSITY * size.prod()
    inertia = np.diag(mass / 12.0 * (size @ size - size**2))
    tilt = math.radians(asked.slope)
    weight = mass * GRAVITY * np.array([math.sin(tilt), 0.0, -math.cos(tilt)])
    found = []
    for rock, orientation in enumerate(orientations(asked)):
        place = [0.0, APART * (rock - 0.5 * (asked.rocks - 1)), asked.height, *orientation]
        body = RigidBodyDS(place, [asked.speed, 0.0, 0.0, 0.0, 0.0, 0.0], mass, inertia)
        body.setContactors(contactors(SiconosConvexHull(corners)))
        body.setFExtPtr(list(weight))
        found.append(body)
    return found


def simulation(asked: argparse.Namespace, rocks: list[RigidBodyDS]) -> tuple:
    """The time stepping and the contact problem of its steps."""
    model = kernel.NonSmoothDynamicalSystem(0.0, asked.duration)
    for rock in rocks:
        model.insertDynamicalSystem(rock)
    settings = SiconosBulletOptions()
    settings.worldScale = 1.0
    settings.perturbationIterations = 0
    settings.minimumPointsPerturbationThreshold = 0
    ground = SiconosBulletCollisionManager(settings)
    law = kernel.NewtonImpactFrictionNSL(asked.restitution, 0.0, asked.mu, 3)
    ground.insertNonSmoothLaw(law, 0, 0)
    ground.insertStaticContactorSet(contactors(SiconosPlane()), [0, 0, 0, 1, 0, 0, 0])
    integrator = kernel.MoreauJeanOSI(0.5)
    integrator.setConstraintActivationThreshold(0.0)
    solver = kernel.solver_options_create(numerics.SICONOS_FRICTION_3D_NSGS)
    solver.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = asked.iterations
    solver.dparam[numerics.SICONOS_DPARAM_TOL] = asked.tolerance
    problem = kernel.FrictionContact(3, solver)
    problem.setMaxSize(16384)
    problem.setMStorageType(numerics.NM_SPARSE_BLOCK)
    problem.setKeepLambdaAndYState(True)
    clock = kernel.TimeDiscretisation(0.0, asked.dt)
    stepping = kernel.TimeStepping(model, clock, integrator, problem)
    stepping.insertInteractionManager(ground)
    stepping.setNewtonOptions(kernel.SICONOS_TS_LINEAR)
    stepping.setNewtonMaxIteration(1)
    return stepping, problem, (model, ground)


def march(asked: argparse.Namespace) -> dict:
    """Run to the end; what is printed."""
    rocks = bodies(asked)
    # Siconos does not own what Python gave it: the model must outlive the steps
    stepping, problem, _alive = simulation(asked, rocks)
    quarter = round(0.75 * asked.duration / asked.dt)
    steps = contacts = 0
    late = states(rocks)
    cpu, wall = time.process_time(), time.perf_counter()
    while stepping.hasNextEvent():
        stepping.computeOneStep()
        contacts += problem.getSizeOutput() // 3
        stepping.nextStep()
        steps += 1
        if steps == quarter:
            late = states(rocks)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    last = states(rocks)
    span = (steps - quarter) * asked.dt
    tilt = math.radians(asked.slope)
    return {
        "options": vars(asked),
        "steps": steps,
        "cpu_s": cpu,
        "wall_s": wall,
        "body_steps_per_cpu_s": asked.rocks * steps / cpu,
        "body_steps_per_wall_s": asked.rocks * steps / wall,
        "contacts_per_body_step": contacts / (asked.rocks * steps),
        "ahead": (last[:, 0] - late[:, 0]).tolist(),
        "speeding": ((last[:, 7] - late[:, 7]) / span).tolist(),
        "speeding_on_a_face": GRAVITY * (math.sin(tilt) - asked.mu * math.cos(tilt)),
        "state": last.tolist(),
    }


def states(rocks: list[RigidBodyDS]) -> np.ndarray:
    """Position, orientation, velocity, spin of each rock, shape [rock_count, 13]."""
    return np.array([[*rock.q(), *rock.twist()] for rock in rocks])


if __name__ == "__main__":
    json.dump(march(options()), sys.stdout)
    print()
