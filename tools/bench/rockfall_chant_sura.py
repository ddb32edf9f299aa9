"""Single impacts of the Chant Sura experiment, simulated: speed, spin and height of the next jump.

    python tools/bench/rockfall_chant_sura.py --data FOLDER [--orientations N] [--class NAME ...]

FOLDER holds observed flight segments and their terrain (EnviDat, doi:10.16904/envidat.174, not part
of the repository): samples of position, velocity and spin; between two segments of a trajectory a
rock met the ground. Each such event is repeated with many random orientations, since the observed
one is unknown: the last sample before it gives place, velocity and spin, the first one after it
what is compared.

What the data say of themselves:
- ``raw_z_m`` runs from ground to ground: its height above the terrain is zero within .1 m at both
  ends of a segment. The rock starts with its lowest corner at the terrain.
- ``omega_*`` is along the rock's own axes: the recorded rotational energy is that of constant
  moments about x, y, z within 1e-11, the largest one, 1.6 times the others, about x. The shape is
  EOTA's 2:2:1 plate ("W", a wheel); .93 x .93 x .47 m gives the recorded moments of 780 kg within
  .3 %, and .595 x .595 x .2975 m those of 210 kg.
- one trajectory (RF20e200r1, equant) has no spin and lies half a metre below the terrain: left out.

The shortest observed flight lasts .2 s. Where simulated rocks leave the ground for less, the data
may have seen a flight or may not: --shortest says from when on.

Ground within half a metre of the crop's border is continued beyond it.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import rockfall_cases as cases

from warpdem.geometry.orientation import product, turned
from warpdem.geometry.terrain import read_raster
from warpdem.rockfall.classes import PUBLISHED
from warpdem.rockfall.flights import Method
from warpdem.rockfall.settle import resting_height

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.geometry.terrain import Raster
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.trajectories import Sample

ROCKS = {
    "W200": cases.hull_rock("W200", cases.chamfered_box([0.2975, 0.595, 0.595]), 210.0),
    "W800": cases.hull_rock("W800", cases.chamfered_box([0.47, 0.93, 0.93]), 780.0),
}
SCARRED = replace(
    PUBLISHED["hard"], name="hard, scarred", scar_modulus=15e3, scar_drag=1.5, source="Lu (2019)"
)
CLASSES = {SCARRED.name: SCARRED, **PUBLISHED}
QUANTITIES = ("speed [m/s]", "spin [rad/s]", "jump [m]")
METHOD = Method(duration=1.5, skip="sphere")
"""Every step is a sample: contacts are seen, and the summit of a jump."""


@dataclass(frozen=True, eq=False)
class Event:
    """A contact between two observed segments.

    Attributes:
        name: Of the event.
        rock: That hit.
        place: x, y of its centre [m], shape [2].
        velocity: Before [m/s], shape [3].
        spin: Before, along the rock's axes [rad/s], shape [3].
        after: Observed ``QUANTITIES``, shape [3].
    """

    name: str
    rock: Rock
    place: FloatArray
    velocity: FloatArray
    spin: FloatArray
    after: FloatArray


def events_of(folder: Path, site: Site) -> list[Event]:
    """The events with a recorded spin."""
    rows = cases.table(folder / "observed_trajectories_contact_extended.csv")
    segments: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        segments.setdefault(row["segment_id"], []).append(row)
    found = []
    for event in cases.table(folder / "observed_contact_events_extended.csv"):
        before, after = segments[event["source_segment_id"]], segments[event["next_segment_id"]]
        columns = ("x_m", "y_m", "vx_mps", "vy_mps", "vz_mps")
        spins = tuple(f"omega_{axis}_radps" for axis in "xyz")
        last = cases.numbers(before[-1:], *columns, *spins)[0]
        first = cases.numbers(after[:1], *columns, *spins)[0]
        kind = next((kind for kind in ROCKS if kind in event["source_trajectory_id"]), None)
        if kind is None or not np.isfinite(last).all():
            continue
        x, y, z = cases.numbers(after, "x_m", "y_m", "raw_z_m").T
        clear = z - cases.height(site, x, y)
        observed = [
            np.linalg.norm(first[2:5]),
            np.linalg.norm(first[5:]),
            np.nanmax(clear) - clear[0],
        ]
        found.append(
            Event(event["event_id"], ROCKS[kind], last[:2], last[2:5], last[5:], np.array(observed))
        )
    return found


def outcome(trace: Sample, site: Site, shortest: float) -> FloatArray | None:
    """``QUANTITIES`` of the first jump after the first contact; None when there is none.

    Args:
        trace: Each step of a rock.
        site: The ground.
        shortest: Time off the ground that is a jump [s].
    """
    touched = np.flatnonzero(trace.contact)
    if not len(touched):
        return None
    free = np.diff(np.append(trace.time[touched], trace.time[-1]))
    jumps = np.flatnonzero(free >= shortest)
    if not len(jumps):
        return None
    first = touched[jumps[0]] + 1
    end = touched[jumps[0] + 1] if jumps[0] + 1 < len(touched) else len(trace.time)
    height = trace.position[first:end, 2] - site.ground.height(*trace.position[first:end, :2].T)
    return np.array(
        [
            np.linalg.norm(trace.velocity[first]),
            np.linalg.norm(trace.spin[first]),
            np.nanmax(height) - height[0],
        ]
    )


def spins(rock: Rock, orientation: FloatArray, spin: FloatArray) -> FloatArray:
    """A spin along the axes of the rock's file, along the world's instead, shape [n, 3].

    Args:
        rock: Whose principal frame the orientations turn.
        orientation: Of the principal frame, shape [n, 4].
        spin: [rad/s], shape [3].
    """
    back = rock.frame_rotation * np.array([1.0, -1.0, -1.0, -1.0])
    return turned(product(orientation, back), spin)


def simulated(event: Event, site: Site, count: int, shortest: float) -> FloatArray:
    """``QUANTITIES`` after the event, of those orientations that jump, shape [n, 3]."""
    orientation = cases.random_orientations(count, seed=1)
    place = np.tile(event.place - site.origin[:2], (count, 1))
    clearance = np.full(count, 0.01)
    height = resting_height(site.ground, event.rock, place, orientation, clearance)
    spin = spins(event.rock, orientation, event.spin)
    position = np.column_stack([place, height])
    starts = cases.starts_of(position, orientation, event.velocity, spin)
    traces = cases.follow(site, [event.rock], METHOD, starts, 0.0)
    found = [outcome(trace, site, shortest) for trace in traces]
    return np.array([after for after in found if after is not None]).reshape(-1, 3)


def compare(events: list[Event], raster: Raster, kind: str, *, count: int, shortest: float) -> None:
    """Print the events on one class of ground."""
    print(f"\n{kind}, terrain every {raster.cell:g} m: observed, median (10 .. 90 %)")
    site = cases.site_of(raster, CLASSES[kind])
    inside, ratio, jumping = [], [], []
    for event in events:
        after = simulated(event, site, count, shortest)
        jumping.append(len(after) / count)
        if not len(after):
            print(f"{event.name:24s} no orientation jumps")
            continue
        low, middle, high = np.quantile(after, [0.1, 0.5, 0.9], axis=0)
        inside.append((event.after >= low) & (event.after <= high))
        ratio.append(middle / event.after)
        text = "  ".join(
            f"{seen:6.2f} {cases.band(one)}" for seen, one in zip(event.after, after.T, strict=True)
        )
        print(f"{event.name:24s} {text}  {jumping[-1]:4.0%} jump")
    share, middle = np.sum(inside, axis=0), np.median(ratio, axis=0)
    for quantity, one, factor in zip(QUANTITIES, share, middle, strict=True):
        print(f"{quantity:13s} {one} of {len(inside)} within; simulated/observed {factor:.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder of the segments")
    parser.add_argument("--orientations", type=int, default=30, help="of each event")
    parser.add_argument(
        "--class", dest="classes", nargs="*", choices=CLASSES, default=["hard", SCARRED.name]
    )
    parser.add_argument("--coarsen", type=int, nargs="*", default=[1, 10], help="nodes of 5 cm")
    parser.add_argument(
        "--shortest", type=float, default=0.1, help="time off the ground that is a jump [s]"
    )
    asked = parser.parse_args()
    fine = read_raster(asked.data / "terrain_rf16_contact_extended.asc", nodes="centre")
    events = events_of(asked.data, cases.site_of(fine, PUBLISHED["hard"]))
    print(f"{len(events)} events x {asked.orientations} orientations; {', '.join(QUANTITIES)}")
    for count in asked.coarsen:
        raster = cases.extended(cases.coarsened(fine, count), 3.0)
        for kind in asked.classes:
            compare(events, raster, kind, count=asked.orientations, shortest=asked.shortest)


if __name__ == "__main__":
    main()
