"""Instructions per body and step, counted by callgrind, and their comparison with a file."""

from __future__ import annotations

import json
import re
import sys
import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from speed import scenes
from speed.packings import run
from speed.peers import without

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from speed.problem import Problem
    from speed.report import Cell

COUNTED = Path(__file__).with_name("counted.py")
TOLERANCE = 0.03
"""Growth of instructions per body-step that is still the same speed."""
COLUMNS = ("case", "instructions/body-step", "in the file", "change", "contacts", "candidates", "")
Counts = dict[str, float]


@dataclass(frozen=True)
class Small:
    """A problem small enough for valgrind.

    Attributes:
        make: Its start.
        warm: Steps until it lies.
        steps: Steps counted.
    """

    make: Callable[[], Problem]
    warm: int
    steps: int


SMALL = {
    "spheres": Small(partial(scenes.spheres, 125, 5), 5000, 200),
    "cubes": Small(partial(scenes.cubes, 64, 4), 4000, 100),
    "octahedra": Small(partial(scenes.octahedra, 64, 4), 4000, 100),
}


def missing() -> str | None:
    """Why nothing can be counted here."""
    return without("valgrind")


def count(small: Small) -> Counts:
    """Instructions per body-step of a small case, with contacts and candidates at its end."""
    with tempfile.TemporaryDirectory() as place:
        scene = Path(place) / "scene.toml"
        scene.write_text(scenes.text(small.make()), encoding="utf-8")
        command = [sys.executable, str(COUNTED), str(scene)]
        # without valgrind first: it compiles
        run([*command, "--warm", "1", "--steps", "1"])
        out = Path(place) / "callgrind.out"
        tool = ["valgrind", "--tool=callgrind", "--instr-atstart=no"]
        tool.append(f"--callgrind-out-file={out}")
        command += ["--warm", str(small.warm), "--steps", str(small.steps)]
        found = json.loads(run([*tool, *command]).splitlines()[-1])
        return per_body_step(out.read_text(encoding="utf-8"), found)


def per_body_step(callgrind: str, found: Mapping[str, float]) -> Counts:
    """What the file keeps of a case, from callgrind's output and the run's own words."""
    total = int(re.findall(r"^(?:summary|totals): (\d+)", callgrind, re.MULTILINE)[-1])
    each = total / (found["bodies"] * found["steps"])
    return {"instructions": round(each, 1)} | {k: found[k] for k in ("contacts", "candidates")}


def judged(name: str, now: Counts, then: Counts | None) -> tuple[Cell, ...]:
    """A row of the table; its last cell says whether the case grew."""
    grown = now["instructions"] / then["instructions"] - 1.0 if then else None
    word = None if grown is None else "GREW" if grown > TOLERANCE else "kept"
    change = None if grown is None else f"{100.0 * grown:+.1f} %"
    before = then["instructions"] if then else None
    return (name, now["instructions"], before, change, now["contacts"], now["candidates"], word)


def read(file: Path) -> dict[str, Counts]:
    """Counts by case; empty when there is no file."""
    return json.loads(file.read_text(encoding="utf-8"))["cases"] if file.exists() else {}


def write(file: Path, counts: Mapping[str, Counts]) -> None:
    """Counts by case, with how they were made."""
    whole = {
        "what": "instructions per body and step of one thread, kernels for x86-64-v3, by callgrind",
        "command": "python tools/bench/regress.py --write",
        "tolerance": TOLERANCE,
        "cases": dict(counts),
    }
    part = file.with_suffix(".part")
    part.write_text(json.dumps(whole, indent=1) + "\n", encoding="utf-8")
    part.replace(file)
