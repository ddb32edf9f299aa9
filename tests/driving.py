"""Scenes of fixed boxes and their drivers."""

from warpdem.checks.check import build_shapes
from warpdem.driving.plan import plan_of
from warpdem.filling.placement import place
from warpdem.input.scene import Scene

BOX = {"kind": "box", "name": "box", "size": [1.0, 1.0, 0.2], "rounding": 0.05}


def scene(drivers, bodies=("a",), **keys):
    return Scene.model_validate(
        {
            "run": {"duration": 2.0},
            "shape": [BOX],
            "body": [
                {
                    "shape": "box",
                    "name": name,
                    "fixed": True,
                    "position": [3.0 * k, 0.0, 0.0],
                    "density": 1000.0,
                }
                for k, name in enumerate(bodies)
            ],
            "driver": drivers,
            **keys,
        }
    )


def plan(drivers, bodies=("a",), **keys):
    built = scene(drivers, bodies, **keys)
    shapes = build_shapes(built)
    return plan_of(built, place(built, shapes), shapes)
