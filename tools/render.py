"""Draw a frame of a run: ``python tools/render.py RUN_DIR [--frame N] -o PICTURE.png``.

Moving bodies are coloured by a field of the frame, fixed ones are grey; ``--walls 0.2`` lets one
look through them. Without ``--frame`` the last frame is drawn.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np
import pyvista as pv

WALLS = "#cfc8bc"
BODIES = "#c8a36a"
SKY = ("white", "#cfdbe8")  # below, above


def main() -> int:
    options = _arguments()
    index = options.run / "bodies.pvd"
    if not index.is_file():
        print(f"{index}: no such file; does the scene have output.surface?", file=sys.stderr)
        return 2
    reader = pv.PVDReader(index)
    count = len(reader.time_values)
    number = options.frame + count * (options.frame < 0)
    if not 0 <= number < count:
        print(f"{index}: holds frames 0 to {count - 1}", file=sys.stderr)
        return 2
    reader.set_active_time_point(number)
    return _draw(reader.read()[0], _cell(options.run, number), options)


def _cell(run: Path, number: int) -> pv.DataSet | None:
    """The periodic cell at a frame, if there is one."""
    if not (run / "cell.pvd").is_file():
        return None
    reader = pv.PVDReader(run / "cell.pvd")
    reader.set_active_time_point(number)
    return reader.read()[0]


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("run", type=Path, metavar="RUN_DIR")
    add("--frame", type=int, default=-1, metavar="N", help="negative: counted from the end")
    add("--color", default="speed", metavar="FIELD", help="of the moving bodies, or none")
    add("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of the colours")
    add("--walls", type=float, default=1.0, metavar="OPACITY", help="of the fixed bodies")
    add("--fit", choices=("all", "moving", "fixed"), default="all", help="what fills the picture")
    add("--view", type=float, nargs=3, default=(0.7, -1.0, 0.5), help="direction to the camera")
    add("--zoom", type=float, default=1.0)
    add("--size", type=int, nargs=2, default=(1280, 800), metavar=("WIDTH", "HEIGHT"))
    add("-o", "--output", type=Path, required=True, metavar="PICTURE.png")
    return parser.parse_args()


def _draw(grid: pv.UnstructuredGrid, cell: pv.DataSet | None, options: argparse.Namespace) -> int:
    if options.color not in {"none", *grid.cell_data.keys()}:
        known = ", ".join(grid.cell_data.keys())
        print(f"no field {options.color}; there are {known}", file=sys.stderr)
        return 2
    is_fixed = _fixed_cells(grid)
    parts = {
        "all": grid,
        "moving": grid.extract_cells(~is_fixed),
        "fixed": grid.extract_cells(is_fixed),
    }
    plotter = pv.Plotter(off_screen=True, window_size=options.size, lighting="none")
    _add_fixed(plotter, parts["fixed"], options)
    _add_moving(plotter, parts["moving"], options)
    if cell is not None:
        plotter.add_mesh(cell, style="wireframe", color="#4a4a4a", line_width=2, lighting=False)
    seen = parts[options.fit] if parts[options.fit].n_cells else grid
    _light(plotter)
    plotter.set_background(SKY[0], top=SKY[1])
    size = _body_size(parts["moving"])
    if size > 0.01 * seen.length:  # of smaller ones the shadows would be noise
        plotter.enable_ssao(radius=min(0.5 * size, 0.02 * seen.length), kernel_size=128)
    plotter.enable_anti_aliasing("ssaa")
    plotter.view_vector(options.view, viewup=(0.0, 0.0, 1.0), bounds=seen.bounds)
    plotter.camera.zoom(options.zoom)
    plotter.screenshot(options.output)
    return 0


def _fixed_cells(grid: pv.UnstructuredGrid) -> np.ndarray:
    """Which polygons belong to bodies that no force moves: those shown without mass."""
    mass = grid.cell_data.get("mass")
    return np.zeros(grid.n_cells, bool) if mass is None else np.asarray(mass) == 0.0


def _shaded(part: pv.UnstructuredGrid) -> pv.PolyData:
    """The polygons with a normal at each point, weighted by area so that flat faces look flat."""
    surface = part.extract_surface(algorithm=None).triangulate()
    corners = surface.faces.reshape(-1, 4)[:, 1:]
    a, b, c = (np.asarray(surface.points, float)[corners[:, k]] for k in range(3))
    area = np.cross(b - a, c - a)
    normals = np.zeros((surface.n_points, 3))
    for k in range(3):
        np.add.at(normals, corners[:, k], area)
    surface.point_data["Normals"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    surface.point_data.active_normals_name = "Normals"
    return surface


def _add_fixed(plotter: pv.Plotter, part: pv.UnstructuredGrid, options: argparse.Namespace) -> None:
    if part.n_cells:
        plotter.add_mesh(
            _shaded(part), color=WALLS, opacity=options.walls, ambient=0.15, specular=0.05
        )


def _add_moving(
    plotter: pv.Plotter, part: pv.UnstructuredGrid, options: argparse.Namespace
) -> None:
    if not part.n_cells:
        return
    look = {"ambient": 0.15, "specular": 0.2, "specular_power": 15.0}
    if options.color == "none":
        plotter.add_mesh(_shaded(part), color=BODIES, **look)
        return
    bar = {"title": options.color, "color": "black", "vertical": True, "height": 0.4}
    plotter.add_mesh(
        _shaded(part),
        scalars=options.color,
        clim=options.range,
        cmap="coolwarm",
        scalar_bar_args=bar | {"position_x": 0.91, "position_y": 0.05},
        **look,
    )


def _body_size(moving: pv.UnstructuredGrid) -> float:
    """Length of one moving body, 0 where there is none [m]."""
    if moving.n_cells == 0 or "body" not in moving.cell_data:
        return 0.0
    body = np.asarray(moving.cell_data["body"])
    return moving.extract_cells(body == body[0]).length


def _light(plotter: pv.Plotter) -> None:
    """A low sun from the left, which shows relief, and a weak light from the camera's right."""
    sun = pv.Light(light_type="camera light", position=(-1.4, 1.3, 0.4), intensity=0.95)
    fill = pv.Light(light_type="camera light", position=(0.6, 0.2, 1.0), intensity=0.45)
    for light in (sun, fill):
        plotter.add_light(light)


if __name__ == "__main__":
    sys.exit(main())
