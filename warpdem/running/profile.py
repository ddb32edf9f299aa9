"""Where the time of a run goes: nested times, counts, and what the scene does without."""

from __future__ import annotations

import functools
import threading
import time
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from contextlib import AbstractContextManager

    from warpdem.features import Features

BESIDE = "writing (beside)"
"""What other threads than the first one do while it goes on."""

SHOWN = 5e-4
"""Seconds below which a table leaves a thing out."""

OPTIONAL = {
    "contacts": "contacts",
    "damped": "dashpots",
    "friction": "friction",
    "rolling": "rolling",
    "cohesion": "cohesion",
    "shares": "shared stiffness",
    "hot_lists": "hot lists",
    "trees": "feature trees",
    "surfaces": "analytic walls",
    "large": "large bodies",
    "bonds": "bonds",
    "driven": "drivers",
    "controlled": "walls under a force",
    "periodic": "periodic cell",
    "turns": "orientations",
    "account": "energy account",
    "drag": "drag",
    "fluid": "fluid",
    "numerical_damping": "numerical damping",
    "velocity_barrier": "velocity barrier",
    "spin_barrier": "spin barrier",
    "custom": "own laws",
}
"""Features that a scene may do without, in words."""


@dataclass
class Span:
    """Time spent on one thing.

    Attributes:
        seconds: All of it, that of what it consists of too.
        calls: How often.
    """

    seconds: float = 0.0
    calls: int = 0


class Profile:
    """Times of a run from its beginning on.

    Attributes:
        spans: By path, such as ("steps", "rebuild", "candidates").
        settle: Waits for what the device still does; called before the clock is read.
    """

    def __init__(self) -> None:
        self.spans: dict[tuple[str, ...], Span] = {}
        self.settle: Callable[[], object] = lambda: None
        self._began = time.perf_counter()
        self._first = threading.get_ident()
        self._local = threading.local()
        self._samples: list[dict[str, int]] = []
        self._lap: tuple[str, AbstractContextManager[None]] = ("", nullcontext())

    @contextmanager
    def span(self, name: str) -> Iterator[None]:
        """Time what is done within, as a part of what is being timed."""
        path = (*self._path, name)
        self.spans.setdefault(path, Span())
        outer, self._local.path = self._path, path
        begin = time.perf_counter()
        try:
            yield
        finally:
            self.settle()
            self._count(path, time.perf_counter() - begin)
            self._local.path = outer

    def add(self, name: str, seconds: float, calls: int) -> None:
        """Add time [s] that was measured elsewhere to a part of what is being timed."""
        self._count((*self._path, name), seconds, calls)

    def watch(self, thing: Any, **names: str) -> None:
        """Time methods of one object from now on; what they do is called as ``names`` say."""
        for method, name in names.items():
            setattr(thing, method, self._timed(getattr(thing, method), name))

    def lap(self, text: str) -> None:
        """Time until the next lap, under the words of ``text`` before any number; "" ends it."""
        name = text.partition(" ")[0] if "/" in text else text
        if name != self._lap[0]:
            self._lap[1].__exit__(None, None, None)
            self._lap = (name, self.span(name) if name else nullcontext())
            self._lap[1].__enter__()

    def sample(self, counts: dict[str, int]) -> None:
        """Take note of how many pairs, candidates and so on there are now."""
        self._samples.append(counts)

    def facts(self, features: Features, body_steps: int) -> dict[str, Any]:
        """All of it, as numbers; ``body_steps`` is the number of bodies times that of steps."""
        whole = time.perf_counter() - self._began
        stages = [
            {
                "stage": "/".join(path),
                "seconds": span.seconds,
                "share": span.seconds / whole,
                "calls": span.calls,
                "ns_a_body_step": 1e9 * span.seconds / max(body_steps, 1),
            }
            for path, span in self._in_order(whole)
        ]
        return {
            "seconds": whole,
            "stages": stages,
            "counts": self._mean_counts(),
            "without": without(features),
        }

    @property
    def _path(self) -> tuple[str, ...]:
        other = () if threading.get_ident() == self._first else (BESIDE,)
        return getattr(self._local, "path", other)

    def _count(self, path: tuple[str, ...], seconds: float, calls: int = 1) -> None:
        span = self.spans.setdefault(path, Span())
        span.seconds += seconds
        span.calls += calls

    def _timed(self, method: Callable[..., Any], name: str) -> Callable[..., Any]:
        @functools.wraps(method)
        def timed(*given: Any, **named: Any) -> Any:
            with self.span(name):
                return method(*given, **named)

        return timed

    def _in_order(self, whole: float) -> Iterator[tuple[tuple[str, ...], Span]]:
        """Each thing before its parts, and what of it the parts leave."""
        yield from self._parts((), whole)
        beside = sum(s.seconds for path, s in self.spans.items() if path[:-1] == (BESIDE,))
        if beside:
            yield (BESIDE,), Span(beside, 0)
            yield from self._parts((BESIDE,), beside)

    def _parts(self, of: tuple[str, ...], whole: float) -> Iterator[tuple[tuple[str, ...], Span]]:
        parts = {p: s for p, s in self.spans.items() if p[:-1] == of and p != (BESIDE,)}
        for path, span in parts.items():
            yield path, span
            yield from self._parts(path, span.seconds)
        rest = whole - sum(span.seconds for span in parts.values())
        if parts:
            yield (*of, "other"), Span(rest, 0)

    def _mean_counts(self) -> dict[str, float]:
        count = max(len(self._samples), 1)
        names = self._samples[-1] if self._samples else {}
        return {name: sum(s[name] for s in self._samples) / count for name in names}


def without(features: Features) -> list[str]:
    """What a scene does not use: it is neither compiled nor allocated."""
    return [words for name, words in OPTIONAL.items() if not getattr(features, name)]


def span_of(profile: Profile | None, name: str) -> AbstractContextManager[None]:
    """A span of a profile, or nothing where there is none."""
    return profile.span(name) if profile else nullcontext()


def profile_text(facts: Mapping[str, Any]) -> str:
    """The facts of a profile as a table."""
    head = f"{'':32}{'seconds':>10}{'share':>8}{'calls':>10}{'ns a body-step':>16}"
    lines = [f"profile of {facts['seconds']:.3g} s", head]
    for row in facts["stages"]:
        if row["seconds"] < SHOWN:
            continue
        *above, name = row["stage"].split("/")
        each = "" if (above or [name])[0] == "start-up" else f"{row['ns_a_body_step']:.3g}"
        lines.append(
            f"{'  ' * len(above) + name:32}{row['seconds']:10.3f}{row['share']:8.1%}"
            f"{row['calls'] or '':10}{each:>16}".rstrip()
        )
    counts = ", ".join(f"{value:.6g} {name}" for name, value in facts["counts"].items())
    lines += [f"a step: {counts}"] if counts else []
    return "\n".join([*lines, f"without: {', '.join(facts['without'])}"])
