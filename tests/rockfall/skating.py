"""Stand-ins for scene, site, flights and results of rockfall: rocks that skate by their number."""

import json
import os
import sys
import time
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from warpdem.errors import UnstableError
from warpdem.output.durable import swap
from warpdem.rockfall import ensemble, finish, task
from warpdem.rockfall.flights import (
    COUNTS,
    MEASURES,
    Crossings,
    Flights,
    Method,
    Starts,
    Visits,
)
from warpdem.rockfall.rock import Rock
from warpdem.rockfall.share import Shard, Share
from warpdem.rockfall.site import Grid, Ground, GroundClass, Site

GRID = Grid(x=0.0, y=0.0, cell=1.0, rows=4, columns=4)
CLASS = GroundClass("snow", 0.1, 0.35, 2.0, 150.0, 0.7, source="unverified")
GROUND = Ground(GRID, np.zeros((5, 5)), None, np.ones((4, 4), bool), np.zeros((4, 4)), reach=1.0)
SITE = Site(
    origin=np.zeros(3),
    crs="",
    ground=GROUND,
    classes=(CLASS,),
    class_of=np.zeros((4, 4), np.int32),
    stands=(),
    stand_of=None,
    trees=None,
    barriers=(),
    results=GRID,
)
POINT = np.zeros((1, 3))
EDGE = np.zeros((1, 2), np.int32)
ROCK = Rock("pebble", POINT, 0.1, EDGE, 1.0, np.ones(3), POINT, np.zeros((1, 3), np.int32))
FUSE = "SKATING_FUSE"
"""Names a file: so many processes die of trajectory 57 as it has letters."""

RESULTS = ("deposits.csv", "passages.asc")


class Scene(SimpleNamespace):
    """As much of a scene as an ensemble looks at."""

    def model_dump(self, *, mode):
        return {
            "title": self.title,
            "run": vars(self.run),
            "ensemble": vars(self.ensemble),
            "output": {"map": True, "rasters": True},
            "terrain": {"file": self.terrain},
        }


def scene(
    folder,
    *,
    count=103,
    chunk=10,
    seed=1,
    title="skating",
    pause=0.0,
    fatal=-1,
    terrain="terrain.asc",
):
    """A scene of ``count`` trajectories that take ``pause`` seconds each; one may be fatal."""
    return Scene(
        title=title,
        source=None,
        terrain=terrain,
        directory=Path(folder),
        run=SimpleNamespace(
            method="nonsmooth", device="cpu", seed=seed, duration=60.0, dt=pause, fatal=fatal
        ),
        ensemble=SimpleNamespace(count=count, chunk=chunk),
    )


def starts(ids, seed):
    position = np.sin(np.outer(ids + seed, [1.0, 2.0, 3.0]))
    turn = np.tile([1.0, 0.0, 0.0, 0.0], (len(ids), 1))
    none = np.zeros(len(ids), np.int32)
    return Starts(ids, none, none, position, turn, 0.1 * position, 0.2 * position)


class Releases:
    def __init__(self, scene):
        self.count = scene.ensemble.count
        self._seed = scene.run.seed

    def starts(self, ids):
        return starts(ids, self._seed)


def burn(fuse):
    """End the process at once, or raise an error if there is no fuse left."""
    if not fuse.exists():
        raise RuntimeError("out of order")
    if fuse.read_text():
        fuse.write_text(fuse.read_text()[1:])
        os._exit(1)


class StoppedError(Exception):
    pass


class Skating:
    """The interface of ``Trajectories``; the method's dt is the seconds that each one takes."""

    def __init__(self, site, rocks, method, *, device, slots):
        assert device == "cpu"
        self._method = method

    def load(self):
        pass

    def twin(self):
        return self

    def fly(self, starts, *, stop=None):
        number = starts.id
        for _ in number if self._method.dt else ():
            time.sleep(self._method.dt)
            if stop and stop():
                raise StoppedError
        if FUSE in os.environ and 57 in number:
            burn(Path(os.environ[FUSE]))
        if self._method.sweeps in number:
            raise UnstableError(f"trajectory {self._method.sweeps}: flew off")
        end = 2.0 + 2.0 * np.cos(starts.position)
        counts = np.outer(number, np.arange(len(COUNTS))) % 7
        every = number[number % 3 == 0]
        reals = {
            field.name: 0.1 * every
            for field in fields(Crossings)
            if field.name not in {"id", "barrier", "caught", "position"}
        }
        values = {name: (0.5 * number).astype(np.float32) for name in MEASURES[-4:]}
        return Flights(
            id=number,
            release=starts.release,
            rock=starts.rock,
            fate=(number % 4).astype(np.int8),
            time=0.25 * number,
            start=starts.position,
            position=end,
            orientation=starts.orientation,
            velocity=starts.velocity,
            spin=starts.spin,
            counts=counts,
            measures=np.outer(number, np.arange(len(MEASURES))) / 7.0,
            visits=Visits(id=number, cell=GRID.index(end[:, 0], end[:, 1]), **values),
            crossings=Crossings(
                id=every,
                barrier=np.zeros(len(every), np.int32),
                caught=every % 2 == 0,
                position=end[number % 3 == 0],
                **reals,
            ),
        )


class Passages:
    """The interface of ``Tally``: how many pass each cell."""

    def __init__(self, passages):
        self.passages = passages

    @classmethod
    def of(cls, flights, site):
        cells = flights.visits.cell
        return cls(np.bincount(cells[cells >= 0], minlength=site.results.rows**2))

    def arrays(self):
        return {"passages": self.passages}


def prepared(scene, device, fingerprint):
    method = Method(duration=scene.run.duration, dt=scene.run.dt, sweeps=scene.run.fatal)
    work = task.Work(SITE, (ROCK,), method, device, fingerprint, Skating, Passages.of)
    return task.Prepared(work, Releases(scene))


def write_results(folder, scene, prepared, chunks):
    """Stands in for ``finish.finish``; a line a trajectory, a number a cell."""
    lines = [
        f"{number},{','.join(map(repr, place))}\n"
        for chunk in chunks
        for number, place in zip(
            chunk.flights.id.tolist(), chunk.flights.position.tolist(), strict=True
        )
    ]
    passages = sum(chunk.tally["passages"] for chunk in chunks)
    texts = ("".join(lines), " ".join(map(str, passages)))
    for name, text in zip(RESULTS, texts, strict=True):
        swap(folder / name, lambda part, text=text: part.write_text(text))


def stand_in(put=setattr):
    """Put the stand-ins in the place of what they stand for."""
    put(task, "prepared", prepared)
    put(finish, "finish", write_results)
    put(ensemble, "_device", lambda name: name)


def main(directory, arguments):
    """Run in a process of its own: a folder, and keywords of scene and run in JSON."""
    stand_in()
    keywords = json.loads(arguments)
    scene_of = scene(Path(directory).parent, **keywords.pop("scene", {}))
    shard = keywords.pop("shard", None)
    share = Share(Shard(*shard)) if shard else ensemble.WHOLE
    return ensemble.run_rockfall(scene_of, directory, share=share, **keywords)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
