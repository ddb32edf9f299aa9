"""Where a case starts: its bodies settled by warpdem once, kept in a folder, given to every engine.

Positions and orientations alone are kept: all engines start from them at rest and without friction
history, and build theirs up in the steps before the clock starts.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from speed import scenes

if TYPE_CHECKING:
    from speed.problem import Problem

ROOT = Path(__file__).resolve().parents[3]
WORKER = Path(__file__).with_name("worker.py")


@dataclass(frozen=True)
class Folder:
    """Where scenes and settled states are kept."""

    path: Path

    def scene(self, problem: Problem, *, extra: str = "") -> Path:
        """The problem's scene file."""
        words = scenes.text(problem, extra=extra)
        file = self.path / f"{problem.name}-{_key(words)}.toml"
        file.write_text(words, encoding="utf-8")
        return file

    def settled(self, problem: Problem, steps: int) -> Problem:
        """The problem after so many steps, at rest where it is then; run when not yet kept."""
        if not steps:
            return problem
        scene = self.scene(problem)
        state = scene.with_name(f"{scene.stem}-{steps}.npz")
        if not state.exists():
            print(f"settling {problem.name}: {steps} steps, once", file=sys.stderr, flush=True)
            part = state.with_suffix(".part.npz")
            worker(scene, threads=2, warm=steps - 1, steps=1, save=part)
            part.replace(state)
        with np.load(state) as kept:
            return problem.at(kept["position"], kept["orientation"])


def _key(words: str) -> str:
    return hashlib.sha256(words.encode()).hexdigest()[:12]


def worker(
    scene: Path,
    *,
    threads: int = 1,
    warm: int = 0,
    steps: int,
    save: Path | None = None,
    device: str = "cpu",
) -> dict[str, Any]:
    """One run of warpdem in its own process; what ``worker.py`` prints."""
    command = [sys.executable, str(WORKER), str(scene)]
    command += ["--threads", str(threads), "--warm", str(warm), "--steps", str(steps)]
    command += ["--device", device, *(["--save", str(save)] if save else [])]
    return json.loads(run(command).splitlines()[-1])


def run(command: list[str], **more: Any) -> str:
    """Standard output of a program.

    Raises:
        RuntimeError: It failed; with the end of what it said.
    """
    path = os.pathsep.join([str(ROOT), str(Path(__file__).parents[1])])
    paths = {**os.environ, "PYTHONPATH": path, "PYTHONHASHSEED": "0"}
    ran = subprocess.run(
        command, capture_output=True, text=True, check=False, **({"env": paths} | more)
    )
    if ran.returncode:
        said = (ran.stderr.strip() or ran.stdout.strip())[-800:]
        raise RuntimeError(f"{' '.join(command[:3])} ended with {ran.returncode}: {said}")
    return ran.stdout
