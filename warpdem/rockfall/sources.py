"""One release made ready: its places, table and rocks, and what it draws for a trajectory."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.input.scene_release import AreaRelease, LineRelease, PointRelease, TableRelease
from warpdem.rockfall.areas import Area, checked_areas, read_areas
from warpdem.rockfall.compass import direction
from warpdem.rockfall.places import Areas, Places, Points, straight
from warpdem.rockfall.random import Purpose, Streams
from warpdem.rockfall.release_table import Rows, read_rows

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.input.scene_release import Release


@dataclass(frozen=True, eq=False)
class Source:
    """A release made ready.

    Attributes:
        section: As in the scene.
        places: Where it starts.
        rows: Of its table, or None.
        rocks: Numbers of the rocks drawn from, shape [rock_count].
        odds: How often each is drawn, shape [rock_count].
    """

    section: Release
    places: Places
    rows: Rows | None
    rocks: IntArray
    odds: FloatArray


def place_key(section: Release) -> str:
    """The key that says where a release is."""
    match section:
        case PointRelease():
            return "points"
        case LineRelease():
            return "line"
        case AreaRelease(file=None):
            return "polygon"
        case _:
            return "file"


def source_of(section: Release, directory: Path, origin: FloatArray, names: list[str]) -> Source:
    """A release with its files read, in local coordinates.

    Args:
        section: As in the scene.
        directory: Folder at which relative file names start.
        origin: Of the local coordinates, shape [3].
        names: Of the rocks, in the order of their numbers.

    Raises:
        GeometryError: A file cannot be read, or a line or area is none.
    """
    chosen = section.rocks if section.rocks is not None else tuple(names)
    rows = None
    if isinstance(section, TableRelease):
        rows = read_rows(directory / section.file, section.columns, names)
    return Source(
        section=section,
        places=Points(rows.position - origin) if rows else _places(section, directory, origin),
        rows=rows,
        rocks=np.array([names.index(name) for name in chosen]),
        odds=np.array(section.weights or (1.0,) * len(chosen)),
    )


def _places(section: Release, directory: Path, origin: FloatArray) -> Places:
    """Where a release without a table starts."""
    match section:
        case PointRelease():
            return Points(np.array([(*point, np.nan)[:3] for point in section.points]) - origin)
        case LineRelease():
            return straight(np.array(section.line) - origin[:2])
        case AreaRelease(file=None):
            border = np.array(section.polygon) - origin[:2]
            return Areas(checked_areas([Area((border,))]))
        case _:
            areas = read_areas(directory / str(section.file), origin[:2])
            return Areas(checked_areas(areas))


def rock_numbers(source: Source, streams: Streams, turn: IntArray) -> IntArray:
    """Number of the rock of each trajectory, shape [n]."""
    if source.rows and source.rows.rock is not None:
        return source.rows.rock[turn % source.places.count]
    odds = np.cumsum(source.odds)
    drawn = np.searchsorted(odds, streams.uniform(Purpose.ROCK) * odds[-1], side="right")
    return source.rocks[np.minimum(drawn, len(odds) - 1)]


def velocities(source: Source, streams: Streams, turn: IntArray) -> FloatArray:
    """Initial velocities [m/s], shape [n, 3]."""
    section = source.section
    if source.rows and source.rows.velocity is not None:
        return source.rows.velocity[turn % source.places.count]
    if section.speed is None:
        return _alike(section.velocity, len(turn))
    speed = amounts(section.speed, streams, Purpose.SPEED)
    azimuth = amounts(section.azimuth or 0.0, streams, Purpose.AZIMUTH)
    dip = amounts(section.dip or 0.0, streams, Purpose.DIP)
    return speed[:, None] * direction(azimuth, dip)


def spins(source: Source, streams: Streams, turn: IntArray) -> FloatArray:
    """Initial angular velocities, world axes [rad/s], shape [n, 3]."""
    section = source.section
    if source.rows and source.rows.spin is not None:
        return source.rows.spin[turn % source.places.count]
    if section.spin_rate is None:
        return _alike(section.spin, len(turn))
    rate = amounts(section.spin_rate, streams, Purpose.SPIN_RATE)
    return rate[:, None] * streams.directions(Purpose.SPIN_AXIS)


def _alike(vector: tuple[float, ...] | None, count: int) -> FloatArray:
    return np.tile(np.array(vector or (0.0, 0.0, 0.0)), (count, 1))


def amounts(value: Any, streams: Streams, purpose: Purpose) -> FloatArray:
    """A number for each trajectory, or one drawn from a range, shape [n]."""
    if isinstance(value, tuple):
        return streams.between(purpose, *value)
    return np.full(len(streams.ids), float(value))
