"""What mutations start from: the gallery, scenes in the tests' texts, scenes of our own with files.

``write(folder)`` makes the files that they refer to: data of the gallery, and a small valid one of
every kind that scenes may name.
"""

from __future__ import annotations

import ast
import shutil
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING

import meshio
import numpy as np
import pyvista

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).resolve().parents[2]
CORNERS = 0.5 * np.array([[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])
FACES = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], dtype=np.int32)
LARGEST = 20_000
"""Longer scenes would take most of the time [characters]."""


def scenes() -> dict[str, str]:
    """Scene texts by a name for each, in a fixed order."""
    own = sorted(Path(__file__).parent.glob("seeds/*.toml"))
    gallery = sorted((ROOT / "scenes").glob("*.toml"))
    found = {path.name: path.read_text(encoding="utf-8") for path in (*own, *gallery)}
    for path in sorted((ROOT / "tests").rglob("*.py")):
        found |= {f"{path.name}:{line}": text for line, text in _told(path)}
    return {name: text for name, text in found.items() if len(text) <= LARGEST}


def _told(path: Path) -> Iterator[tuple[int, str]]:
    """Whole scenes among the texts of a Python file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and "=" in node.value:
            try:
                keys = tomllib.loads(node.value).keys()
            except tomllib.TOMLDecodeError:
                continue
            if "run" in keys and keys & {"body", "fill", "terrain"}:
                yield node.lineno, node.value


def write(folder: Path) -> list[str]:
    """Write the files; names of the small ones, which are worth mutating."""
    shutil.copytree(ROOT / "scenes" / "data", folder / "data")
    files = folder / "files"
    files.mkdir()
    for suffix in ("stl", "obj", "ply"):
        meshio.write_points_cells(files / f"tetra.{suffix}", CORNERS, {"triangle": FACES})
    (files / "shapes.shp").write_text(_library())
    x, y = np.meshgrid(np.arange(12.0), np.arange(10.0))
    slope = (5.0 - 0.5 * x + 0.1 * np.sin(3.0 * y)).round(3)
    (files / "slope.asc").write_text(_raster(slope))
    classes = 1 + (x + y) % 2
    (files / "classes.asc").write_text(_raster(classes))
    random = np.random.default_rng(0)
    (files / "cloud.pts").write_text(_rows(random.normal(size=(12, 3)), " "))
    table = [[1.0, 1.0, 0.3, 8.0], [3.0, -2.0, 0.4, 9.0]]
    (files / "trees.csv").write_text("x,y,diameter,height\n" + _rows(table, ","))
    starts = "-5,0,12,built\n-4,1,13,library\n"
    (files / "starts.csv").write_text("east,north,up,which\n" + starts)
    path = [[0.0, 0.0, 0.0], [0.5, 0.1, 0.2], [1.0, 0.0, 0.4]]
    (files / "path.csv").write_text("t,x,rz\n" + _rows(path, ","))
    _flows(files)
    return sorted(f"files/{path.name}" for path in files.iterdir())


def _flows(folder: Path) -> None:
    wind = np.zeros((3, 4, 2, 3))
    wind[..., 0] = 2.0
    spacing = [10.0, 10.0, 20.0]
    np.savez(folder / "wind.npz", velocity=wind, origin=[-10.0, -15.0, -5.0], spacing=spacing)
    grid = pyvista.ImageData(dimensions=(3, 4, 2), spacing=spacing, origin=(-10.0, -15.0, -5.0))
    grid.point_data["velocity"] = wind.reshape(-1, 3)
    grid.save(folder / "wind.vti")


def _raster(values: np.ndarray) -> str:
    head = "ncols 12\nnrows 10\nxllcorner -10\nyllcorner -10\ncellsize 2.0\nNODATA_value -9999\n"
    return head + _rows(values, " ")


def _rows(values: object, between: str) -> str:
    return "".join(between.join(f"{v:g}" for v in row) + "\n" for row in np.asarray(values))


def _library() -> str:
    edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    faces = "".join(f"3 {' '.join(map(str, face))}\n" for face in FACES)
    return (
        f"<\nname tetra\nradius 0.05\nnv 4\n{_rows(CORNERS, ' ')}ne 6\n{_rows(edges, ' ')}"
        f"nf 4\n{faces}obb.extent 1 1 1\nposition 0 0 0\norientation 1 0 0 0\n>\n"
        "<\nname ball\nradius 0.5\nnv 1\n0 0 0\nne 0\nnf 0\nvolume 0.5\nI/m 0.1 0.1 0.1\n>\n"
    )
