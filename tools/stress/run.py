"""Twenty scenes that try to break the program, each with what it must show.

    python tools/stress/run.py [NAME ...] [--short] [--json FILE] [--precision mixed]

Prints a line a figure: scene, metric, figure, gate, PASS or FAIL; then the seconds of each scene.
--short is what continuous integration runs: the same scenes, fewer steps. Exit status 1 where a
figure is beyond its gate.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import traceback
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bonds
import extents
import flights
import impacts
import numpy as np
import packings
import refusals
import rig
import slopes
import stacks
import towers
import walls

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

ROWS: dict[str, Callable[[rig.Way], Iterable[rig.Figure]]] = {
    "heavy": stacks.heavy,
    "stiff": stacks.stiff,
    "needles": packings.needles,
    "tower": towers.tower,
    "tower10": towers.ten,
    "limit": towers.limit,
    "creep": slopes.creep,
    "bullet": refusals.bullet,
    "far": extents.far,
    "packing": packings.packing,
    "top": flights.top,
    "rotor": flights.rotor,
    "bonds": bonds.bonds,
    "overlaps": refusals.overlaps,
    "meshes": refusals.meshes,
    "nonsense": refusals.nonsense,
    "laws": impacts.laws,
    "flight": flights.flight,
    "drum": packings.drum,
    "sizes": extents.sizes,
    "slope": slopes.slope,
    "plane": walls.plane,
}
HEAD = f"{'scene':10} {'metric':58} {'figure':>10} {'gate':>9}"


def measured(name: str, way: rig.Way) -> dict[str, Any]:
    """Figures of a scene and its time; a traceback is a figure that fails."""
    since = time.perf_counter()
    figures: list[rig.Figure] = []
    try:
        figures.extend(ROWS[name](way))
    except Exception as fault:  # noqa: BLE001 - whatever breaks is what is looked for
        traceback.print_exc()
        figures.append(rig.Figure("ends by itself", np.nan, 0.0, str(fault).splitlines()[0][:90]))
    return {"name": name, "figures": figures, "seconds": time.perf_counter() - since}


def show(row: dict[str, Any]) -> None:
    for figure in row["figures"]:
        word = "PASS" if figure.passes else "FAIL"
        note = f"  {figure.note}" if figure.note else ""
        print(
            f"{row['name']:10} {figure.metric:58} {figure.value:10.2e} {figure.gate:9.1e}  "
            f"{word}{note}"
        )
    print(f"{row['name']:10} {row['seconds']:.1f} s", flush=True)


def recorded(row: dict[str, Any]) -> dict[str, Any]:
    figures = [{**asdict(figure), "passes": figure.passes} for figure in row["figures"]]
    return {**row, "figures": figures}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(ROWS))
    parser.add_argument("--short", action="store_true", help="fewer steps")
    parser.add_argument("--json", type=Path, metavar="FILE", help="where the figures go too")
    parser.add_argument("--precision", choices=("float64", "mixed"), default="float64")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in ROWS]:
        parser.error(f"no scene {', '.join(unknown)}; there are {', '.join(ROWS)}")
    way = rig.Way(short=asked.short, precision=asked.precision)
    print(HEAD)
    rows = []
    for name in asked.names or ROWS:
        rows.append(measured(name, way))
        show(rows[-1])
    failed = [row["name"] for row in rows if not all(f.passes for f in row["figures"])]
    total = sum(row["seconds"] for row in rows)
    print(f"{len(rows)} scenes in {total:.1f} s, {len(failed)} FAIL {' '.join(failed)}")
    if asked.json:
        facts = {"short": way.short, "precision": way.precision}
        facts["rows"] = [recorded(row) for row in rows]
        asked.json.write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
