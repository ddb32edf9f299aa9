"""Writes scenes/data/valley/terrain.asc, an invented valley: python tools/make_valley.py.

300 x 200 m in cells of 2 m, heights at cell centres, coordinates as in the Swiss grid but of no
real place. From west to east: a shoulder, a cliff, a talus slope with a gully, a meadow, a road, a
brook, the foot of the other side. Bumps are a sum of waves whose phases have a fixed seed.
"""

from pathlib import Path

import numpy as np

FILE = Path(__file__).resolve().parents[1] / "scenes" / "data" / "valley" / "terrain.asc"
CORNER = (2_700_000, 1_180_000)
SIZE = (300, 200)
CELL = 2
TOP = 1462.0
# where a stretch ends [m east], and how steeply it falls [degrees]
STRETCHES = ((36, 24), (52, 68), (70, 40), (150, 35), (190, 27), (226, 14), (234, 1), (248, 12))
STRETCHES += ((256, 0), (300, -18))
WAVES = 40


def profile(x: np.ndarray) -> np.ndarray:
    """Height of the section from west to east [m]: the stretches, their kinks smoothed over 6 m."""
    fine = np.arange(-20.0, SIZE[0] + 20.0, 0.5)
    ends, angles = (np.array(part, float) for part in zip(*STRETCHES, strict=True))
    slope = np.tan(np.radians(angles))[np.minimum(np.searchsorted(ends, fine), len(ends) - 1)]
    slope = np.convolve(np.pad(slope, 6, mode="edge"), np.ones(13) / 13, mode="valid")
    return np.interp(x, fine, TOP - 0.5 * np.cumsum(slope) + 0.5 * slope[0] * 40)


def gully(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Depth of the gully that cuts cliff and talus, and of the fan below it [m]."""
    deep = np.interp(x, [20, 50, 110, 170, 200, 240], [0.0, 4.0, 5.0, 1.0, -1.5, 0.0])
    wide = np.interp(x, [50, 170, 240], [12.0, 16.0, 35.0])
    middle = 100.0 + 12.0 * np.sin(x / 45.0)
    return deep * np.exp(-(((y - middle) / wide) ** 2))


def bumps(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Waves 9 to 70 m long, a hundredth of their length high [m]; next to none on the road."""
    random = np.random.default_rng(3)
    total = np.zeros_like(x)
    for length in np.geomspace(9.0, 70.0, WAVES):
        heading, phase = random.uniform(0.0, 2.0 * np.pi, 2)
        along = x * np.cos(heading) + y * np.sin(heading)
        total += 0.01 * length * np.sin(2.0 * np.pi * along / length + phase) / np.sqrt(WAVES / 8)
    return total * np.interp(x, [0, 216, 226, 234, 244, 300], [1.0, 0.6, 0.1, 0.1, 0.5, 1.0])


def main() -> None:
    """Write the terrain."""
    columns, rows = SIZE[0] // CELL, SIZE[1] // CELL
    x, y = np.meshgrid(CELL * (np.arange(columns) + 0.5), CELL * (np.arange(rows)[::-1] + 0.5))
    bend = 6.0 * np.sin(y / 35.0) * np.interp(x, [120, 200], [1.0, 0.0])
    heights = profile(x + bend) - gully(x, y) + bumps(x, y)
    head = f"ncols {columns}\nnrows {rows}\nxllcorner {CORNER[0]}\nyllcorner {CORNER[1]}\n"
    head += f"cellsize {CELL}\nNODATA_value -9999\n"
    lines = (" ".join(f"{height:.2f}" for height in row) for row in heights)
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(head + "\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
