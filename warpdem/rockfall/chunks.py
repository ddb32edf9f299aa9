"""An ensemble in chunks: which trajectories each holds, and its file."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.errors import OutputError
from warpdem.rockfall.flights import Crossings, Flights, Visits

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from warpdem.arrays import IntArray

LAYOUT = 1
"""Of a chunk's file and of the plan; a change makes older ones unreadable, and says so."""

CHUNKS_A_THREAD = 20
"""Chunks for each host thread where the scene does not say how large they are."""

SIZES = (50, 20_000)
"""Least and most trajectories of such a chunk on the CPU."""

CUDA_SIZES = (5_000, 50_000)
"""The same on a CUDA device, which flies one chunk at a time; a launch needs many rocks."""

_FLIGHT, _CROSSING, _TALLY = "flight/", "crossing/", "tally/"
_ROWS = [field.name for field in fields(Flights) if field.name not in {"visits", "crossings"}]
_CROSSING_ROWS = [field.name for field in fields(Crossings)]


@dataclass(frozen=True)
class Plan:
    """How an ensemble is cut into chunks.

    Attributes:
        count: Of trajectories; their global ids are 0 to count - 1.
        size: Trajectories in each chunk but the last.
    """

    count: int
    size: int

    def __len__(self) -> int:
        """Number of chunks."""
        return max(0, -(-self.count // self.size))

    def ids(self, index: int) -> IntArray:
        """Global ids of the trajectories of a chunk, rising."""
        return np.arange(index * self.size, min((index + 1) * self.size, self.count))

    def trajectories(self, index: int) -> int:
        """How many a chunk holds."""
        return min(self.size, self.count - index * self.size)


def planned(count: int, size: int | None, threads: int, *, cuda: bool) -> Plan:
    """The plan of an ensemble, on the scene's chunk size or on one that suits the machine.

    Args:
        count: Of trajectories.
        size: Of a chunk, if the scene says so.
        threads: Threads or worker processes that fly chunks, of all shards together.
        cuda: Whether they are flown on a CUDA device.
    """
    if size is None:
        least, most = CUDA_SIZES if cuda else SIZES
        size = min(max(-(-count // (CHUNKS_A_THREAD * threads)), least), most)
    return Plan(count, size)


@dataclass(frozen=True, eq=False)
class Chunk:
    """What is kept of the trajectories of a chunk.

    Attributes:
        index: Of the chunk.
        flights: Its trajectories, without their visits.
        tally: Arrays of the tally of their visits, by name.
    """

    index: int
    flights: Flights
    tally: dict[str, NDArray[Any]]


class ForeignChunkError(OutputError):
    """A chunk of another scene, another program or another place."""


def encode(chunk: Chunk, fingerprint: str) -> bytes:
    """The contents of a chunk's file; equal chunks give equal bytes."""
    head = {"layout": LAYOUT, "index": chunk.index, "fingerprint": fingerprint}
    flights = chunk.flights
    arrays: dict[str, Any] = {_FLIGHT + name: getattr(flights, name) for name in _ROWS}
    arrays |= {_CROSSING + name: getattr(flights.crossings, name) for name in _CROSSING_ROWS}
    arrays |= {_TALLY + name: values for name, values in chunk.tally.items()}
    buffer = io.BytesIO()
    np.savez(buffer, head=np.array(json.dumps(head)), **arrays)
    return buffer.getvalue()


def read(path: Path, index: int, plan: Plan, fingerprint: str) -> Chunk:
    """The chunk of a file, every byte of it checked.

    Raises:
        ForeignChunkError: It is whole, but not the chunk that belongs there.
        OutputError: It cannot be read, or is damaged.
    """
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(str(arrays.pop("head")))
        _refuse_foreign(path, head, index, fingerprint)
        chunk = Chunk(index, _flights(arrays), _stripped(arrays, _TALLY))
    except ForeignChunkError:
        raise
    except Exception as fault:  # a damaged archive raises what its bytes happen to mean
        raise OutputError(f"{path}: not a readable chunk ({fault})") from fault
    if not np.array_equal(chunk.flights.id, plan.ids(index)):
        raise ForeignChunkError(f"{path}: holds other trajectories than those of chunk {index}")
    return chunk


def _refuse_foreign(path: Path, head: dict[str, Any], index: int, fingerprint: str) -> None:
    if head.get("layout") != LAYOUT:
        raise ForeignChunkError(
            f"{path}: written in layout {head.get('layout')}, this program reads layout {LAYOUT}"
        )
    if head.get("fingerprint") != fingerprint:
        raise ForeignChunkError(f"{path}: made from another scene or by another version")
    if head.get("index") != index:
        raise ForeignChunkError(f"{path}: holds chunk {head.get('index')}, not {index}")


def _flights(arrays: dict[str, NDArray[Any]]) -> Flights:
    rows, crossings = _stripped(arrays, _FLIGHT), _stripped(arrays, _CROSSING)
    return Flights(
        **{name: rows[name] for name in _ROWS},
        visits=_no_visits(),
        crossings=Crossings(**{name: crossings[name] for name in _CROSSING_ROWS}),
    )


def _stripped(arrays: dict[str, NDArray[Any]], prefix: str) -> dict[str, NDArray[Any]]:
    return {
        name.removeprefix(prefix): values
        for name, values in arrays.items()
        if name.startswith(prefix)
    }


def _no_visits() -> Visits:
    none: dict[str, Any] = {field.name: np.zeros(0, np.float32) for field in fields(Visits)}
    none |= {name: np.zeros(0, np.int64) for name in ("id", "cell")}
    return Visits(**none)
