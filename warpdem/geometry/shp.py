"""Shape libraries of Rockable and exaDEM (``.shp``): text blocks ``< ... >``, one a shape."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

from warpdem.errors import GeometryError
from warpdem.geometry.text_file import text_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

# keywords without a meaning here, and how many values follow them: boxes of trees, the pose the
# solid had before it was turned to its principal axes, settings of the Monte Carlo integration
_SKIPPED = {
    "obb.extent": 3, "obb.e1": 3, "obb.e2": 3, "obb.e3": 3, "obb.center": 3, "OBBtreeLevel": 1,
    "position": 3, "orientation": 4, "isSurface": 0, "MCnstep": 1,
}  # fmt: skip


Number = TypeVar("Number")


@dataclass
class ShpItem:
    """One shape of a library, as written.

    Attributes:
        name: By which the library knows it.
        radius: Minkowski radius [m].
        vertices: [m].
        edges: Vertex numbers.
        faces: Vertex numbers, in either orientation.
        volume: [m^3], when the file declares it.
        inertia_over_mass: [m^2], when the file declares it.
        precomputed: The file says that volume and inertia are right.
    """

    name: str = ""
    radius: float = 0.0
    vertices: list[list[float]] = field(default_factory=list)
    edges: list[list[int]] = field(default_factory=list)
    faces: list[list[int]] = field(default_factory=list)
    volume: float | None = None
    inertia_over_mass: tuple[float, ...] | None = None
    precomputed: bool = False


class _Words:
    """The words of a file, each with its line for messages."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._words: Iterator[tuple[int, str]] = (
            (number, word)
            for number, line in enumerate(text.splitlines(), 1)
            if not line.lstrip().startswith(("#", "!", "/"))
            for word in line.split()
        )
        self._line = 1

    def next(self, wanted: str) -> str:
        """The next word; empty at the end of the file when nothing is wanted."""
        self._line, word = next(self._words, (self._line, ""))
        if not word and wanted:
            raise self.error(f"the file ends where {wanted} should stand")
        return word

    def real(self, wanted: str) -> float:
        word = self.next(wanted)
        try:
            return float(word)
        except ValueError:
            raise self.error(f"{wanted} should be a number, not {word!r}") from None

    def integer(self, wanted: str) -> int:
        word = self.next(wanted)
        try:
            number = int(word)
        except ValueError:
            number = -1
        if number < 0:
            raise self.error(f"{wanted} should be a whole number from 0, not {word!r}")
        return number

    def error(self, message: str) -> GeometryError:
        return GeometryError(f"{self._path}:{self._line}: {message}")


def read_shp(path: Path) -> dict[str, ShpItem]:
    """All shapes of a library by name.

    Raises:
        GeometryError: The file cannot be read or understood; names it and the line.
    """
    words = _Words(path, text_of(path))
    items: dict[str, ShpItem] = {}
    while word := words.next(""):
        if word != "<":
            raise words.error(f"a shape begins with '<', not {word!r}")
        item = _item(words)
        if item.name in items:
            raise words.error(f"a second shape named {item.name!r}")
        items[item.name] = item
    return items


def _item(words: _Words) -> ShpItem:
    item = ShpItem()
    while (key := words.next("'>'")) != ">":
        if key in _SKIPPED:
            for _ in range(_SKIPPED[key]):
                words.next(f"a value of {key}")
        elif not _read_entry(item, key, words):
            raise words.error(f"unknown keyword {key!r}")
    if not item.name or not item.vertices:
        raise words.error("the shape that ends here lacks its name or its vertices (nv)")
    return item


def _read_entry(item: ShpItem, key: str, words: _Words) -> bool:
    match key:
        case "name":
            item.name = words.next("a name")
        case "radius":
            item.radius = words.real("the radius")
        case "preCompDone":
            item.precomputed = words.next("y or n").lower().startswith("y")
        case "volume":
            item.volume = words.real("the volume")
        case "I/m":
            item.inertia_over_mass = tuple(words.real("a moment of inertia") for _ in range(3))
        case "nv":
            item.vertices = [_row(words.real, 3) for _ in range(words.integer("nv"))]
        case "ne":
            item.edges = [_row(words.integer, 2) for _ in range(words.integer("ne"))]
        case "nf":
            item.faces = [_face(words) for _ in range(words.integer("nf"))]
        case _:
            return False
    return True


def _row(read: Callable[[str], Number], length: int) -> list[Number]:
    return [read("a vertex") for _ in range(length)]


def _face(words: _Words) -> list[int]:
    return _row(words.integer, words.integer("the number of corners of a face"))
