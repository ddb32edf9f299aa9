"""Writes scenes/tschamut_blocks.toml from the field data: python tools/make_tschamut.py.

The measured releases are separate throws from about the same place. The scene lets as many of them
fall together as do not touch at the start, in the order of the table.
"""

import csv
import math
from pathlib import Path

SCENES = Path(__file__).resolve().parents[1] / "scenes"
DATA = SCENES / "data" / "tschamut"
# clear distance between two released blocks, centre to centre [m]
APART = 1.0

HEAD = """# Blocks of the Tschamut field test fall down their slope: measured shapes, masses and
# release states (EnviDat, doi:10.16904/envidat.34, ODbL; see data/tschamut/README.md) on its
# terrain as a triangle mesh, with the default contact law. Written by tools/make_tschamut.py.
#   python -m warpdem scenes/tschamut_blocks.toml
title = "blocks of the Tschamut field test on their terrain"

[run]
duration = 14.0

[output]
every = 0.1
table = true

[[group]]
name = "rock"

[[group]]
name = "ground"

[[contact]]
groups = ["rock", "ground"]
kn = 1.0e7
kt = 8.0e6
en2 = 0.1
mu = 0.7

[[contact]]
groups = ["rock", "rock"]
kn = 1.0e7
kt = 8.0e6
en2 = 0.25
mu = 0.6

[[shape]]
name = "slope"
kind = "terrain"
file = "data/tschamut/terrain.asc"

[[body]]
name = "slope"
shape = "slope"
group = "ground"
position = [0, 0, 0]
fixed = true
"""


def rows(name: str) -> list[dict[str, str]]:
    """One of the tables."""
    with (DATA / name).open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main() -> None:
    """Write the scene."""
    text = HEAD
    blocks = {row["block_id"]: row for row in rows("block_metadata.csv")}
    for key, block in blocks.items():
        size = [float(block[f"size_{axis}_m"]) for axis in "xyz"]
        text += f"""
[[shape]]
name = "block {key}"  # {block["name"]}
kind = "box"
size = [{size[0]:g}, {size[1]:g}, {size[2]:g}]
rounding = {0.25 * min(size):g}
"""
    taken: list[tuple[float, float, float]] = []
    for row in rows("release_points.csv"):
        place = (float(row["x_m"]), float(row["y_m"]), float(row["z_m"]))
        if any(math.dist(place, other) < APART for other in taken):
            continue
        taken.append(place)
        text += body(row, blocks[row["block_id"]], place)
    (SCENES / "tschamut_blocks.toml").write_text(text, encoding="utf-8")


def body(row: dict[str, str], block: dict[str, str], place: tuple[float, float, float]) -> str:
    """One release: its block at its measured place and velocity, of its measured mass."""
    size = [float(block[f"size_{axis}_m"]) for axis in "xyz"]
    density = float(block["mass_kg"]) / rounded_box_volume(size, 0.25 * min(size))
    velocity = ", ".join(f"{float(row[f'v{axis}_mps']):g}" for axis in "xyz")
    # clear of the ground however the block lies: the table's heights are not those of the raster
    reach = 0.5 * math.hypot(*size)
    height = highest(place[0], place[1], reach) + reach + 0.02
    return f"""
[[body]]
name = "{row["trajectory_id"]}"
shape = "block {block["block_id"]}"
group = "rock"
position = [{place[0]:g}, {place[1]:g}, {height:.4f}]
velocity = [{velocity}]
density = {density:.1f}
"""


def highest(x: float, y: float, reach: float) -> float:
    """Highest ground within ``reach`` of a point [m]: of the cells' corners, bilinear between."""
    lines = (DATA / "terrain.asc").read_text(encoding="utf-8").splitlines()
    head = {key.lower(): float(value) for key, value in (line.split() for line in lines[:6])}
    heights = [[float(z) for z in line.split()] for line in lines[6:]][::-1]

    def ground(x: float, y: float) -> float:
        u = (x - head["xllcorner"]) / head["cellsize"]
        v = (y - head["yllcorner"]) / head["cellsize"]
        i, j = int(u), int(v)
        u, v = u - i, v - j
        low = heights[j][i] * (1 - u) + heights[j][i + 1] * u
        return low * (1 - v) + (heights[j + 1][i] * (1 - u) + heights[j + 1][i + 1] * u) * v

    steps = [reach * k / 2 for k in range(-2, 3)]
    return max(ground(x + dx, y + dy) for dx in steps for dy in steps)


def rounded_box_volume(size: list[float], r: float) -> float:
    """Volume of a box of outer ``size`` with edges and corners rounded to ``r`` [m^3]."""
    a, b, c = (s - 2 * r for s in size)
    area = a * b + b * c + c * a
    return a * b * c + 2 * r * area + math.pi * r * r * (a + b + c) + 4 / 3 * math.pi * r**3


if __name__ == "__main__":
    main()
