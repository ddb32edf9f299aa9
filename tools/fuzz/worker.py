"""A process that reads and checks one mutated scene after another, and says how each ended.

The parent waits for a limited time and replaces a worker that does not answer: nothing that a scene
does can stop the fuzzing.
"""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import re
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import corpus

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

MEMORY = 6 << 30
"""A worker may use so much [bytes]; a scene that wants more has to be refused."""
SCENE = "scene.toml"


@dataclass(frozen=True)
class Case:
    """A scene and, where they differ from the corpus, its files.

    Attributes:
        origin: The scene that was mutated.
        text: The mutated one.
        files: Mutated files by their names.
    """

    origin: str
    text: bytes
    files: dict[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Ending:
    """How a case ended: "passed", "refused", or a failure.

    Attributes:
        kind: What it is called; failures of one kind and place have one cause.
        told: What was said.
    """

    kind: str
    told: str = ""

    @property
    def failed(self) -> bool:
        """Whether it neither passed nor was refused."""
        return self.kind not in {"passed", "refused"}


def examine(folder: Path) -> Ending:
    """Read and check the scene in a folder, as ``python -m warpdem check`` does."""
    from warpdem.checks.check import check  # noqa: PLC0415 - in the worker alone
    from warpdem.errors import WarpdemError  # noqa: PLC0415 - the same
    from warpdem.input.decode import load  # noqa: PLC0415 - the same

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            report = check(load(folder / SCENE))
            str(report)
        except WarpdemError as fault:
            sound = str(fault).strip() and fault.exit_code in {2, 3, 74}
            return Ending("refused" if sound else "an empty message", str(fault))
        except BaseException as fault:  # noqa: BLE001 - whatever comes is what is sought
            return Ending(f"{type(fault).__name__} {_place(fault)}", traceback.format_exc())
    return Ending("refused" if report.problems else "passed", "\n".join(map(str, report.problems)))


def _place(fault: BaseException) -> str:
    """Where in the program it came from."""
    frames = traceback.extract_tb(fault.__traceback__)
    own = [f for f in frames if "warpdem" in Path(f.filename).parts or "kernels" in f.filename]
    last = (own or frames)[-1]
    return f"{Path(last.filename).name}:{last.lineno} {last.name}"


def _deepest(stack: str) -> str:
    """The innermost line of the program in what faulthandler wrote."""
    found = re.search(r'/warpdem/(?:\w+/)*(\w+\.py)", line \d+ in (\w+)', stack)
    return f" in {found[1]} {found[2]}" if found else ""


def _serve(pipe: Connection, told: str) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    # libraries in C say on the standard error what is said again in a message
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())
    with tempfile.TemporaryDirectory() as place, Path(told).open("w", encoding="utf-8") as stack:
        folder = Path(place)
        os.environ["WARPDEM_CACHE_PATH"] = str(folder / "cache")
        faulthandler.register(signal.SIGUSR1, file=stack)
        corpus.write(folder)
        pipe.send("ready")
        while (case := pipe.recv()) is not None:
            put(folder, case)
            pipe.send(examine(folder))


def put(folder: Path, case: Case) -> None:
    """Write a case into a folder of the corpus, whose files come back first."""
    for kept in folder.rglob("*.kept"):
        kept.replace(kept.with_suffix(""))
    (folder / SCENE).write_bytes(case.text)
    for name, content in case.files.items():
        file = folder / name
        file.rename(file.with_name(file.name + ".kept"))
        file.write_bytes(content)


class Worker:
    """A process of `examine`, started anew where it hangs or dies.

    Args:
        limit: Longest time of a case, of the processor [s].
    """

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._process: Any = None
        self._pipe: Any = None
        self._stack = tempfile.NamedTemporaryFile()  # noqa: SIM115 - lives as long as the worker

    def examine(self, case: Case) -> Ending:
        """How a case ends."""
        if self._process is None:
            self._start()
        self._pipe.send(case)
        spent = self._seconds()
        try:
            while self._seconds() - spent < self._limit:
                if self._pipe.poll(0.5):
                    return self._pipe.recv()
        except EOFError:
            self._process.join()
            code = self._process.exitcode
            self.close()
            return Ending(f"killed, exit code {code}")
        os.kill(self._process.pid, signal.SIGUSR1)
        time.sleep(1.0)
        self.close()
        stack = Path(self._stack.name).read_text(encoding="utf-8")
        return Ending(f"no answer within {self._limit:g} s{_deepest(stack)}", stack)

    def _seconds(self) -> float:
        """Time that the process has been at work [s], however busy the machine."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        self._process = context.Process(target=_serve, args=(other, self._stack.name), daemon=True)
        self._process.start()
        other.close()
        self._pipe.recv()

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._pipe.close()
            self._process = None
