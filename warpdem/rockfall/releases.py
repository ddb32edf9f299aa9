"""The releases of a scene: how each trajectory starts, a function of seed and number alone."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from warpdem.errors import GeometryError, SceneError
from warpdem.geometry.orientation import product
from warpdem.input.decode import problem_at
from warpdem.rockfall.apportion import apportioned
from warpdem.rockfall.flights import Starts
from warpdem.rockfall.places import Line, Points
from warpdem.rockfall.random import Purpose, Streams
from warpdem.rockfall.settle import LISTED, is_off, places, resting_height
from warpdem.rockfall.sources import (
    amounts,
    place_key,
    rock_numbers,
    source_of,
    spins,
    velocities,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.errors import Problem
    from warpdem.input.scene import Scene
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.sources import Source

_CLEARANCE = 0.02  # [m], where neither height nor z is given


class Releases:
    """Starts of the trajectories of an ensemble.

    Args:
        scene: With one [[release]] at least.
        site: What rocks fall on.
        rocks: Of the scene, in its order.

    Raises:
        SceneError: A file cannot be read, or a point, row or end of a line is not on the ground.
    """

    def __init__(self, scene: Scene, site: Site, rocks: Sequence[Rock]) -> None:
        self._scene, self._site, self._rocks = scene, site, tuple(rocks)
        self._sources: list[Source] = []
        problems: list[Problem] = []
        for index, section in enumerate(scene.release):
            try:
                source = source_of(section, scene.directory, site.origin, [r.name for r in rocks])
            except GeometryError as error:
                path = ("release", index, place_key(section))
                problems.append(problem_at(scene, path, str(error)))
            else:
                self._sources.append(source)
                problems += self._misplaced(index, source)
        if problems:
            raise SceneError(str(scene.source or "scene"), problems)
        self._weights = [source.section.weight or source.places.count for source in self._sources]

    @property
    def count(self) -> int:
        """Number of trajectories: that of the scene, or one for each point and row."""
        places = sum(source.places.count for source in self._sources)
        return self._scene.ensemble.count or places

    def starts(self, ids: IntArray) -> Starts:
        """How trajectories start.

        Args:
            ids: Their global numbers, in any order, shape [n].

        Raises:
            SceneError: One starts in an area or on a line where the terrain has no data.
        """
        ids = np.asarray(ids, np.int64)
        release, turn = apportioned(ids, self._weights)
        rows = [np.flatnonzero(release == index) for index in range(len(self._sources))]
        parts = [self._part(k, ids[at], turn[at]) for k, at in enumerate(rows)]
        back = np.argsort(np.concatenate(rows), kind="stable")
        return Starts(
            **{
                field.name: np.concatenate([getattr(part, field.name) for part in parts])[back]
                for field in fields(Starts)
            }
        )

    def _part(self, index: int, ids: IntArray, turn: IntArray) -> Starts:
        """Starts of the trajectories of one release."""
        source = self._sources[index]
        streams = Streams(self._scene.run.seed, ids)
        rock = rock_numbers(source, streams, turn)
        orientation = self._orientation(source, streams, rock)
        position = source.places.at(streams, turn)
        self._check_ground(index, source, position)
        position = self._settled(source, streams, rock, position, orientation)
        return Starts(
            id=ids,
            release=np.full(len(ids), index, np.int32),
            rock=rock.astype(np.int32),
            position=position,
            orientation=orientation,
            velocity=velocities(source, streams, turn),
            spin=spins(source, streams, turn),
        )

    def _orientation(self, source: Source, streams: Streams, rock: IntArray) -> FloatArray:
        given = source.section.orientation
        if isinstance(given, str):
            return streams.quaternions(Purpose.ORIENTATION)
        turned = np.array([product(np.array(given), one.frame_rotation) for one in self._rocks])
        turned /= np.linalg.norm(turned, axis=1, keepdims=True)
        return turned[rock]

    def _settled(
        self,
        source: Source,
        streams: Streams,
        rock: IntArray,
        position: FloatArray,
        orientation: FloatArray,
    ) -> FloatArray:
        """Positions with z at its height above the ground, or as given if that is not below it."""
        height = source.section.height
        clearance = amounts(_CLEARANCE if height is None else height, streams, Purpose.HEIGHT)
        free = np.isnan(position[:, 2]) | (height is not None)
        settled = position.copy()
        for number in np.unique(rock):
            at = np.flatnonzero(rock == number)
            rest = resting_height(
                self._site.ground,
                self._rocks[number],
                position[at, :2],
                orientation[at],
                np.where(free[at], clearance[at], 0.0),
            )
            settled[at, 2] = np.where(free[at], rest, np.maximum(position[at, 2], rest))
        return settled

    def _misplaced(self, index: int, source: Source) -> list[Problem]:
        """Points, rows and ends of lines that are not on the ground, as one problem."""
        plan = source.places.certain
        off = np.flatnonzero(is_off(self._site.ground, plan))
        if not len(off):
            return []
        what = "row" if source.rows else "point"
        named = places(plan[off], self._site.origin)
        if source.rows:
            lines = ", ".join(str(line) for line in source.rows.lines[off[:LISTED]].tolist())
            named = f"on line {lines}, {named}"
        message = (
            f"{len(off)} of {len(plan)} {what}s {'lies' if len(off) == 1 else 'lie'} outside the "
            f"terrain or where it has no data: {named}; check terrain.nodes and the coordinates, "
            "or take a larger terrain"
        )
        return [problem_at(self._scene, ("release", index, place_key(source.section)), message)]

    def _check_ground(self, index: int, source: Source, position: FloatArray) -> None:
        """Refuse a place drawn where there is no ground; points were tried at the start."""
        if isinstance(source.places, Points):
            return
        off = is_off(self._site.ground, position[:, :2])
        if not off.any():
            return
        name = "line" if isinstance(source.places, Line) else "area"
        first = places(position[off, :2], self._site.origin)
        message = (
            f"{int(off.sum())} of {len(off)} rocks would start outside the terrain or where it has "
            f"no data: {first}; keep the {name} on the terrain"
        )
        problem = problem_at(self._scene, ("release", index, place_key(source.section)), message)
        raise SceneError(str(self._scene.source or "scene"), [problem])
