"""Free bodies of a scene as rocks: each is one trajectory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.check import build_shapes
from warpdem.errors import SceneError
from warpdem.filling.placement import place
from warpdem.input.decode import problem_at
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.rocks import rock_of
from warpdem.rockfall.settle import is_off, places

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.rockfall.site import Site


class Bodies:
    """The free bodies of a scene, given one by one or by fills, as rocks that start together.

    Trajectories are numbered in the order of the bodies, and so are the releases they come from.

    Args:
        scene: With free bodies and without releases.
        site: The ground they fall on.

    Attributes:
        rocks: The different ones: shape, size and density, in the order they first occur.
        count: Number of trajectories.

    Raises:
        SceneError: A shape is no solid, or not convex, or a body is not above the ground; carries a
            problem for each.
    """

    def __init__(self, scene: Scene, site: Site) -> None:
        shapes = build_shapes(scene)
        _refuse_concave(scene, shapes)
        placement = place(scene, shapes)
        free = np.flatnonzero(~placement.fixed)
        kinds = [_kind(placement, int(body)) for body in free]
        number = {kind: k for k, kind in enumerate(dict.fromkeys(kinds))}
        solids = list(shapes.values())
        self.rocks = tuple(
            rock_of(solids[k], solids[k].name, density * solids[k].volume * scale**3, scale=scale)
            for k, scale, density in number
        )
        self.count = len(free)
        position = placement.position[free] - site.origin
        _refuse_beside(scene, site, position)
        self._starts = Starts(
            id=np.arange(len(free), dtype=np.int64),
            release=np.arange(len(free), dtype=np.int32),
            rock=np.array([number[kind] for kind in kinds], np.int32),
            position=position,
            orientation=placement.orientation[free],
            velocity=placement.velocity[free],
            spin=placement.spin[free],
        )

    def starts(self, ids: IntArray) -> Starts:
        """Where and how the trajectories of these numbers begin; each may be asked for anew."""
        rows = {name: values[ids] for name, values in vars(self._starts).items()}
        return Starts(**rows)


def _kind(placement: Placement, body: int) -> tuple[int, float, float]:
    """Shape, scale and density of a body."""
    return (
        int(placement.shape[body]),
        float(placement.scale[body]),
        float(placement.density[body]),
    )


def _refuse_concave(scene: Scene, shapes: Mapping[str, Polyhedron]) -> None:
    fixed = {body.shape for body in scene.body if body.fixed}
    free = {body.shape for body in scene.body if not body.fixed}
    free |= {name for fill in scene.fill for name in fill.shapes}
    rule = (
        'is not convex, as rocks of run.method = "nonsmooth" must be; '
        'use [[rock]] kind = "mesh", which takes the hull'
    )
    problems = [
        problem_at(scene, ("shape", index), rule)
        for index, (name, shape) in enumerate(shapes.items())
        if name in free - fixed and not shape.convex
    ]
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)


def _refuse_beside(scene: Scene, site: Site, position: FloatArray) -> None:
    """Refuse bodies, at local positions, that no ground is below."""
    off = is_off(site.ground, position[:, :2])
    if off.any():
        message = (
            f"{int(off.sum())} of {len(off)} free bodies lie outside the terrain or where it has "
            f"no data: {places(position[off, :2], site.origin)}; check the coordinates, or take a "
            "larger terrain"
        )
        section = "body" if any(not body.fixed for body in scene.body) else "fill"
        raise SceneError(str(scene.source or "scene"), [problem_at(scene, (section,), message)])
