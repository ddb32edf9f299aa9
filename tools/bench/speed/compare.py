"""Cases beside their peers: the runs of one case and the rows they give."""

from __future__ import annotations

import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from speed.peers import Peer, Run, Timing
from speed.peers.ours import OURS
from speed.report import Cell, Table
from speed.timing import alternating, cpu_speed, middle, paired_cpu_ratio, paired_ratio

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from speed.cases import Case, Recorded
    from speed.packings import Folder

COLUMNS = (
    "case",
    "threads",
    "program",
    "contacts",
    "body-steps/s",
    "per CPU s",
    "warpdem's ratio",
    "of CPU time",
    "target",
    "",
)
CLOCKS = (
    "ratio: warpdem's speed over the program's, median over the rounds; on one thread a target is "
    "held against the ratio of CPU time, where it is known: others may use the machine"
)


def compare(cases: Iterable[Case], folder: Folder, *, repeats: int, scale: float = 1.0) -> Table:
    """The table of all cases; ``scale`` multiplies their steps."""
    rows: list[tuple[Cell, ...]] = []
    notes: dict[str, None] = {CLOCKS: None}
    for case in cases:
        present, skipped = able(case.peers)
        notes |= dict.fromkeys(skipped)
        for threads in case.threads:
            found = measured(case, present, folder, threads, repeats, scale)
            rows += rows_of(case, threads, found)
        notes[f"{case.name}: {case.what}, dt {case.make().dt:g} s. {case.differs}"] = None
    title = f"Speed beside peers, medians of {repeats} alternating runs"
    return Table(title, COLUMNS, tuple(rows), tuple(notes), ("case", "body-steps/s", "program"))


def able(peers: Sequence[Peer]) -> tuple[list[Peer], list[str]]:
    """Those that can run here, and a sentence for each that cannot."""
    why = {peer: peer.missing() for peer in peers}
    skipped = [
        f"{peer.name}: skipped, {word}; {peer.install}" for peer, word in why.items() if word
    ]
    return [peer for peer, word in why.items() if not word], skipped


def measured(
    case: Case, peers: Sequence[Peer], folder: Folder, threads: int, repeats: int, scale: float
) -> dict[str, tuple[Timing, ...]]:
    """Timings by program, warpdem first."""
    start = folder.settled(case.make(), case.settle)
    steps = max(10, round(scale * case.steps))
    with tempfile.TemporaryDirectory() as place:
        asked = Run(start, Path(place), threads, case.warm, steps)
        runs = {peer.name: partial(_said, peer, asked) for peer in (OURS, *peers)}
        return alternating(runs, repeats)


def _said(peer: Peer, asked: Run) -> Timing:
    timing = peer.timed(asked)
    print(
        f"{asked.problem.name} {peer.name} x{asked.threads}: {timing.speed:.3g} body-steps/s, "
        f"{timing.facts}",
        file=sys.stderr,
        flush=True,
    )
    return timing


def rows_of(
    case: Case, threads: int, found: dict[str, tuple[Timing, ...]]
) -> list[tuple[Cell, ...]]:
    """Rows of a case on so many threads: warpdem, peers that ran, peers that are quoted."""
    ours = found[OURS.name]
    rows = [_row(case, threads, name, each, ours) for name, each in found.items()]
    quoted = (o for o in case.recorded if o.threads == threads and o.peer not in found)
    return rows + [_quoted(case, other, ours) for other in quoted]


def _quoted(case: Case, other: Recorded, ours: Sequence[Timing]) -> tuple[Cell, ...]:
    wall, cpu = middle(ours).speed / other.speed, cpu_speed(ours)
    cpu = cpu / other.speed if cpu and other.threads == 1 else None
    target = case.targets.get((other.peer, other.threads))
    name = f"{other.peer} (recorded)"
    row = (case.name, other.threads, name, other.how, other.speed, None, wall, cpu, target)
    return (*row, verdict(cpu or wall, target))


def _row(
    case: Case, threads: int, name: str, each: Sequence[Timing], ours: Sequence[Timing]
) -> tuple[Cell, ...]:
    one = middle(each)
    own = name == OURS.name
    wall = None if own else paired_ratio(ours, each)
    cpu = None if own or threads > 1 else paired_cpu_ratio(ours, each)
    target = case.targets.get((name, threads))
    row = (case.name, threads, name, _touching(one), one.speed, cpu_speed(each), wall, cpu, target)
    return (*row, verdict(cpu or wall, target))


def _touching(one: Timing) -> Cell:
    if "contacts" in one.facts:
        return one.facts["contacts"]
    pairs = one.facts.get("pair_contacts")
    return None if pairs is None else f"{pairs} but walls'"


def verdict(ratio: float | None, target: float | None) -> str | None:
    """Whether a target is met; None without one."""
    if ratio is None or target is None:
        return None
    return "met" if ratio >= target else "missed"
