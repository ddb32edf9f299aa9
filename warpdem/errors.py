"""What can go wrong, told so that a person can put it right."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

LISTED = 40
"""How many problems a message lists; all are in ``SceneError.problems``."""


class WarpdemError(Exception):
    """Every fault warpdem reports by a message rather than a traceback."""

    exit_code = 2


@dataclass(frozen=True)
class Problem:
    """One fault of a scene.

    Attributes:
        place: Where it stands, ``file:line`` or the file alone.
        key: The key path with its value, such as ``contact[0].en2 = 1.5``; may be empty.
        message: The rule that is broken, and the way out.
    """

    place: str
    key: str
    message: str

    def __str__(self) -> str:
        return (
            f"{self.place}  {self.key}: {self.message}"
            if self.key
            else (f"{self.place}: {self.message}")
        )


class SceneError(WarpdemError):
    """A scene cannot be simulated as written; carries every problem found.

    Attributes:
        file: The scene file, or what stands for it.
        problems: All of its problems, in the order of the file.
    """

    def __init__(self, file: str, problems: Sequence[Problem]) -> None:
        self.file = file
        self.problems = list(problems)
        count = len(self.problems)
        head = f"{file}: {count} problem{'' if count == 1 else 's'}"
        more = [f"... and {count - LISTED} more"] if count > LISTED else []
        super().__init__("\n  ".join([head, *map(str, self.problems[:LISTED]), *more]))


class GeometryError(WarpdemError):
    """A shape is no solid that can be simulated; the message names it, the cause and a remedy."""


class UnstableError(WarpdemError):
    """The motion ceased to be finite or physical.

    Attributes:
        body: Name of the first body concerned.
        time: Simulated time at which it was noticed [s].
    """

    exit_code = 3

    def __init__(self, message: str, *, body: str = "", time: float = 0.0) -> None:
        self.body = body
        self.time = time
        super().__init__(message)


class CapacityError(WarpdemError):
    """The scene needs more memory or larger indices than there are."""


class OutputError(WarpdemError):
    """Results could not be written."""

    exit_code = 74
