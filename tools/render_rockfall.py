"""Draw rockfall in space: ``python tools/render_rockfall.py RUN_DIR -o PICTURE.png``.

Terrain, paths coloured by speed and rocks where they ended come from the run; barriers, trunks and
forest from its scene, which must lie where it lay during the run. Trees of a forest are a sign for
it: the model knows none of them.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pyvista as pv

import warpdem
from warpdem.rockfall.prepare import site_of

if TYPE_CHECKING:
    from warpdem.rockfall.site import Barrier, Site

SOFT, MIDDLE, HARD = "#a9b878", "#d2c19c", "#98938f"
"""Of grounds whose least friction is 0.2, 0.5, 0.8."""
FOREST, TRUNK = "#5f7f54", "#7a5a3c"
NET, LINE, ROCK = "#0b5fd0", "#202124", "#8c1d40"
SKY = ("white", "#cfdbe8")  # below, above
TREES_APART = 9.0
"""Of a forest's sign [m]."""
LINE_HEIGHT = 0.6
"""At which a line that only records is drawn [m]."""


def main() -> int:
    options = _arguments()
    summary = options.run / "summary.json"
    if not (options.run / "trajectories.vtu").is_file():
        print(f"{options.run}: holds no trajectories.vtu of a rockfall run", file=sys.stderr)
        return 2
    scene = options.scene or Path(json.loads(summary.read_text(encoding="utf-8"))["scene"])
    if not scene.is_file():
        print(f"{scene}: no such file; say where it is by --scene", file=sys.stderr)
        return 2
    _draw(site_of(warpdem.load(scene)), options)
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("run", type=Path, metavar="RUN_DIR")
    add("--scene", type=Path, metavar="SCENE.toml", help="default: as the run's summary says")
    add("--view", type=float, nargs=3, default=(0.7, -1.0, 0.8), help="direction to the camera")
    add("--zoom", type=float, default=1.0)
    add("--rocks", type=float, default=1.0, metavar="FACTOR", help="by which rocks are enlarged")
    add("--size", type=int, nargs=2, default=(1280, 800), metavar=("WIDTH", "HEIGHT"))
    add("-o", "--output", type=Path, required=True, metavar="PICTURE.png")
    return parser.parse_args()


def _draw(site: Site, options: argparse.Namespace) -> None:
    plotter = pv.Plotter(off_screen=True, window_size=options.size, lighting="none")
    matt = {"ambient": 0.2, "diffuse": 0.85, "specular": 0.0}
    ground = _ground(options.run, site)
    plotter.add_mesh(ground, scalars="colour", rgb=True, smooth_shading=True, **matt)
    paths = pv.read(options.run / "trajectories.vtu").extract_surface(algorithm=None)
    fastest = float(paths.point_data["speed"].max())
    bar = {"title": "speed [m/s]", "color": "black", "vertical": True, "height": 0.4, "fmt": "%.0f"}
    plotter.add_mesh(
        paths, scalars="speed", cmap="plasma", clim=(0.0, fastest), line_width=2, lighting=False,
        scalar_bar_args=bar | {"position_x": 0.9, "position_y": 0.05},
    )  # fmt: skip
    for part, colour, opacity in (
        (_ended(options), ROCK, 1.0),
        (_nets(site), NET, 0.45),
        (_lines(site), LINE, 1.0),
        (_trunks(site), TRUNK, 1.0),
        (_crowns(site), FOREST, 0.55),
    ):
        if part is not None:
            plotter.add_mesh(part, color=colour, opacity=opacity, **matt)
    for position, strength in (((-1.4, 1.3, 0.4), 0.95), ((0.6, 0.2, 1.0), 0.45)):
        light = pv.Light(light_type="camera light", position=position, intensity=strength)
        plotter.add_light(light)
    plotter.set_background(SKY[0], top=SKY[1])
    plotter.enable_anti_aliasing("ssaa")
    plotter.view_vector(options.view, viewup=(0.0, 0.0, 1.0))
    plotter.camera.zoom(options.zoom)
    plotter.screenshot(options.output)


def _ground(run: Path, site: Site) -> pv.PolyData:
    """The terrain, its faces coloured by their class."""
    terrain = pv.read(run / "terrain.vtu").extract_surface(algorithm=None)
    ramp = np.array([pv.Color(colour).int_rgb for colour in (SOFT, MIDDLE, HARD)], float)
    friction = [kind.mu_min for kind in site.classes]
    palette = np.column_stack([np.interp(friction, (0.2, 0.5, 0.8), part) for part in ramp.T])
    terrain.cell_data["colour"] = palette.astype(np.uint8)[terrain.cell_data["class"]]
    return terrain


def _ended(options: argparse.Namespace) -> pv.DataSet | None:
    """The followed rocks at their ends, each enlarged about its middle."""
    rocks = pv.read(options.run / "rocks.vtu")
    ids = np.asarray(rocks.cell_data["id"])
    last = np.asarray(rocks.cell_data["end"]) == 1
    grown = []
    for one in np.unique(ids[last]):
        rock = rocks.extract_cells(last & (ids == one))
        rock.points = rock.points.mean(axis=0) + options.rocks * (
            rock.points - rock.points.mean(axis=0)
        )
        grown.append(rock)
    return pv.merge(grown) if grown else None


def _along(site: Site, barrier: Barrier) -> np.ndarray:
    """Points on the ground along a barrier, every metre or so, shape [n, 3]."""
    ways = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(barrier.line, axis=0), axis=1))])
    at = np.linspace(0.0, ways[-1], max(2, round(ways[-1])))
    x, y = (np.interp(at, ways, barrier.line[:, axis]) for axis in (0, 1))
    points = np.column_stack([x, y, site.ground.height(x, y)])
    return points[np.isfinite(points[:, 2])]


def _nets(site: Site) -> pv.DataSet | None:
    """Barriers with a height, as upright bands."""
    bands = []
    for barrier in site.barriers:
        foot = _along(site, barrier)
        if np.isfinite(barrier.height) and len(foot) > 1:
            head = foot + np.array([0.0, 0.0, barrier.height])
            bands.append(pv.StructuredGrid(*np.stack([foot, head], axis=1)[None].T))
    return pv.merge([band.extract_surface(algorithm=None) for band in bands]) if bands else None


def _lines(site: Site) -> pv.DataSet | None:
    """Barriers without a height, as lines a little above the ground."""
    tubes = [
        pv.lines_from_points(foot + np.array([0.0, 0.0, LINE_HEIGHT])).tube(
            radius=0.5 * LINE_HEIGHT
        )
        for barrier in site.barriers
        if not np.isfinite(barrier.height) and len(foot := _along(site, barrier)) > 1
    ]
    return pv.merge(tubes) if tubes else None


def _trunks(site: Site) -> pv.DataSet | None:
    trees = site.trees
    if trees is None:
        return None
    base = site.ground.height(*trees.position.T)
    return pv.merge(
        [
            pv.Cylinder(
                center=(*place, 0.5 * (low + top)),
                direction=(0, 0, 1),
                radius=radius,
                height=top - low,
            )
            for place, radius, low, top in zip(
                trees.position, trees.radius, base, trees.top, strict=True
            )
        ]
    )


def _crowns(site: Site) -> pv.DataSet | None:
    """Cones as high as the canopy, one every few metres of forest."""
    if site.stand_of is None:
        return None
    grid, every = site.ground.grid, max(1, round(TREES_APART / site.ground.grid.cell))
    random, cones = np.random.default_rng(1), []
    for row, column in np.argwhere(site.stand_of >= 0):
        if row % every or column % every:
            continue
        shift = random.uniform(-0.3, 0.3, 2) * every + 0.5
        x, y = grid.x + grid.cell * (column + shift[0]), grid.y + grid.cell * (row + shift[1])
        height = site.stands[site.stand_of[row, column]].height
        low = float(site.ground.height(np.array([x]), np.array([y]))[0])
        if np.isfinite(low):
            cone = pv.Cone(
                center=(x, y, low + 0.5 * height),
                direction=(0, 0, 1),
                height=height,
                radius=0.11 * height,
                resolution=10,
            )
            cones.append(cone)
    return pv.merge(cones) if cones else None


if __name__ == "__main__":
    sys.exit(main())
