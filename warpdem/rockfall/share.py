"""Which part of an ensemble a process flies, and on what: --shard, --workers and --scheduler."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from warpdem.errors import WarpdemError

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True)
class Shard:
    """Every ``count``-th chunk of an ensemble, for one of ``count`` processes.

    Attributes:
        number: Of the process, from 1.
        count: Of processes.
    """

    number: int
    count: int

    def __str__(self) -> str:
        return f"{self.number}/{self.count}"

    def of(self, chunks: Iterable[int]) -> list[int]:
        """Those of the chunks that are this shard's."""
        return [chunk for chunk in chunks if chunk % self.count == self.number - 1]


@dataclass(frozen=True)
class Share:
    """Which part of an ensemble this process flies, and on what.

    Attributes:
        shard: The part; None: all of it, and the results.
        workers: None: threads of this process; "dask": worker processes.
        scheduler: Address of a running Dask scheduler; None: workers on this machine.

    Raises:
        WarpdemError: The workers are of no known kind, or a scheduler has none to direct.
    """

    shard: Shard | None = None
    workers: str | None = None
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.workers not in {None, "dask"}:
            raise WarpdemError(f'workers = "{self.workers}": must be "dask"')
        if self.scheduler and not self.workers:
            raise WarpdemError(
                f"--scheduler {self.scheduler}: only with --workers dask, whose scheduler it names"
            )


def shard_of(text: str) -> Shard:
    """The shard of a text such as ``2/4``.

    Raises:
        ValueError: It is none.
    """
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
    shard = Shard(int(match[1]), int(match[2])) if match else None
    if shard is None or not 1 <= shard.number <= shard.count:
        raise ValueError(f"{text!r} is not a shard such as 2/4, the second of four")
    return shard
