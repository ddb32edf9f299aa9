"""Small scenes of blocks and balls for the tests of whole runs.

They ask for the same features, so that they share compiled kernels: NO_FRICTION keeps its law.
"""

import numpy as np

from warpdem.checks.timestep import masses
from warpdem.geometry.orientation import turned
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

LAW = {
    "groups": ["default", "default"],
    "kn": 1e5,
    "kt": 7e4,
    "en2": 0.25,
    "mu": 0.4,
    "kr": 20.0,
    "mur": 0.01,
}
NO_FRICTION = {"mu": 1e-30, "mur": 1e-30}
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


def strips(count=12, length=13.0, width=4.0):
    """A plate with its top at z = 0 cut into strips of two triangles each, which stay apart."""
    x = np.linspace(-1.0, length - 1.0, count + 1) + 0.03 * np.sin(np.arange(count + 1))
    near = [[a, -0.5 * width, -0.05] for a in x]
    far = [[a, 0.5 * width, -0.05] for a in x]
    low = [[x[0], -0.5 * width], [x[-1], -0.5 * width], [x[-1], 0.5 * width], [x[0], 0.5 * width]]
    n = count + 1
    a, b, c, d = range(2 * n, 2 * n + 4)
    top = [[k, k + 1, n + k + 1] for k in range(count)]
    top += [[k, n + k + 1, n + k] for k in range(count)]
    sides = [
        [d, c, b, a],
        [a, b, *range(count, -1, -1)],
        [c, d, *range(n, 2 * n)],
        [d, a, 0, n],
        [b, c, 2 * n - 1, n - 1],
    ]
    faces = [*top, *sides]
    borders = {tuple(sorted((f[k - 1], f[k]))) for f in faces for k in range(len(f))}
    return {
        "kind": "polyhedron",
        "name": "strips",
        "vertices": [*near, *far, *([*corner, -2.0] for corner in low)],
        "faces": faces,
        "edges": sorted(borders),
        "rounding": 0.05,
    }


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


def energies_of(simulation):
    """Kinetic, potential and elastic energy of all bodies now [J]."""
    now = simulation.snapshot().energy
    return now.kinetic + now.potential + now.elastic
