"""Chosen trajectories as lines (trajectories.vtu) and as a table (trajectories.csv)."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING

import numpy as np

from warpdem.output.rows import listed, rows

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from vtkmodules.vtkCommonDataModel import vtkUnstructuredGrid

    from warpdem.arrays import FloatArray
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Site
    from warpdem.rockfall.trace import Trace

TRACE_COLUMNS = "id,rock,t,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz,energy,jump,contact"
"""Numbers from 0, s, national [m], principal axes to the world, m/s, rad/s in world axes, kinetic
energy [J], height of the centre above ground [m], 0 or 1. The height is empty where the ground is
unknown, as below the end of a rock that left it."""

_NATIONAL = "%.6f,%.6f,%.6f"


def trace_rows(trace: Trace, site: Site, rocks: Sequence[Rock]) -> Iterator[str]:
    """A line a sample; columns as in ``TRACE_COLUMNS``."""
    reals = np.column_stack(
        [
            trace.orientation,
            trace.velocity,
            trace.spin,
            trace.energy(rocks[trace.rock]),
        ]
    )
    return rows(
        f"{trace.id},{trace.rock},%.9g,{_NATIONAL}" + ",%.9g" * reals.shape[1] + ",%s,%d",
        [
            trace.time.tolist(),
            *listed(trace.position + site.origin),
            *listed(reals),
            ["" if isnan(height) else f"{height:.9g}" for height in _jump(trace, site).tolist()],
            trace.contact.tolist(),
        ],
    )


def flight_lines(traces: Sequence[Trace], site: Site, rocks: Sequence[Rock]) -> vtkUnstructuredGrid:
    """A line a trajectory, one or more, through its samples.

    Points are local coordinates, and the field "origin" gives what national ones are more: graphics
    cards know seven digits, and a filter that rounds to them would shake national coordinates by a
    quarter of a metre. Point data: time [s], speed [m/s], velocity, energy (kinetic) [J], jump
    (height of the centre above ground) [m], spin (rate) [rad/s], contact; jump is NaN where the
    ground is unknown. Cell data: id, rock.
    """
    from warpdem.output import vtu  # noqa: PLC0415 - loads VTK, which few runs need

    velocity = np.concatenate([trace.velocity for trace in traces])
    spin = np.concatenate([trace.spin for trace in traces])
    grid = vtu.polylines(
        np.concatenate([trace.position for trace in traces]),
        np.cumsum([0, *(len(trace.time) for trace in traces)], dtype=np.int32),
        {
            "time": np.concatenate([trace.time for trace in traces]),
            "speed": np.linalg.norm(velocity, axis=1),
            "velocity": velocity,
            "energy": np.concatenate([trace.energy(rocks[trace.rock]) for trace in traces]),
            "jump": np.concatenate([_jump(trace, site) for trace in traces]),
            "spin": np.linalg.norm(spin, axis=1),
            "contact": np.concatenate([trace.contact for trace in traces]).astype(np.uint8),
        },
        {
            "id": np.array([trace.id for trace in traces], np.int64),
            "rock": np.array([trace.rock for trace in traces], np.int32),
        },
    )
    vtu.note(grid, "origin", site.origin)
    return grid


def _jump(trace: Trace, site: Site) -> FloatArray:
    """Height of the centre above ground [m], shape [n]; NaN beyond the ground."""
    x, y, z = trace.position.T
    return z - site.ground.height(x, y)
