"""Tables of where trajectories end (deposits.csv) and of what they cross (barriers.csv)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.output.rows import listed, quoted, rows
from warpdem.rockfall.flights import MEASURES, Fate
from warpdem.rockfall.hazard import QUANTILES
from warpdem.rockfall.passages import MEASURED, along

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from warpdem.rockfall.flights import Flights
    from warpdem.rockfall.passages import Passage
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site

DEPOSIT_COLUMNS = (
    "id,release,rock,fate,x,y,z,time,runout,fall,reach_angle,energy_max,speed_max,jump_max,spin_max"
)
"""Numbers from 0, a name, a word, national [m], [s], horizontal distance and fall from the start
[m], the angle between them below horizontal [degrees], J, m/s, m, rad/s."""

CROSSING_COLUMNS = "id,barrier,caught,time,x,y,z,distance,height,energy,speed,spin"
"""A number, a name, 0 or 1, s, national [m], along the barrier's line [m], of the centre above
ground [m], J, m/s, rad/s."""

STATISTICS_COLUMNS = ",".join(
    [
        "barrier,crossings,trajectories,share,caught",
        *(f"{name}_{ending}" for name in MEASURED for ending in ("mean", *QUANTILES, "max")),
    ]
)
"""Per barrier: share is that of all trajectories; J, m/s, m, rad/s over its crossings, empty when
there are none."""

_NATIONAL = "%.6f,%.6f,%.6f"
_REAL = "%.9g"
_PEAKS = [MEASURES.index(name) for name in ("energy", "speed", "jump", "spin")]
_WORDS = np.array([fate.name.lower() for fate in Fate])


def deposit_rows(flights: Flights, site: Site, rocks: Sequence[Rock]) -> Iterator[str]:
    """A line a trajectory, in their order; columns as in ``DEPOSIT_COLUMNS``."""
    names = np.array([quoted(rock.name) for rock in rocks])
    way = flights.position - flights.start
    runout = np.hypot(way[:, 0], way[:, 1])
    angle = np.degrees(np.arctan2(-way[:, 2], runout))
    reals = [flights.time, runout, -way[:, 2], angle, *flights.measures[:, _PEAKS].T]
    return rows(
        f"%d,%d,%s,%s,{_NATIONAL}" + f",{_REAL}" * len(reals),
        [
            flights.id.tolist(),
            flights.release.tolist(),
            names[flights.rock].tolist(),
            _WORDS[flights.fate].tolist(),
            *listed(flights.position + site.origin),
            *listed(np.column_stack(reals)),
        ],
    )


def crossing_rows(flights: Flights, site: Site) -> Iterator[str]:
    """A line a crossing, in their order; columns as in ``CROSSING_COLUMNS``."""
    crossings = flights.crossings
    names = np.array([quoted(barrier.name) for barrier in site.barriers] or [""])
    distance = along(site.barriers, crossings)
    reals = [
        distance,
        *(getattr(crossings, name) for name in ("height", "energy", "speed", "spin")),
    ]
    return rows(
        f"%d,%s,%d,{_REAL},{_NATIONAL}" + f",{_REAL}" * len(reals),
        [
            crossings.id.tolist(),
            names[crossings.barrier].tolist(),
            crossings.caught.tolist(),
            crossings.time.tolist(),
            *listed(crossings.position + site.origin),
            *listed(np.column_stack(reals)),
        ],
    )


def statistics_rows(passages: Iterable[Passage]) -> Iterator[str]:
    """A line a barrier; columns as in ``STATISTICS_COLUMNS``."""
    for each in passages:
        head = (quoted(each.name), each.crossings, each.trajectories, each.share, each.caught)
        values = ("" if np.isnan(value) else _REAL % value for value in each.measured.ravel())
        yield ",".join([f"%s,%d,%d,{_REAL},%d" % head, *values]) + "\n"
