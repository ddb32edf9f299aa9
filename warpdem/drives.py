"""Imposed motion on the device: rows of a block of steps, evaluated on the host and sent over."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.driving.plan import block_steps
from warpdem.kernels.precision import quat, wide, wide3, wide33
from warpdem.kernels.views import Drives, Gauge

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.driving.plan import Plan
    from warpdem.features import Features
    from warpdem.kernels.views import Clock

MOTION = ("position", "velocity", "spin", "velocity_end", "spin_end")
LOADS = ("force", "moment", "pressure", "loose", "loose_spin")


def allocate_drives(device: Any, plan: Plan, features: Features, clock: Clock) -> Drives:
    """Room for the rows of a block, and the walls' own numbers; what is not needed has length 1."""
    count = len(plan.bodies)
    rows = count * block_steps(count) if features.driven else 1
    loads = rows if features.controlled else 1
    own = count if features.controlled else 1

    def zeros(dtype: Any, length: int) -> wp.array:
        return wp.zeros(length, dtype=dtype, device=device)

    drives = Drives()
    drives.count = count
    drives.base = zeros(wp.int32, 1)
    drives.steps = clock.steps
    drives.orientation = zeros(quat, rows)
    for name in MOTION:
        setattr(drives, name, zeros(wide3, rows))
    for name in LOADS:
        setattr(drives, name, zeros(wide3, loads))
    for name in ("inverse_mass", "inverse_inertia", "damping", "spin_damping"):
        values = getattr(plan.walls, name) if features.controlled else np.zeros((1, 3))
        setattr(drives, name, wp.array(values, dtype=wide3, device=device))
    for name in ("now", "now_loose", "now_end"):
        setattr(drives, name, zeros(wide33, own))
    drives.area = zeros(wide, 3 * own)
    drives.offset = zeros(wide3, own)
    drives.turn = wp.array(np.tile([0.0, 0.0, 0.0, 1.0], (own, 1)), dtype=quat, device=device)
    return drives


def gauges(device: Any, plan: Plan) -> wp.array:
    """What measures the areas of the pressures."""
    found = []
    for area in plan.walls.areas:
        gauge = Gauge()
        gauge.place = 3 * area.place + area.along
        gauge.low, gauge.high = wp.vec2i(*area.low), wp.vec2i(*area.high)
        gauge.axis, gauge.less = wp.vec2i(*area.axis), wp.vec2d(*area.less)
        found.append(gauge)
    return wp.array(found, dtype=Gauge, device=device)


class Blocks:
    """Keeps the rows of the block of steps that the simulation is in on the device.

    Blocks begin at fixed numbers of steps after the last change of dt: what a row holds does not
    depend on where a run paused or resumed.
    """

    def __init__(self, plan: Plan, features: Features, drives: Drives) -> None:
        self._plan = plan
        self._features = features
        self._drives = drives
        self._steps = block_steps(len(plan.bodies))
        self._base = -1

    def at_rest(self) -> None:
        """The rows of time zero, of a step without length."""
        if self._features.driven:
            self._send(0, np.zeros(1), 0.0)
        if self._features.controlled and self._features.first_step == "gravity":
            # Rockable's walls start without any force
            for name in ("force", "moment", "pressure"):
                getattr(self._drives, name).zero_()
        self._base = -1

    def forget(self) -> None:
        """The clock has changed: no row is right any more."""
        self._base = -1

    def left(self, step: int, *, since: int, time: float, dt: float) -> int:
        """Make the rows of the step after ``step`` steps ready; how many steps rows last.

        ``since`` steps were done at ``time`` [s], when the length of a step became ``dt`` [s].
        """
        if not self._features.driven:
            return 1 << 30
        base = since + (step - since) // self._steps * self._steps
        if base != self._base:
            count = np.arange(self._steps, dtype=np.float64)
            begins = time + (count + float(base - since)) * dt
            self._send(base, begins, dt)
            self._base = base
        return base + self._steps - step

    def _send(self, base: int, begins: FloatArray, dt: float) -> None:
        drives = self._drives
        ends = begins + dt
        # rows past the end of the run need not be finite
        with np.errstate(all="ignore"):
            end = half = self._plan.path(ends)
            if not self._features.stepwise:
                half = self._plan.path(begins + 0.5 * dt)
        drives.base.fill_(base)
        put(drives.position, end.position)
        put(drives.orientation, end.orientation[..., [1, 2, 3, 0]])
        put(drives.velocity, half.velocity)
        put(drives.spin, half.spin)
        put(drives.velocity_end, end.velocity)
        put(drives.spin_end, end.spin)
        if self._features.controlled:
            loads = self._plan.walls.loads(ends, dt)
            for name in LOADS:
                put(getattr(drives, name), getattr(loads, name))


def put(array: wp.array, rows: FloatArray) -> None:
    """Lay rows of shape [step_count, driven_count, size] into the start of a device array."""
    flat = np.ascontiguousarray(rows.reshape(-1, rows.shape[-1]))
    array[: len(flat)].assign(flat)
