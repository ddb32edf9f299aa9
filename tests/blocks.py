"""Small scenes of blocks and balls for the tests of whole runs; they share compiled kernels."""

import numpy as np

from warpdem.orientation import product, turned
from warpdem.scene import Scene
from warpdem.simulation import Simulation
from warpdem.timestep import masses

LAW = {
    "groups": ["default", "default"],
    "kn": 1e5,
    "kt": 7e4,
    "en2": 0.25,
    "mu": 0.4,
}
SHAPES = [
    {"kind": "box", "name": "cube", "size": [1.0, 1.0, 1.0], "rounding": 0.05},
    {"kind": "box", "name": "brick", "size": [1.2, 0.8, 0.5], "rounding": 0.05},
    {
        "kind": "polyhedron",
        "name": "tetra",
        "vertices": [[0.5, 0.5, 0.5], [0.5, -0.5, -0.5], [-0.5, 0.5, -0.5], [-0.5, -0.5, 0.5]],
        "faces": [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        "rounding": 0.08,
    },
    {"kind": "sphere", "name": "ball", "radius": 0.5},
    {"kind": "box", "name": "floor", "size": [40.0, 40.0, 4.0], "rounding": 0.05},
]
FLOOR = {"shape": "floor", "position": [0.0, 0.0, -2.0], "fixed": True}
"""Its top is the plane z = 0."""
STATE = ("position", "orientation", "velocity", "spin", "force", "torque")


def scene(bodies, *, law=None, gravity=(0.0, 0.0, -9.81), energy=True, shapes=(), **run):
    """Bodies of density 1 under gravity; ``law`` overrides `LAW`."""
    return Scene.model_validate(
        {
            "run": {"duration": 10.0, "dt": 5e-4, **run},
            "gravity": {"vector": gravity},
            "shape": [*SHAPES, *shapes],
            "body": [{"density": 1.0, **body} for body in bodies],
            "contact": [{**LAW, **(law or {})}],
            "output": {"energy": energy},
        }
    )


def heap(seed=0, count=4, kinds=("cube", "brick", "tetra")):
    """Tumbling bodies above the floor that fall on it and on each other; the floor comes last."""
    random = np.random.default_rng(seed)
    bodies = [
        {
            "shape": kinds[k % len(kinds)],
            "position": random.normal(size=3) * 0.1 + [0.2 * (k % 2), 0.0, 1.1 + 1.9 * k],
            "orientation": unit(random.normal(size=4)),
            "velocity": random.normal(size=3) * 0.3 - [0.0, 0.0, 2.0],
            "spin": random.normal(size=3) * 2.0,
        }
        for k in range(count)
    ]
    return [*bodies, FLOOR]


def swarm(seed=0, count=6):
    """Bodies that fly at each other, without a floor."""
    random = np.random.default_rng(seed)
    kinds = ("cube", "brick", "tetra", "ball")
    bodies = []
    for k in range(count):
        place = 1.6 * np.array([k % 2, k // 2 % 2, k // 4]) + random.normal(size=3) * 0.05
        bodies.append(
            {
                "shape": kinds[k % len(kinds)],
                "position": place,
                "orientation": unit(random.normal(size=4)),
                "velocity": 2.0 * (0.8 - place) + random.normal(size=3),
                "spin": random.normal(size=3) * 2.0,
            }
        )
    return bodies


def unit(quaternion):
    """At length one."""
    return quaternion / np.linalg.norm(quaternion)


def run(bodies, until, *, threads=1, **scene_keys):
    """A simulation of `scene` advanced to a time [s]."""
    simulation = Simulation(scene(bodies, **scene_keys), device="cpu", threads=threads)
    simulation.advance(until)
    return simulation


def same(first, second):
    """Whether two simulations are in bitwise the same state."""
    one, other = first.snapshot(), second.snapshot()
    return all(np.array_equal(getattr(one, name), getattr(other, name)) for name in STATE)


def momenta(simulation):
    """Sums of momentum [kg m/s] and angular momentum about the origin [kg m^2/s]; free bodies."""
    mass, moment = masses(simulation.placement, simulation.polyhedra)
    now = simulation.snapshot()
    p = mass[:, None] * now.velocity
    back = now.orientation * [1.0, -1.0, -1.0, -1.0]
    spun = turned(now.orientation, moment * turned(back, now.spin))
    return p.sum(axis=0), (np.cross(now.position, p) + spun).sum(axis=0)
