"""The folder of the chunks: the plan they follow, which of them are there, adding one."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from warpdem.errors import OutputError, WarpdemError
from warpdem.output.durable import create, replace, sync
from warpdem.output.writer import told
from warpdem.rockfall.chunks import LAYOUT, Chunk, ForeignChunkError, Plan, read
from warpdem.rockfall.fingerprint import fingerprint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path


@dataclass(frozen=True)
class Agreement:
    """What all processes that fill a folder agree on (plan.json).

    Attributes:
        plan: How the ensemble is cut.
        keys: The scene's decisive keys.
    """

    plan: Plan
    keys: dict[str, Any]


def agreed(path: Path) -> Agreement | None:
    """The agreement of a folder of chunks, None when there is none yet.

    Raises:
        OutputError: It cannot be read.
        WarpdemError: It is of another layout.
    """
    file = path / "plan.json"
    try:
        facts = json.loads(file.read_bytes())
        layout = facts["layout"]
        found = Agreement(Plan(**facts["plan"]), facts["keys"]) if layout == LAYOUT else None
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError as fault:
        raise OutputError(told(fault)) from fault
    except (ValueError, KeyError, TypeError) as fault:
        raise OutputError(f"{file}: not a readable plan ({fault}); --force starts again") from fault
    if found is None:
        raise WarpdemError(
            f"{file}: written in layout {layout}, this program reads layout {LAYOUT}; "
            "give another --out, or --force to start again"
        )
    return found


def agree(path: Path, proposal: Agreement) -> Agreement:
    """Propose an agreement: that of the first who did holds for all.

    Raises:
        OutputError: The folder cannot be written.
    """
    text = json.dumps({"layout": LAYOUT, **asdict(proposal)}, indent=1, sort_keys=True) + "\n"
    try:
        path.mkdir(exist_ok=True)
        create(path / "plan.json", text.encode())
        sync(path)
    except OSError as fault:
        raise OutputError(told(fault)) from fault
    return agreed(path) or proposal


class ChunkFolder:
    """The chunks of one ensemble on disk; iterating reads them in order.

    Attributes:
        path: The folder.
        plan: How the ensemble is cut.
        fingerprint: Of the scene.
    """

    def __init__(self, path: Path, agreement: Agreement) -> None:
        self.path = path
        self.plan = agreement.plan
        self.fingerprint = fingerprint(agreement.keys)

    def file(self, index: int) -> Path:
        """Where a chunk lies."""
        return self.path / f"chunk_{index:06d}.npz"

    def __len__(self) -> int:
        return len(self.plan)

    def __iter__(self) -> Iterator[Chunk]:
        """Read the chunks that are there, in order.

        Raises:
            OutputError: One cannot be read, or does not belong there.
        """
        for index in self.present():
            try:
                yield self._read(index)
            except ForeignChunkError:
                raise
            except OutputError as fault:
                raise OutputError(f"{fault}; --resume makes it again") from fault

    def present(self) -> list[int]:
        """The chunks that are there, whole or damaged."""
        return [index for index in range(len(self)) if self.file(index).exists()]

    @property
    def complete(self) -> bool:
        """Every chunk is there."""
        return all(self.file(index).exists() for index in range(len(self)))

    def missing(self, wanted: Iterable[int], tell: Callable[[str], object]) -> list[int]:
        """Those of some chunks that are absent, or damaged.

        Args:
            wanted: The chunks.
            tell: Is told of each damaged one.

        Raises:
            ForeignChunkError: One does not belong there.
        """
        return [index for index in wanted if not self._is_sound(index, tell)]

    def _is_sound(self, index: int, tell: Callable[[str], object]) -> bool:
        if not self.file(index).exists():
            return False
        try:
            self._read(index)
        except ForeignChunkError as fault:
            raise ForeignChunkError(
                f"{fault}; remove it, give another --out, or --force to start again"
            ) from fault
        except OutputError as fault:
            tell(f"{fault}: it is made again")
            return False
        return True

    def _read(self, index: int) -> Chunk:
        return read(self.file(index), index, self.plan, self.fingerprint)

    def store(self, index: int, data: bytes) -> None:
        """Keep a chunk: its file is whole or absent, whenever the power goes.

        Raises:
            OutputError: The disk is full; the chunks that are there stay good.
        """
        try:
            replace(self.file(index), lambda part: part.write_bytes(data))
            sync(self.path)
        except OSError as fault:
            raise OutputError(told(fault)) from fault
