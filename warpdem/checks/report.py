"""What a scene would build, as numbers and as text."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from warpdem.checks.memory import Memory
    from warpdem.checks.timestep import TimeStep
    from warpdem.errors import Problem


@dataclass(frozen=True)
class ShapeLine:
    """One shape and the bodies that have it.

    Attributes:
        name: Of the shape.
        kind: Of the shape, as the scene says it.
        free: Number of bodies that forces move.
        fixed: Number of others.
        vertices: Of the core.
        edges: Of the core.
        faces: Of the core.
        volume: At scale 1 [m^3].
    """

    name: str
    kind: str
    free: int
    fixed: int
    vertices: int
    edges: int
    faces: int
    volume: float


@dataclass(frozen=True)
class Report:
    """What a scene would build.

    Attributes:
        file: The scene file, or what stands for it.
        title: Of the scene.
        shapes: The shapes in their order.
        groups: Name, free and fixed bodies of each group that has any.
        mass: Of all free bodies together [kg].
        step: The time step; None when the given one is refused.
        duration: Simulated time [s].
        frames: Number of frames written, the first included.
        memory: Of the run's arrays.
        stages: Of one step, in order.
        notes: Repairs and counts, in words.
        warnings: What is allowed but probably not meant.
        problems: What the run would refuse.
    """

    file: str
    title: str
    shapes: tuple[ShapeLine, ...]
    groups: tuple[tuple[str, int, int], ...]
    mass: float
    step: TimeStep | None
    duration: float
    frames: int
    memory: Memory
    stages: tuple[str, ...]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    problems: tuple[Problem, ...]

    @property
    def free_count(self) -> int:
        """Number of bodies that forces move."""
        return sum(shape.free for shape in self.shapes)

    @property
    def fixed_count(self) -> int:
        """Number of bodies that forces do not move."""
        return sum(shape.fixed for shape in self.shapes)

    def __str__(self) -> str:
        return "\n".join(self._lines())

    def _lines(self) -> Iterator[str]:
        yield f"{self.file}: {self.title}" if self.title else self.file
        mass = f", {self.mass:.4g} kg" if self.free_count else ""
        yield f"bodies  {self.free_count} free, {self.fixed_count} fixed{mass}"
        yield from columns(
            ("shape", "kind", "free", "fixed", "vertices", "edges", "faces", "volume [m^3]"),
            [
                (s.name, s.kind, s.free, s.fixed, s.vertices, s.edges, s.faces, f"{s.volume:.6g}")
                for s in self.shapes
            ],
        )
        yield from columns(("group", "free", "fixed"), self.groups)
        yield f"stages  {' . '.join(self.stages)}"
        if self.step:
            yield from _step_lines(self.step, self.duration)
        yield f"output  {self.frames} frames"
        yield from _memory_lines(self.memory)
        for word in ("notes", "warnings", "problems"):
            yield from listed(word, getattr(self, word))


def _step_lines(step: TimeStep, duration: float) -> Iterator[str]:
    chosen = "chosen" if step.chosen else "given"
    count = max(1, round(duration / step.dt))
    yield f"step    {step.dt:.6g} s ({chosen}), {count} steps in {duration:g} s"
    if isfinite(step.bound):
        yield f"        stability bound {step.bound:.4g} s if pressed from all sides"
    if isfinite(step.contact_time):
        yield (
            f"        shortest contact {step.contact_time:.4g} s, "
            f"{step.contact_time / step.dt:.3g} steps"
        )


def _memory_lines(memory: Memory) -> Iterator[str]:
    yield f"memory  about {size_text(memory.total)}: {memory}"
    if pairs := memory.counts["pair"]:
        yield (
            f"        {pairs} pairs and {memory.counts['candidate']} candidates expected, as of "
            f"a heap that settles, with head room"
        )
        yield f"        {size_text(memory.renewing)} more while lists are renewed"


def columns(head: Sequence[str], rows: Sequence[Sequence[object]]) -> Iterator[str]:
    """A table, texts to the left and numbers to the right; nothing without rows."""
    if not rows:
        return
    cells = [head, *([str(cell) for cell in row] for row in rows)]
    width = [max(len(row[k]) for row in cells) for k in range(len(head))]
    text = [isinstance(cell, str) and k < 2 for k, cell in enumerate(rows[0])]
    for row in cells:
        aligned = [
            cell.ljust(w) if left else cell.rjust(w)
            for cell, w, left in zip(row, width, text, strict=True)
        ]
        yield "  " + "  ".join(aligned).rstrip()


def size_text(count: int) -> str:
    """A number of bytes in MB or GB."""
    size, unit = count / 1e6, "MB"
    return f"{size:.3g} {unit}" if size < 1e3 else f"{size / 1e3:.3g} GB"


def listed(word: str, entries: Sequence[object]) -> Iterator[str]:
    """Entries below a word; nothing without entries."""
    if entries:
        yield f"{word}:"
        yield from (f"  {entry}" for entry in entries)
