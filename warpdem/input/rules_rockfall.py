"""Rules of rockfall: classes that exist, areas that are areas, what stands on them."""

from __future__ import annotations

from itertools import pairwise
from math import fsum, isfinite, nan
from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import (
    Fault,
    Path,
    entries,
    number,
    read,
    tables,
    text,
)
from warpdem.input.suggestions import did_you_mean
from warpdem.rockfall.classes import NEEDED, PUBLISHED

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

RASTERS = (".asc", ".tif", ".tiff")
MESHES = (".stl", ".obj", ".ply")


def _suffix(file: str | None) -> str:
    return "." + file.lower().rpartition(".")[2] if file else ""


def _class_names(scene: Any) -> list[str]:
    own = [text(section, "name") for _, section in tables(scene, "terrain_class")]
    return [*PUBLISHED, *(name for name in own if name and name not in PUBLISHED)]


def known_classes(scene: Any) -> Iterator[Fault]:
    """Every class that is named exists."""
    names = _class_names(scene)
    wanted: list[tuple[Path, Any]] = [(("terrain", "class"), read(read(scene, "terrain"), "class"))]
    for index, area in tables(scene, "ground"):
        wanted.append((("ground", index, "class"), read(area, "class")))
        listed = read(area, "classes")
        for key, name in listed.items() if isinstance(listed, dict) else ():
            wanted.append((("ground", index, "classes", key), name))
    for path, name in wanted:
        if isinstance(name, str) and name and name not in names:
            yield Fault(path, name, _unknown("class", name, names))


def _unknown(kind: str, name: str, names: Sequence[str]) -> str:
    hint = did_you_mean(name, names) or f"; there are: {', '.join(names[:12]) or 'none'}"
    return f"no {kind} has this name{hint}"


def own_classes(scene: Any) -> Iterator[Fault]:
    """A class is like one that exists already, or complete; friction grows with slip."""
    known = {name: (one.mu_min, one.mu_max) for name, one in PUBLISHED.items()}
    for index, section in tables(scene, "terrain_class"):
        path = ("terrain_class", index)
        like, name = text(section, "like"), text(section, "name") or ""
        if like and like not in known:
            yield Fault(
                (*path, "like"), like, _unknown("published or earlier class", like, [*known])
            )
        start = known.get(like or name)
        for key in NEEDED if not start and not like else ():
            if read(section, key) is None:
                rule = f'missing: "{name}" is no published class; give it, or like = "medium"'
                yield Fault((*path, key), None, rule)
        low, high = (
            number(section, key) if read(section, key) is not None else (start or (None, None))[k]
            for k, key in enumerate(("mu_min", "mu_max"))
        )
        if low is not None and high is not None and low > high:
            rule = f"must be at least mu_min = {low:g}: slip raises friction"
            yield Fault((*path, "mu_max"), high, rule)
        known[name] = (low or 0.0, high or 0.0)


def _alternatives(table: Any, path: Path, keys: tuple[str, str], what: str) -> Iterator[Fault]:
    """One of two keys is given."""
    first, second = keys
    if read(table, first) is None and read(table, second) is None:
        yield Fault((*path, first), None, f"missing: {what} ({first}, or {second})")
    if read(table, first) is not None and read(table, second) is not None:
        yield Fault((*path, second), read(table, second), f"leave this or {first} out")


def areas(scene: Any) -> Iterator[Fault]:
    """An area is a polygon with a surface, or stands in a file that can be one."""
    for kind in ("ground", "forest"):
        for index, area in tables(scene, kind):
            path = (kind, index)
            yield from _alternatives(area, path, ("polygon", "file"), "where it is")
            if flat := _flat(entries(area, "polygon")):
                yield Fault((*path, "polygon"), None, flat)
            file = text(area, "file")
            if file and _suffix(file) not in {".shp", *RASTERS}:
                yield Fault((*path, "file"), file, "must be a .shp, .asc or .tif file")


def _flat(polygon: Sequence[Any]) -> str:
    """Why a polygon of numbers encloses nothing; empty when it does."""
    try:
        corners = [(float(x), float(y)) for x, y in polygon]
    except (TypeError, ValueError):
        return ""
    if len(corners) < 3:
        return ""
    (x0, y0), turned = corners[0], [*corners[1:], corners[0]]
    parts = [
        (ax - x0) * (by - y0) - (bx - x0) * (ay - y0)
        for (ax, ay), (bx, by) in zip(corners, turned, strict=True)
    ]
    # too far apart, or no numbers: told elsewhere
    area = fsum(parts) if all(map(isfinite, parts)) else nan
    return "" if area else "encloses no area: the corners lie on a line"


def ground_files(scene: Any) -> Iterator[Fault]:
    """An area of ground says its class once: itself, by an attribute, or by numbers."""
    for index, area in tables(scene, "ground"):
        path, suffix = ("ground", index), _suffix(text(area, "file"))
        field, listed, one = (read(area, key) for key in ("field", "classes", "class"))
        if field is not None and suffix != ".shp":
            yield Fault((*path, "field"), field, "only the polygons of a .shp file have attributes")
        if listed is not None and suffix not in RASTERS:
            yield Fault(
                (*path, "classes"), None, "only with a raster of class numbers (.asc, .tif)"
            )
        if suffix in RASTERS and listed is None:
            yield Fault((*path, "classes"), None, "missing: the class of each number of the raster")
        if one is not None and (field is not None or suffix in RASTERS):
            rule = "the file says the class: leave this or field, classes out"
            yield Fault((*path, "class"), one, rule)
        if one is None and field is None and suffix not in RASTERS:
            yield Fault((*path, "class"), None, "missing: name of the class that holds here")
        for key in listed if isinstance(listed, dict) else ():
            if not _is_number(key):
                yield Fault((*path, "classes", key), None, "must be a number of the raster")


def _is_number(word: str) -> bool:
    try:
        return float(word) == int(float(word))
    except (ValueError, OverflowError):
        return False


def terrain_file(scene: Any) -> Iterator[Fault]:
    """A terrain is a raster or a mesh."""
    terrain = read(scene, "terrain")
    file = text(terrain, "file")
    if file and _suffix(file) not in {*RASTERS, *MESHES}:
        yield Fault(("terrain", "file"), file, f"must be one of {', '.join([*RASTERS, *MESHES])}")
    if _suffix(file) in MESHES and read(terrain, "nodes") == "corner":
        yield Fault(("terrain", "nodes"), "corner", "only a raster has cells")


def standing(scene: Any) -> Iterator[Fault]:
    """Forests have a density, trees a place and a size, screens that catch a height."""
    for index, forest in tables(scene, "forest"):
        yield from _alternatives(forest, ("forest", index), ("density", "drag"), "what it does")
    for index, tree in tables(scene, "tree"):
        path = ("tree", index)
        yield from _alternatives(tree, path, ("position", "file"), "where it stands")
        for key in ("diameter", "height"):
            alone = read(tree, "position") is not None
            if alone and read(tree, key) is None:
                yield Fault((*path, key), None, "missing [m]")
            if not alone and read(tree, "file") is not None and read(tree, key) is not None:
                yield Fault(
                    (*path, key), read(tree, key), "the table has this column: leave it out"
                )
    for index, barrier in tables(scene, "barrier"):
        if read(barrier, "capacity") is not None and read(barrier, "height") is None:
            yield Fault(
                ("barrier", index, "height"), None, "missing: what stops rocks has a height"
            )


def barrier_lines(scene: Any) -> Iterator[Fault]:
    """Every piece of a barrier's line has a length."""
    for index, barrier in tables(scene, "barrier"):
        for k, (before, point) in enumerate(pairwise(entries(barrier, "line")), start=1):
            if isinstance(point, list | tuple) and point == before:
                rule = "the same point as the one before: leave it out"
                yield Fault(("barrier", index, "line", k), [*point], rule)


ROCKFALL_RULES = (
    known_classes,
    own_classes,
    areas,
    ground_files,
    terrain_file,
    standing,
    barrier_lines,
)
