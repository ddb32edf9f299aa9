"""Scenes of a periodic cell for the tests; all ask for the same needs, so kernels are shared."""

import numpy as np

from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

LAW = {"groups": ["default", "default"], "kn": 1e5, "kt": 7e4, "en2": 0.25, "mu": 0.4}
# the same kernels, without friction and damping that count
ELASTIC = {"mu": 1e-30, "en2": 1.0}
# asks for friction and damping, obeyed by nothing
UNUSED = {"groups": ["none", "none"], "kn": 1.0, "kt": 1.0, "en2": 0.5, "mu": 1.0}
SHAPES = [
    {"kind": "sphere", "name": "ball", "radius": 0.1},
    {"kind": "box", "name": "cube", "size": [0.3, 0.3, 0.3], "rounding": 0.02},
]
UNIT = {"size": [1.0, 1.0, 1.0], "origin": [-0.5, -0.5, -0.5]}
SHEAR = [[0.0, 5.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
STATE = ("position", "orientation", "velocity", "spin")


def scene(bodies, cell=None, *, law=None, dt=2e-5, gravity=(0.0, 0.0, 0.0), run=None, **more):
    """Bodies of density 1000, weightless, in a periodic cell if one is given."""
    tables = {
        "run": {"duration": 10.0, "dt": dt, **(run or {})},
        "gravity": {"vector": list(gravity)},
        "shape": SHAPES,
        "group": [{"name": "none"}],
        "body": [{"density": 1000.0, **body} for body in bodies],
        "contact": [{**LAW, **(law or {})}, UNUSED],
        **more,
    }
    if cell is not None:
        tables["cell"] = cell
    return Scene.model_validate(tables)


def start(bodies, cell=None, *, threads=1, **keys):
    """A simulation of `scene`."""
    return Simulation(scene(bodies, cell, **keys), device="cpu", threads=threads)


def at(body, **changes):
    """A body with some keys changed, vectors as lists."""
    return {**body, **{key: list(map(float, value)) for key, value in changes.items()}}


def lattice(per_side, size, *, seed=0, speed=0.0, jitter=0.0, shapes=("ball",)):
    """Bodies on a simple cubic lattice in a cell with its corner at the origin."""
    random = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(*[np.arange(per_side)] * 3), axis=-1).reshape(-1, 3)
    places = (grid + 0.5) / per_side * np.asarray(size, float)
    return [
        {
            "shape": shapes[k % len(shapes)],
            "position": list(place + jitter * random.normal(size=3)),
            "velocity": list(speed * random.normal(size=3)),
        }
        for k, place in enumerate(places)
    ]


def peculiar(snapshot):
    """Velocities against the homogeneous flow."""
    cell = snapshot.cell
    return snapshot.velocity - (snapshot.position - cell.centre) @ cell.velocity_gradient.T


def momentum(simulation):
    """Total momentum [kg m/s]."""
    mass = np.where(simulation._model.free, simulation._model.mass, 0.0)
    return mass @ simulation.snapshot().velocity
