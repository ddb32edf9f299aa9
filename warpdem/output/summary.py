"""What became of a run, in numbers (summary.json)."""

from __future__ import annotations

import json
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from warpdem.output.durable import replace

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

LIBRARIES = ("warp-lang", "numpy", "vtk", "pydantic")
"""Distributions whose versions results may depend on."""


def versions(program: str) -> dict[str, str]:
    """Versions of the program, of Python and of the libraries results may depend on."""
    found = {"warpdem": program, "python": platform.python_version()}
    for name in LIBRARIES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "absent"
    return found


def save(path: Path, facts: Mapping[str, Any]) -> None:
    """Write the facts as JSON, the old file staying until the new one is whole.

    Raises:
        OSError: The disk is full.
    """
    text = json.dumps(facts, indent=2, default=_plain) + "\n"
    replace(path, lambda part: part.write_bytes(text.encode()))


def _plain(value: Any) -> Any:
    """NumPy numbers and arrays as numbers and lists; everything else as its text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)
