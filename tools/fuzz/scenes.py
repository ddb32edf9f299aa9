"""Mutated scenes and files through the program: each has to pass or be refused with a reason."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

import corpus
import structures
import texts
from worker import SCENE, Case, Ending, Worker, put

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable

LIMIT = 90.0
"""Longest time that a check may take [s]: masses of solids that are not convex may take 30."""
RUN_LIMIT = 120.0
"""Longest time of a command [s]; kernels may have to be compiled."""
TRIES = 200
"""Most attempts to make a failing case smaller."""


class Mutator:
    """Draws cases; the same ones for the same seed."""

    def __init__(self, seed: int) -> None:
        self._random = Random(seed)  # noqa: S311 - it repeats, and keeps no secret
        self._scenes = corpus.scenes()
        self._texts = [text.encode() for text in self._scenes.values()]
        with tempfile.TemporaryDirectory() as folder:
            self._files = {
                name: (Path(folder) / name).read_bytes() for name in corpus.write(Path(folder))
            }
        self._readers = {
            file: [name for name, text in self._scenes.items() if file in text]
            for file in self._files
        }

    def case(self) -> Case:
        """A mutated text, mutated tables, or a mutated file under a scene that reads it."""
        random = self._random
        choice = random.random()
        name = random.choice(list(self._scenes))
        text = self._scenes[name]
        if choice < 0.25:
            file = random.choice([file for file, readers in self._readers.items() if readers])
            name = random.choice(self._readers[file])
            changed = texts.mutate(self._files[file], random, list(self._files.values()))
            return Case(name, self._scenes[name].encode(), {file: changed})
        if choice < 0.65:
            return Case(name, structures.mutate(text, random).encode("utf-8", "surrogatepass"))
        return Case(name, texts.mutate(text.encode(), random, self._texts))


def main(asked: argparse.Namespace) -> int:
    """The command: number of kinds of failures."""
    return fuzz(asked.count, asked.seed, asked.out, asked.commands)


def fuzz(count: int, seed: int, folder: Path, commands: int) -> int:
    """Examine so many cases, some of them on the command line; the number of kinds of failures."""
    mutator, worker = Mutator(seed), Worker(LIMIT)
    counts: Counter[str] = Counter()
    found: dict[str, tuple[Case, Ending]] = {}
    every = max(count // commands, 1) if commands else 0
    begin = time.perf_counter()
    for k in range(count):
        case = mutator.case()
        ending = worker.examine(case)
        if every and k % every == 0 and not ending.failed:
            ending = on_command_line(case, ending)
        counts[ending.kind] += 1
        if ending.failed and ending.kind not in found:
            found[ending.kind] = case, ending
            print(f"  case {k} of {case.origin}: {ending.kind}", flush=True)
    for number, (case, ending) in enumerate(found.values()):
        keep(folder / f"scene-{seed}-{number}", reduced(case, ending, worker), ending)
    worker.close()
    print(f"{count} mutated scenes (seed {seed}) in {time.perf_counter() - begin:.0f} s:")
    for kind, times in counts.most_common():
        print(f"  {times:6d} {kind}")
    return len(found)


def on_command_line(case: Case, expected: Ending) -> Ending:
    """The case by ``python -m warpdem``: checked, and run for ten steps where it passes."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        corpus.write(folder)
        put(folder, case)
        checked = _command(["check", SCENE], folder)
        wanted = {"passed": 0, "refused": 2}[expected.kind]
        if not checked.failed and checked.kind != expected.kind:
            return Ending(f"check ends as {checked.kind}, not with exit status {wanted}")
        return checked


def _command(arguments: list[str], folder: Path) -> Ending:
    environment = os.environ | {"PYTHONPATH": str(corpus.ROOT)}
    command = [sys.executable, "-m", "warpdem", *arguments]
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            capture_output=True,
            timeout=RUN_LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Ending(f"{arguments[0]} does not end within {RUN_LIMIT:g} s")
    told = done.stderr.decode("utf-8", "replace")
    if "Traceback" in told:
        return Ending(f"traceback of {arguments[0]}", told)
    if done.returncode not in {0, 2, 3, 74}:
        return Ending(f"exit status {done.returncode} of {arguments[0]}", told)
    return Ending("refused" if done.returncode else "passed", told)


def reduced(case: Case, ending: Ending, worker: Worker) -> Case:
    """The smallest case that still fails alike: without lines, then without parts of lines."""

    def fails(smaller: Case) -> bool:
        return worker.examine(smaller).kind == ending.kind

    tries = TRIES if "no answer" not in ending.kind else 8
    case = Case(
        case.origin, _without(case.text, tries, lambda t: fails(_with(case, t))), case.files
    )
    for name, content in case.files.items():

        def alike(smaller: bytes, name: str = name) -> bool:
            return fails(Case(case.origin, case.text, {**case.files, name: smaller}))

        case.files[name] = _without(content, tries, alike)
    return case


def _with(case: Case, text: bytes) -> Case:
    return Case(case.origin, text, case.files)


def _without(text: bytes, tries: int, fails: Callable[[bytes], bool]) -> bytes:
    """The text with every table or line left out that is not needed to fail."""
    for cut in (rb"(?m)^(?=\[)", rb"(?<=\n)"):
        parts = re.split(cut, text)
        size = max(len(parts) // 2, 1)
        while size and tries:
            k = 0
            while k < len(parts) and tries:
                tries -= 1
                smaller = parts[:k] + parts[k + size :]
                if fails(b"".join(smaller)):
                    parts = smaller
                else:
                    k += size
            size //= 2
        text = b"".join(parts)
    return text


def keep(folder: Path, case: Case, ending: Ending) -> None:
    """Write a case to look at it: the scene, its files, what was said."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.toml").write_bytes(case.text)
    for name, content in case.files.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    (folder / "failure.txt").write_text(f"{ending.kind}\nfrom {case.origin}\n\n{ending.told}\n")
    print(f"  {ending.kind}: {folder}")
