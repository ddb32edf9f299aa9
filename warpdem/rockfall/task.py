"""What is to be flown, and how one bundle of it becomes a chunk."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np

from warpdem import __version__
from warpdem.errors import SceneError
from warpdem.rockfall.chunks import Chunk, encode

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from warpdem.arrays import IntArray
    from warpdem.input.scene import Scene
    from warpdem.rockfall.flights import Flights, Method, Starts
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site

TRIED = 10_000
"""Trajectories whose starts are tried before the first one is flown."""

SLOTS, CUDA_SLOTS = 128, 65_536
"""Rocks in flight at a time on a host thread, and on a CUDA device."""


class Flyer(Protocol):
    """Flies bundles of trajectories, for one thread (``trajectories.Trajectories``)."""

    def load(self) -> None:
        """Load the kernels, compiling what is not yet."""
        ...

    def twin(self) -> Self:
        """Another one for another thread; what does not change is shared."""
        ...

    def fly(self, starts: Starts, *, stop: Callable[[], bool] | None = None) -> Flights:
        """Fly rocks until each has ended; how they are bundled does not change a bit.

        ``stop`` is asked many times a second whether to give up, which raises an exception.
        """
        ...

    def follow(self, starts: Starts, every: float) -> Sequence[Any]:
        """Fly rocks and sample each in time, every so many seconds [s]."""
        ...


class Origins(Protocol):
    """Where trajectories start, by global ids (``releases.Releases``, ``bodies.Bodies``)."""

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

    def flyer(self, slots: int | None = None) -> Flyer:
        """A flyer for one thread, its kernels compiled.

        Args:
            slots: Most rocks in flight at a time; there are never more than by default.
        """
        usual = CUDA_SLOTS if self.is_cuda else SLOTS
        room = usual if slots is None else min(usual, slots)
        flyer = self.make(self.site, self.rocks, self.method, device=self.device, slots=room)
        flyer.load()
        return flyer

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
    releases: Origins


def prepared(scene: Scene, device: str, fingerprint: str) -> Prepared:
    """Read all the files of a scene and lay out site, rocks and releases.

    Args:
        scene: With ``run.method`` "nonsmooth".
        device: Name of the Warp device.
        fingerprint: Of the scene.

    Raises:
        WarpdemError: A file cannot be read, the scene cannot be built, a rock would start where
            there is no ground, or a format of the results cannot be written here.
    """
    from warpdem.rockfall.bodies import Bodies  # noqa: PLC0415 - only to run
    from warpdem.rockfall.prepare import (  # noqa: PLC0415 - the same
        lacking_formats,
        method_of,
        site_of,
    )
    from warpdem.rockfall.releases import Releases  # noqa: PLC0415 - the same
    from warpdem.rockfall.rocks import rocks_of  # noqa: PLC0415 - the same
    from warpdem.rockfall.tally import Tally  # noqa: PLC0415 - the same
    from warpdem.rockfall.trajectories import Trajectories  # noqa: PLC0415 - loads Warp

    if problems := lacking_formats(scene):
        raise SceneError(str(scene.source or "scene"), problems)
    site = site_of(scene)
    if scene.release:
        rocks = rocks_of(scene)
        releases = Releases(scene, site, rocks)
    else:
        releases = Bodies(scene, site)
        rocks = releases.rocks
    releases.starts(np.arange(min(releases.count, TRIED)))  # before older results are replaced
    work = Work(site, rocks, method_of(scene), device, fingerprint, Trajectories, Tally.of)
    return Prepared(work, releases)
