"""What is to be flown, and how one bundle of it becomes a chunk."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from warpdem import __version__
from warpdem.rockfall.bundles import joined, part
from warpdem.rockfall.chunks import Chunk, encode

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from warpdem.arrays import IntArray
    from warpdem.input.scene import Scene
    from warpdem.rockfall.flights import Flights, Method, Starts
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site

SLOTS, CUDA_SLOTS = 256, 65_536
"""Rocks in flight at a time on a host thread, and on a CUDA device."""

SLICE_SECONDS = 0.25
"""Wall-clock time a bundle should take [s]: nobody waits longer for an interruption."""

FIRST_SLICE, GROWTH = 4, 8
"""Trajectories of a thread's first bundle, and the most by which the next one grows."""


class Flyer(Protocol):
    """Flies bundles of trajectories, for one thread (``trajectories.Trajectories``)."""

    def fly(self, starts: Starts) -> Flights:
        """Fly rocks until each has ended; how they are bundled does not change a bit."""
        ...

    def follow(self, starts: Starts, every: float) -> Sequence[Any]:
        """Fly rocks and sample each in time, every so many seconds [s]."""
        ...


class Releases(Protocol):
    """Where trajectories start, by their global ids (``releases.Releases``)."""

    @property
    def count(self) -> int:
        """Of trajectories."""
        ...

    def starts(self, ids: IntArray) -> Starts:
        """The starts of some trajectories."""
        ...


class Tally(Protocol):
    """Statistics of some trajectories (``tally.Tally``)."""

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All of it by name."""
        ...


@dataclass(frozen=True, eq=False)
class Work:
    """What every chunk needs, wherever it is flown; it travels to other processes.

    Attributes:
        site: What trajectories meet.
        rocks: The rocks, by number.
        method: How they are stepped.
        device: Name of the Warp device.
        fingerprint: Of the scene.
        make: The class of flyers.
        count: Makes the tally of a bundle.
        program: Version of warpdem that made it.
    """

    site: Site
    rocks: tuple[Rock, ...]
    method: Method
    device: str
    fingerprint: str
    make: Callable[..., Flyer]
    count: Callable[[Flights, Site], Tally]
    program: str = __version__

    @property
    def is_cuda(self) -> bool:
        """Whether a GPU flies."""
        return self.device.startswith("cuda")

    def flyer(self) -> Flyer:
        """A flyer for one thread, its kernels compiled."""
        slots = CUDA_SLOTS if self.is_cuda else SLOTS
        return self.make(self.site, self.rocks, self.method, device=self.device, slots=slots)

    def chunk(self, index: int, flights: Flights) -> bytes:
        """The file of a chunk's flights."""
        tally = self.count(flights, self.site)
        return encode(Chunk(index, flights, tally.arrays()), self.fingerprint)


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scene made ready to fly.

    Attributes:
        work: What every chunk needs.
        releases: Where trajectories start.
    """

    work: Work
    releases: Releases


def prepared(scene: Scene, device: str, fingerprint: str) -> Prepared:
    """Read all the files of a scene and lay out site, rocks and releases.

    Args:
        scene: With ``run.method`` "nonsmooth".
        device: Name of the Warp device.
        fingerprint: Of the scene.

    Raises:
        WarpdemError: A file cannot be read, or the scene cannot be built.
    """
    from warpdem.rockfall.prepare import method_of, site_of  # noqa: PLC0415 - only to run
    from warpdem.rockfall.releases import Releases  # noqa: PLC0415 - the same
    from warpdem.rockfall.rocks import rocks_of  # noqa: PLC0415 - the same
    from warpdem.rockfall.tally import Tally  # noqa: PLC0415 - the same
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - loads Warp

    site, rocks = site_of(scene), rocks_of(scene)
    work = Work(site, rocks, method_of(scene), device, fingerprint, Trajectories, Tally.of)
    return Prepared(work, Releases(scene, site, rocks))


class Pilot:
    """Flies chunks with one flyer, in bundles short enough to stop between them.

    Attributes:
        flyer: The flyer.
        clock: Wall clock [s].
    """

    def __init__(self, flyer: Flyer, clock: Callable[[], float] = time.monotonic) -> None:
        self.flyer = flyer
        self.clock = clock
        self._size = FIRST_SLICE

    def fly(
        self,
        starts: Starts,
        stop: Callable[[], bool] = lambda: False,
        tell: Callable[[int], object] = lambda _count: None,
    ) -> Flights | None:
        """Fly a chunk.

        Args:
            starts: Of its trajectories.
            stop: Asked between bundles whether to abandon it.
            tell: Is told how many trajectories of each bundle have ended.

        Returns:
            The flights; None if it was abandoned.
        """
        bundles, first, count = [], 0, len(starts.id)
        while first < count:
            if stop():
                return None
            last = min(first + self._size, count)
            began = self.clock()
            bundles.append(self.flyer.fly(part(starts, first, last)))
            self._adapt(last - first, self.clock() - began)
            tell(last - first)
            first = last
        return joined(bundles)

    def _adapt(self, flown: int, seconds: float) -> None:
        """Have the next bundle take the time it should, by what the last one took."""
        fitting = int(flown * SLICE_SECONDS / max(seconds, 1e-9))
        self._size = max(1, min(fitting, GROWTH * self._size))
