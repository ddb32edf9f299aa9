"""Lu et al. (2019), doi:10.1007/s10346-019-01238-z: four impacts that scar, and many trajectories.

    python tools/bench/rockfall_lu.py [--runs N] [--orientations N] [--cliff METRES ...]

1. Four impacts of the 780 kg plate (.93 x .93 x .47 m, EOTA 2:2:1) at Chant Sura, with the soil
   that the paper found for each. Tables 2 and 3 give velocity, spin, depth and length of the scars,
   measured and simulated. Their velocities are those of some instant of the flight before; the
   vertical ones at touch and at the start of a flight follow here from the parabola between two
   scars (positions of table 2, horizontal speed unchanged). Before the first impact there is no
   scar: its vertical speed is the one that gives the paper's own depth, so it proves nothing. The
   ground is a plane as steep as the line between neighbouring scars; the wheel rolls downhill, at
   random phases.
2. Trajectories on an equivalent slope (table 5: M_E 15 MN/m^2, C_s 1.5): speed, spin, jump height
   and length while off the ground, above 2338 m (region 1) and down to 2267 m (region 2). The
   paper's terrain is not public here. Known are the release and the four scars; the profile joins
   them. A cliff ends region 1, its height is not in the text: several are tried. No roughness
   unless --rough says so. Orders of magnitude may be compared, not more.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import rockfall_cases as cases

from warpdem.geometry.orientation import product
from warpdem.rockfall.classes import PUBLISHED
from warpdem.rockfall.flights import Method
from warpdem.rockfall.settle import resting_height

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.geometry.terrain import Raster
    from warpdem.rockfall.flights import Starts
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.trajectories import Sample

PLATE = cases.hull_rock("plate", cases.chamfered_box([0.93, 0.93, 0.47]), 780.0)
"""The largest moment is about z of its file's axes: the axis of the wheel."""
STEP = 2e-3
"""Largest step of the impacts [s], the paper's."""
EVERY = 0.02
"""Least time between samples of trajectories [s]."""
PUBLISHED_MEANS = {
    1: (10.53, 922.9, 1.34, 4.09),
    2: (17.44, 1745.3, 1.95, 9.92),
}
"""Table 5, of C_s 1.5, M_E 15: speed [m/s], spin [deg/s], jump height, jump length [m]."""
RELEASE = np.array([2793260.85, 1180275.93, 2380.85])
"""Start of a reconstructed flight, LV95 [m]; EnviDat, doi:10.16904/envidat.174."""
REGIONS = (2338.0, 2267.0)
"""Lower ends of the regions [m]."""


@dataclass(frozen=True)
class Impact:
    """Tables 2 and 3.

    Attributes:
        scar: Its place [m].
        horizontal: Speed in plan [m/s].
        spin: [rad/s].
        modulus: M_E [kN/m^2].
        drag: C_s.
        depth, length: Of the scar: measured, simulated there [m].
    """

    scar: tuple[float, float, float]
    horizontal: float
    spin: float
    modulus: float
    drag: float
    depth: tuple[float, float]
    length: tuple[float, float]


IMPACTS = (
    Impact(
        (2793293.57, 1180191.09, 2307.06),
        float(np.hypot(5.56, 14.62)),
        23.85,
        25e3,
        4.0,
        (0.13, 0.14),
        (1.40, 1.80),
    ),
    Impact(
        (2793297.18, 1180181.46, 2299.46),
        float(np.hypot(5.30, 12.70)),
        26.30,
        15e3,
        1.5,
        (0.15, 0.16),
        (1.80, 1.64),
    ),
    Impact(
        (2793300.21, 1180173.11, 2292.43),
        float(np.hypot(5.34, 12.31)),
        29.33,
        10e3,
        0.1,
        (0.18, 0.18),
        (1.55, 1.26),
    ),
    Impact(
        (2793303.71, 1180163.68, 2286.58),
        float(np.hypot(5.34, 14.19)),
        28.69,
        10e3,
        0.5,
        (0.21, 0.18),
        (1.52, 1.77),
    ),
)


def published_depth(mass: float, modulus: float, sinking: float) -> float:
    """Gerber's depth as Lu et al. use it [m]; kg, kN/m^2, m/s."""
    return 0.1 * mass ** (1 / 3) * modulus**-0.4 * sinking**0.8


def legs() -> tuple[FloatArray, FloatArray]:
    """Distance in plan and fall from each scar to the next [m]."""
    way = np.diff([impact.scar for impact in IMPACTS], axis=0)
    return np.hypot(way[:, 0], way[:, 1]), -way[:, 2]


def sinking(number: int) -> float:
    """Vertical speed at touch [m/s]: of the parabola from the scar before, or by the depth."""
    impact = IMPACTS[number]
    if number == 0:
        unit = published_depth(PLATE.mass, impact.modulus, 1.0)
        return (impact.depth[1] / unit) ** 1.25
    ways, falls = legs()
    flight = ways[number - 1] / impact.horizontal
    return falls[number - 1] / flight + 0.5 * cases.G * flight


def leaving(number: int) -> tuple[float, float]:
    """Observed speed [m/s] and spin [rad/s] after an impact: of the flight to the next scar."""
    if number + 1 == len(IMPACTS):
        return np.nan, np.nan
    following = IMPACTS[number + 1]
    flight = legs()[0][number] / following.horizontal
    vertical = cases.G * flight - sinking(number + 1)
    return float(np.hypot(following.horizontal, vertical)), following.spin


def hit(number: int, count: int) -> None:
    """Simulate an impact and print depth, length and speed after it."""
    impact, down = IMPACTS[number], sinking(number)
    ways, falls = legs()
    near = slice(max(number - 1, 0), number + 1)
    slope = np.degrees(np.arctan2(falls[near].sum(), ways[near].sum()))
    soil = replace(PUBLISHED["hard"], scar_modulus=impact.modulus, scar_drag=impact.drag)
    x = np.arange(-10.0, 50.0, 0.5)
    plane = cases.slope(-np.tan(np.radians(slope)) * x, x[0], width=20.0, cell=0.5)
    site = cases.site_of(plane, soil)
    orientation = rolling(count)
    place = np.tile(-site.origin[:2], (count, 1))
    height = resting_height(site.ground, PLATE, place, orientation, np.full(count, 0.01))
    velocity = np.array([impact.horizontal, 0.0, -down])
    spin = np.array([0.0, impact.spin, 0.0])
    starts = cases.starts_of(np.column_stack([place, height]), orientation, velocity, spin)
    traces = cases.follow(site, [PLATE], Method(duration=1.0, dt=STEP, skip="sphere"), starts, 0.0)
    found = np.array([scar(site, trace) for trace in traces])
    formula = published_depth(PLATE.mass, impact.modulus, down)
    speed, spin = leaving(number)
    print(
        f"impact {number + 1}: slope {slope:.1f} degrees, {down:.2f} m/s down; "
        "here: median (10 .. 90 %); there; measured"
    )
    for name, own, there, measured in zip(
        ("depth [m]", "length [m]", "speed after [m/s]", "spin after [rad/s]"),
        found.T,
        (impact.depth[1], impact.length[1], np.nan, np.nan),
        (impact.depth[0], impact.length[0], speed, spin),
        strict=True,
    ):
        extra = f"  formula {formula:.3f}" if name.startswith("depth") else ""
        print(f"  {name:20s} {cases.band(own)} {there:6.2f} {measured:6.2f}{extra}")


def rolling(count: int) -> FloatArray:
    """Wheels whose axis is y, at random phases: those that roll towards +x; shape [count, 4]."""
    half = np.pi * np.random.default_rng(1).random(count)
    none = np.zeros(count)
    phase = np.column_stack([np.cos(half), none, none, np.sin(half)])
    # about x by a quarter turn backwards: z becomes y
    upright = product(np.array([np.sqrt(0.5), -np.sqrt(0.5), 0.0, 0.0]), phase)
    return product(upright, PLATE.frame_rotation)


def scar(site: Site, trace: Sample) -> tuple[float, float, float, float]:
    """Depth, length along the slope, and speed and spin when the rock has left its first scar."""
    depth = cases.depths(site, PLATE, trace)
    inside = np.flatnonzero(depth > 0.0)
    first = inside[0]  # it starts 1 cm above the ground
    out = np.flatnonzero(depth[first:] <= 0.0)
    last = first + out[0] if len(out) else len(depth) - 1
    length = np.linalg.norm(trace.position[last] - trace.position[first])
    speed, spin = np.linalg.norm(trace.velocity[last]), np.linalg.norm(trace.spin[last])
    return depth[first:last].max(), float(length), float(speed), float(spin)


def profile(cliff: float, cell: float) -> Raster:
    """The equivalent slope, falling towards +x from the release at 0; heights above sea."""
    first = IMPACTS[0].scar
    ways, falls = legs()
    steep = falls.sum() / ways.sum()
    plan = float(np.hypot(first[0] - RELEASE[0], first[1] - RELEASE[1]))
    edge = plan - (REGIONS[0] - first[2]) / steep
    points = [
        (-20.0, RELEASE[2] + 1.0),
        (0.0, RELEASE[2]),
        (edge - 1.0, REGIONS[0] + cliff),
        (edge, REGIONS[0]),
        (edge + (REGIONS[0] - REGIONS[1]) / steep + 20.0, REGIONS[1] - 20.0 * steep),
    ]
    x = np.arange(points[0][0], points[-1][0], cell)
    heights = np.interp(x, *np.array(points).T)
    return cases.slope(heights, x[0], width=100.0, cell=cell)


def released(site: Site, count: int) -> Starts:
    """Centres 1 m above ground, 1 m/s downhill, any orientation."""
    place = np.append([0.0, 0.0], cases.height(site, np.zeros(1), np.zeros(1)) + 1.0)
    orientation = cases.random_orientations(count, seed=1)
    position = np.tile(place - site.origin, (count, 1))
    return cases.starts_of(position, orientation, np.array([1.0, 0.0, 0.0]), np.zeros(3))


def samples(site: Site, trace: Sample) -> FloatArray:
    """What is seen off the ground, shape [n, 6].

    Columns: time until the next sample, height above sea, speed, spin [deg/s], jump height, length.
    """
    free = cases.depths(site, PLATE, trace) < 0.0
    ground = site.ground.height(*trace.position[:, :2].T)
    under = np.column_stack([trace.position[:, :2], ground])
    left = np.maximum.accumulate(np.where(free, 0, np.arange(len(free))))
    values = (
        np.diff(trace.time, append=trace.time[-1]),
        trace.position[:, 2] + site.origin[2],
        np.linalg.norm(trace.velocity, axis=1),
        np.degrees(np.linalg.norm(trace.spin, axis=1)),
        trace.position[:, 2] - ground,
        np.linalg.norm(under - under[left], axis=1),
    )
    return np.column_stack(values)[free]


def descend(cliff: float, rough: float, runs: int) -> None:
    """Simulate trajectories on the equivalent slope and print their means by region."""
    soil = replace(PUBLISHED["hard"], scar_modulus=15e3, scar_drag=1.5)
    raster = profile(cliff, 0.5)
    if rough:
        raster = cases.roughened(raster, rough, seed=2)
    site = cases.site_of(raster, soil)
    traces = cases.follow(site, [PLATE], Method(duration=60.0), released(site, runs), EVERY)
    shown = np.concatenate([samples(site, trace) for trace in traces])
    for region, published in PUBLISHED_MEANS.items():
        inside = np.digitize(shown[:, 1], REGIONS) + 1 == region
        means = np.full(4, np.nan)
        if inside.any():
            means = np.average(shown[inside, 2:], axis=0, weights=shown[inside, 0])
        text = "  ".join(
            f"{own:7.2f} ({there:7.2f})" for own, there in zip(means, published, strict=True)
        )
        print(f"cliff {cliff:4.1f} m, region {region}: {text}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--orientations", type=int, default=30, help="of each impact")
    parser.add_argument("--runs", type=int, default=100, help="of each slope; there: 5000")
    parser.add_argument("--cliff", type=float, nargs="*", default=[0.0, 10.0], help="heights [m]")
    parser.add_argument("--rough", type=float, default=0.0, help="noise of the nodes [m]")
    asked = parser.parse_args()
    print()
    for number in range(len(IMPACTS)):
        hit(number, asked.orientations)
    print("\nspeed [m/s], spin [deg/s], jump height, jump length [m] (published)")
    for cliff in asked.cliff:
        descend(cliff, asked.rough, asked.runs)


if __name__ == "__main__":
    main()
