"""Checkpoints: all a run needs to go on as though it had never stopped (checkpoint.npz)."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.errors import OutputError, WarpdemError
from warpdem.output.durable import replace, sync

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from warpdem.input.scene import Scene

VERSION = 1
"""Of the file's layout; a change makes older checkpoints unreadable, and says so."""

_STATE = "state/"


@dataclass(frozen=True)
class Checkpoint:
    """A state of the simulation, and what the files held at that instant.

    Attributes:
        scene: The scene in flat form, as :func:`flat_scene` returns it.
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


def flat_scene(scene: Scene) -> dict[str, Any]:
    """Key paths such as ``contact[0].mu`` and their values; a shape's file by its contents too."""
    flat = dict(leaves(scene.model_dump(mode="json")))
    for index, shape in enumerate(scene.shape):
        if file := getattr(shape, "file", None):
            flat[f"shape[{index}].file (contents)"] = digest(scene.directory / file)
    return flat


def digest(path: Path) -> str:
    """What stands for the contents of a file: their hash, or why it cannot be read."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError as fault:
        return str(fault.strerror)


def changed_keys(old: dict[str, Any], new: dict[str, Any]) -> list[str]:
    """Key paths that differ and that the motion depends on, sorted."""
    absent = object()
    return sorted(
        key
        for key in old.keys() | new.keys()
        if old.get(key, absent) != new.get(key, absent) and not _may_change(key)
    )


def _may_change(key: str) -> bool:
    if key == "output.energy":  # its sums run from the start
        return False
    return key in {"title", "run.duration", "run.device"} or key.startswith("output.")


def leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Key paths such as ``contact[0].mu`` of nested tables, and their values."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
        for index, item in enumerate(value):
            yield from leaves(item, f"{path}[{index}]")
    else:
        yield path, value
