"""Scenes of rocks and releases without a ground of their own, and a plane for ground."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
from pydantic import TypeAdapter

from warpdem.input.scene_release import Release
from warpdem.input.scene_rock import Rock
from warpdem.input.scene_shapes import Shape
from warpdem.rockfall.site import Grid, Ground, Site

ORIGIN = np.array([2.6e6, 1.2e6, 1500.0])
SLOPE = np.array([0.3, -0.7])
BLOCK = {"name": "block", "kind": "builder", "form": "equant", "volume": 0.2, "density": 2700.0}
PLATE = {**BLOCK, "name": "plate", "form": "flat", "rounding": 0.05}
BALL = {"name": "ball", "kind": "shape", "shape": "ball", "mass": 10.0}
SPHERE = {"name": "ball", "kind": "sphere", "radius": 0.25}


class Plane(Ground):
    """z = SLOPE . (x, y) on a square of 100 m about the origin, without data beyond x = 30 m."""

    def height(self, x, y):
        gone = (np.maximum(np.abs(x), np.abs(y)) > 50.0) | (np.asarray(x) > 30.0)
        return np.where(gone, np.nan, SLOPE[0] * x + SLOPE[1] * y)

    def slopes(self, x, y):
        return tuple(np.full(np.shape(x), slope) for slope in SLOPE)


def site(origin=ORIGIN):
    known = np.ones((100, 100), bool)
    known[:, 80:] = False
    ground = Plane(Grid(-50.0, -50.0, 1.0, 100, 100), None, None, known, np.ones((100, 100)), 1.0)
    return Site(
        origin=origin,
        crs="",
        ground=ground,
        classes=(),
        class_of=np.zeros((100, 100), int),
        stands=(),
        stand_of=None,
        trees=None,
        barriers=(),
        results=ground.grid,
    )


def scene(release=(), rock=(BLOCK, PLATE, BALL), *, count=None, seed=1, directory=".", shape=()):
    return SimpleNamespace(
        shape=[TypeAdapter(Shape).validate_python(one) for one in (SPHERE, *shape)],
        rock=[TypeAdapter(Rock).validate_python(one) for one in rock],
        release=[TypeAdapter(Release).validate_python(one) for one in release],
        run=SimpleNamespace(seed=seed),
        ensemble=SimpleNamespace(count=count),
        directory=Path(directory),
        source=None,
    )
