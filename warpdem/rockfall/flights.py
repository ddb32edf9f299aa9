"""What a bundle of trajectories starts from and ends in, as NumPy arrays."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray


class Fate(IntEnum):
    """How a trajectory ended."""

    MOVING = 0
    REST = 1
    LEFT = 2  # the known ground
    TIMEOUT = 3
    CAUGHT = 4  # by a barrier
    BROKEN = 5  # its motion is not finite: an error, not a result


@dataclass(frozen=True)
class Method:
    """How trajectories are stepped.

    Attributes:
        duration: Longest time of a trajectory [s].
        gravity: Acceleration [m/s^2], world axes.
        dt: Largest time step [s].
        stride: Largest way of any point of a rock in one step, over its bounding radius; 0: dt is
            fixed.
        tolerance: Change of contact velocities at which the sweeps stop, over the largest of them.
        sweeps: Most sweeps before the friction bounds are frozen, and again after.
        accelerate_from: Sweep from which on Anderson acceleration helps; 0: never.
        gyroscope: "midpoint", order 2; "leine", the published one, order 1.
        skip: "jump": no vertices while the bounding sphere is clear, and whole stretches of free
            flight at once; "sphere": the first alone; "none".
        jump_angle: Largest rotation in one jump [rad].
        lift: Part of the depth beyond ``slop`` that a step lifts a rock, paid from its speed; 0:
            never.
        slop: [m].
        rest_time: Length of the window over which a rock must stay where it is [s].
        rest_move: Largest way within the window, over the bounding radius.
    """

    duration: float
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    dt: float = 5e-3
    stride: float = 0.03
    tolerance: float = 1e-4
    sweeps: int = 60
    accelerate_from: int = 4
    gyroscope: Literal["midpoint", "leine"] = "midpoint"
    skip: Literal["jump", "sphere", "none"] = "jump"
    jump_angle: float = 0.1
    lift: float = 0.0
    slop: float = 1e-3
    rest_time: float = 0.5
    rest_move: float = 2e-3


@dataclass(frozen=True, eq=False)
class Starts:
    """Rocks about to move; one row each, local coordinates, world axes.

    Attributes:
        id: Global number of the trajectory, int64, shape [n].
        release: Number of the release it comes from, int32, shape [n].
        rock: Number of the rock, int32, shape [n].
        position: Of the centre of mass [m], shape [n, 3].
        orientation: Unit quaternion w, x, y, z from the principal frame to the world, shape [n, 4].
        velocity: [m/s], shape [n, 3].
        spin: [rad/s], world axes, shape [n, 3].
    """

    id: IntArray
    release: IntArray
    rock: IntArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray


@dataclass(frozen=True, eq=False)
class Visits:
    """The largest values of a rock while its centre was above a cell; one row a visit.

    A rock that comes back to a cell has several rows for it.

    Attributes:
        id: Of the trajectory, int64, shape [n].
        cell: Of the site's grid of results, int64, shape [n].
        energy: Kinetic, of translation and rotation [J], float32, shape [n].
        speed: [m/s], float32, shape [n].
        jump: Height of the centre of mass above the ground [m], float32, shape [n].
        spin: [rad/s], float32, shape [n].
    """

    id: IntArray
    cell: IntArray
    energy: FloatArray
    speed: FloatArray
    jump: FloatArray
    spin: FloatArray


@dataclass(frozen=True, eq=False)
class Crossings:
    """Passages through barriers, in the order of id, time.

    Attributes:
        id: Of the trajectory, int64, shape [n].
        barrier: Number of the barrier, int32, shape [n].
        caught: Whether it ended there, bool, shape [n].
        time: [s], shape [n].
        position: Of the centre, local [m], shape [n, 3].
        height: Of the centre above ground [m], shape [n].
        energy: On arrival [J], shape [n].
        speed: On arrival [m/s], shape [n].
        spin: [rad/s], shape [n].
    """

    id: IntArray
    barrier: IntArray
    caught: IntArray
    time: FloatArray
    position: FloatArray
    height: FloatArray
    energy: FloatArray
    speed: FloatArray
    spin: FloatArray


COUNTS = (
    "contact_steps",
    "flight_steps",
    "jumps",
    "sweeps",
    "frozen",
    "unconverged",
    "limited",
    "dropped",
    "most_sweeps",
)
"""Names of the whole numbers kept of each trajectory: steps with contact and without, jumps among
the latter, sweeps of all steps, steps that needed frozen friction bounds, that ended unconverged,
that the energy limiter scaled, contacts beyond the capacity, most sweeps of one step."""

MEASURES = (
    "depth",
    "residual",
    "gain",
    "lifted",
    "energy",
    "speed",
    "jump",
    "spin",
)
"""Names of the largest values kept of each trajectory: depth of a vertex [m], residual of an
unconverged step [-], energy gained in a step over the mass [J/kg], sum of lifts [m], kinetic
energy [J], speed [m/s], height above ground [m], spin [rad/s]."""


@dataclass(frozen=True, eq=False)
class Flights:
    """Trajectories that ended, in the order of their ``Starts``.

    Attributes:
        id, release, rock: As in ``Starts``.
        fate: ``Fate``, int8, shape [n].
        time: [s], shape [n].
        start: Position at the start [m], local, shape [n, 3].
        position, orientation, velocity, spin: At the end, as in ``Starts``.
        counts: Columns as in ``COUNTS``, int64, shape [n, count_count].
        measures: Columns as in ``MEASURES``, float64, shape [n, measure_count].
        visits: Cells passed.
        crossings: Barriers passed.
    """

    id: IntArray
    release: IntArray
    rock: IntArray
    fate: IntArray
    time: FloatArray
    start: FloatArray
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    counts: IntArray
    measures: FloatArray
    visits: Visits
    crossings: Crossings
