"""Checkpoints: all a run needs to go on as though it had never stopped (checkpoint.npz)."""

from __future__ import annotations

import io
import json
import zipfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.errors import OutputError, WarpdemError
from warpdem.output.durable import replace, sync
from warpdem.output.scene_keys import differing

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

VERSION = 2
"""Of the file's layout; a change makes older checkpoints unreadable, and says so."""

_STATE = "state/"


@dataclass(frozen=True)
class Checkpoint:
    """A state of the simulation, and what the files held at that instant.

    Attributes:
        scene: The scene in flat form, as ``scene_keys.flat_scene`` returns it.
        time: Simulated time [s].
        step: Steps done.
        frame_due: When the last frame was due [s]; negative before the first.
        frame_count: Instants recorded.
        checkpoint_due: When the last checkpoint was due [s].
        frame_times: Times of the frames written [s], by series.
        table_lengths: Bytes written, by table.
        state: What ``Simulation.checkpoint`` returned.
    """

    scene: dict[str, Any]
    time: float
    step: int
    frame_due: float
    frame_count: int
    checkpoint_due: float
    frame_times: dict[str, list[float]]
    table_lengths: dict[str, int]
    state: dict[str, NDArray[Any]] = field(repr=False)


def save(path: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint; the one before stays until this one is on the disk.

    Raises:
        OSError: The disk is full; the one before is untouched.
    """
    head = {name: value for name, value in vars(checkpoint).items() if name != "state"}
    arrays: dict[str, Any] = {_STATE + name: value for name, value in checkpoint.state.items()}
    buffer = io.BytesIO()
    np.savez(buffer, head=np.array(json.dumps({"version": VERSION, **head})), **arrays)
    replace(path, lambda part: part.write_bytes(buffer.getbuffer()))
    sync(path.parent)  # its new name, and those of the frames before it


def load(path: Path) -> Checkpoint:
    """Read a checkpoint.

    Raises:
        WarpdemError: There is none, or it is of another version.
        OutputError: It cannot be read, or is damaged.
    """
    try:
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        head = json.loads(str(arrays.pop("head")))
        version = head.pop("version")
    except FileNotFoundError:
        raise WarpdemError(f"{path}: no checkpoint to resume from") from None
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as fault:
        raise OutputError(f"{path}: not a readable checkpoint ({fault})") from fault
    if version != VERSION:
        raise WarpdemError(
            f"{path}: written in layout {version}, this program reads layout {VERSION}"
        )
    state = {name.removeprefix(_STATE): values for name, values in arrays.items()}
    return Checkpoint(state=state, **head)


def changed_keys(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """Key paths that differ and that the motion depends on, sorted."""
    return [key for key in differing(old, new) if not _may_change(key)]


def _may_change(key: str) -> bool:
    if key == "output.energy":  # its sums run from the start
        return False
    return key in {"title", "run.duration", "run.device"} or key.startswith("output.")
