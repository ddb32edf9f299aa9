"""Scenes of bonded cubes for the tests of bonds."""

import numpy as np

from warpdem.input.scene import Scene

SIDE = 0.1
CONTACT = {"groups": ["default"] * 2, "kn": 1e6, "kt": 8e5, "en2": 0.25, "mu": 0.5}


def cube(number, *, side=SIDE, cluster=0, **more):
    """Cube ``number`` of a row along x."""
    place = [number * side, 0.0, 0.0]
    return {"shape": "cube", "position": place, "density": 2500.0, "cluster": cluster, **more}


def bond(**more):
    """Undamped bonds at the corners of the faces."""
    usual = {"between": "inner", "rule": "faces", "tolerance": 1e-4, "kn": 1e6, "kt": 5e5}
    return usual | more


def scene(bodies, bonds, *, gravity=(0.0, 0.0, 0.0), side=SIDE, rounding=0.005, contact=(), **run):
    """Cubes with their bonds."""
    run = {"duration": 1.0, "skin": 0.2 * side} | run
    shape = {"name": "cube", "kind": "box", "size": [side] * 3, "rounding": rounding}
    return Scene.model_validate(
        {
            "run": run,
            "gravity": {"vector": gravity},
            "shape": [shape],
            "body": bodies,
            "bond": bonds,
            "contact": [CONTACT | dict(contact)],
        }
    )


def tumbling(**more):
    """Three bonded cubes that fly, spin and swing against each other."""
    generator = np.random.default_rng(1)
    bodies = [
        cube(k, velocity=generator.normal(size=3), spin=generator.normal(size=3) * 10.0)
        for k in range(3)
    ]
    bonds = [bond(**{key: more.pop(key) for key in list(more) if key in BOND_KEYS})]
    return scene(bodies, bonds, **more)


BOND_KEYS = {"kn", "kt", "kr", "en2", "fn0", "ft0", "m0", "gc", "rule", "weibull", "damping_ratio"}
