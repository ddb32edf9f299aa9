"""Mass properties that took long to integrate, kept in the user's cache for the next start."""

from __future__ import annotations

import hashlib
import os
import platform
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from warpdem.geometry.moments import MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable

    from warpdem.geometry.core import Core

SLOW = 0.05
"""Integrations that took longer are kept [s]."""

SOURCES = ("geometry", "filling")
"""Folders of the modules that integrate: when they change, nothing is remembered."""


def remembered(
    integrate: Callable[[Core, float], MassProperties], core: Core, radius: float
) -> MassProperties:
    """What ``integrate`` says of a core and its rounding [m], or has said: the same numbers."""
    file = folder() / f"{_key(core, radius)}.npz"
    if known := _read(file):
        return known
    begin = time.perf_counter()
    found = integrate(core, radius)
    if time.perf_counter() - begin > SLOW:
        _write(file, found)
    return found


def folder() -> Path:
    """Where it is kept: ``$WARPDEM_CACHE_PATH``, or ``warpdem`` in the user's cache."""
    if chosen := os.environ.get("WARPDEM_CACHE_PATH"):
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "warpdem"


def _key(core: Core, radius: float) -> str:
    facets = core.facets
    told = hashlib.sha256(f"{np.__version__} {platform.machine()} {core.closed}".encode())
    for part in (core.vertices, facets.sides, facets.start, core.twin, core.wires, core.points):
        array = np.ascontiguousarray(part)
        told.update(f"{array.shape} {array.dtype}".encode() + array.tobytes())
    told.update(np.float64(radius).tobytes())
    package = Path(__file__).parents[1]
    for name in SOURCES:
        for module in sorted((package / name).glob("*.py")):
            told.update(module.read_bytes())
    return told.hexdigest()


def _read(file: Path) -> MassProperties | None:
    """What a file says; None if it is not there, or not whole."""
    try:
        with file.open("rb") as whole, np.load(whole) as kept:
            values, centre, inertia = kept["values"], kept["centre"], kept["inertia"]
    except (OSError, ValueError, KeyError, EOFError, BadZipFile):
        return None
    return MassProperties(float(values[0]), centre, inertia, float(values[1]))


def _write(file: Path, found: MassProperties) -> None:
    """Keep it, whole or not at all; where nothing can be written it will be integrated again."""
    values = np.array([found.volume, found.error])
    part = file.with_suffix(f".{os.getpid()}.npz")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savez(part, values=values, centre=found.centre, inertia=found.inertia_over_mass)
        part.replace(file)
    except OSError:
        with suppress(OSError):
            part.unlink()
