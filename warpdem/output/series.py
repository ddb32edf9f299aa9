"""Numbered frames and their index in time, a ParaView collection (.pvd)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpdem.output.durable import replace, swap

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path


class Series:
    """Frames ``<stem>_000000.vtu`` and on, listed with their times in ``<stem>.pvd``.

    Attributes:
        times: Simulated time of each frame [s].
    """

    def __init__(self, folder: Path, stem: str, times: Sequence[float] = ()) -> None:
        self.folder = folder
        self.stem = stem
        self.times = list(times)

    @property
    def index(self) -> Path:
        """The collection, which ParaView opens."""
        return self.folder / f"{self.stem}.pvd"

    def frame(self, number: int) -> Path:
        """File of one frame."""
        return self.folder / f"{self.stem}_{number:06d}.vtu"

    def append(self, time: float, write: Callable[[Path], object]) -> None:
        """Add a frame; the index names it only when it is whole.

        Args:
            time: Simulated time of the frame [s].
            write: Writes the frame at the path it is given.

        Raises:
            OSError: The disk is full; the index still lists the frames before.
        """
        replace(self.frame(len(self.times)), write)
        self.times.append(time)
        self.write_index()

    def write_index(self) -> None:
        """List the frames written so far."""
        entries = [
            f'    <DataSet timestep="{time!r}" part="0" file="{self.frame(number).name}"/>\n'
            for number, time in enumerate(self.times)
        ]
        head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
        text = f"{head}{''.join(entries)}  </Collection>\n</VTKFile>\n"
        swap(self.index, lambda part: part.write_bytes(text.encode()))

    def truncate(self, count: int) -> None:
        """Forget the frames from number ``count`` on, those of the disk included."""
        del self.times[count:]
        for path in self.folder.glob(f"{self.stem}_*.vtu"):
            number = path.stem.removeprefix(f"{self.stem}_")
            if number.isdecimal() and path == self.frame(int(number)) and int(number) >= count:
                path.unlink()
        self.write_index()
