"""What moves the driven bodies of a Rockable file, as [[driver]]."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from math import hypot, pi, radians, sqrt, tan
from typing import TYPE_CHECKING, Any

from warpdem.converting.driving import AXES, Control, Servo

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.converting.conf import Conf
    from warpdem.converting.driving import Driving

FREE = ("force", "moment")
"""What leaves an axis free to move."""


def body_name(number: int) -> str:
    """What a driven body is called in the scene."""
    return f"body{number}"


def drivers(conf: Conf, driving: Driving) -> list[dict[str, Any]]:
    """A driver for each body under control, and for each ramp and servo.

    The program obeys the last of its servos alone (a ramp is one): earlier ramps stay where they
    begin, earlier servos do nothing.
    """
    ramps = [control for control in driving.controls if control.ramp]
    lasting = max(driving.servos + ramps, key=lambda servo: servo.place.line, default=None)
    controls = [_held(conf, control, lasting) for control in driving.controls]
    made: list[dict[str, Any]] = []
    for servo in driving.servos:
        if servo is lasting:
            made, imposed = _servo(conf, servo)
            controls += imposed
        else:
            said = f"Servo {servo.name}: left out, the program obeys the last servo alone"
            conf.note(servo.place, said)
    made += [_ramp(conf, control) for control in controls if control.ramp]
    steady: dict[int, list[Control]] = defaultdict(list)
    for control in controls:
        if not control.ramp:
            steady[control.body].append(control)
    return [driver for body in steady for driver in _controlled(conf, body, steady[body])] + made


def _held(conf: Conf, control: Control, lasting: Control | Servo | None) -> Control:
    if control.ramp is None or control is lasting:
        return control
    said = "Servo ramp: stays at its first value, the program obeys the last servo alone"
    conf.note(control.place, said)
    return replace(control, ramp=None, values=control.ramp[:1])


def _sums(controls: Sequence[Control], quantity: str) -> dict[str, float]:
    """Values by axis; two controls of one axis add up, as in the program."""
    sums: dict[str, float] = defaultdict(float)
    for control in controls:
        if control.quantity == quantity:
            for axis, value in zip(control.axes, control.values, strict=True):
                sums[axis] += value
    return dict(sums)


def _controlled(conf: Conf, body: int, controls: list[Control]) -> list[dict[str, Any]]:
    values = {
        quantity: _sums(controls, quantity) for quantity in ("velocity", "spin", "force", "moment")
    }
    if values["spin"]:
        said = f"body {body}: its spin enters the velocities at contacts here, not in the program"
        conf.note(controls[0].place, said)
    made = []
    steady = {
        key: [values[key].get(axis, 0.0) for axis in AXES]
        for key in ("velocity", "spin")
        if any(values[key].values())
    }
    if steady:
        made.append({"bodies": [body_name(body)], "kind": "constant", **steady})
    if values["force"] or values["moment"]:
        made.append(_free(body, values))
    return made


def _free(body: int, values: dict[str, dict[str, float]]) -> dict[str, Any]:
    """A body that follows forces along some axes."""
    imposed = {key: values[key] for key in FREE if values[key]}
    return {"bodies": [body_name(body)], "kind": "control", **imposed}


def _ramp(conf: Conf, control: Control) -> dict[str, Any]:
    """A value that changes steadily from one time to another.

    That of a velocity is written as the path it leads along.
    """
    assert control.ramp
    first, last, begin, end = control.ramp
    begin, end = (time - conf.numbers["t"] for time in (begin, end))
    driver: dict[str, Any] = {"bodies": [body_name(control.body)]}
    if control.quantity in FREE:
        axes = {control.axes: 1.0}
        ramp = [[begin, first], [end, last]]
        return driver | {"kind": "control", control.quantity: axes, "ramp": ramp}
    slope = (last - first) / (end - begin)
    axis = control.axes if control.quantity == "velocity" else f"r{control.axes}"
    path = (
        f"({first!r})*t + ({0.5 * slope!r})*(min(max(t, {begin!r}), {end!r}) - ({begin!r}))**2"
        f" + ({last - first!r})*max(t, {end!r})"
    )
    return driver | {"kind": "expression", axis: path}


def _servo(conf: Conf, servo: Servo) -> tuple[list[dict[str, Any]], list[Control]]:
    """Drivers of a servo, and the steady controls it amounts to."""
    if len(servo.bodies) == 1:
        return [_shaker(conf, servo)], []
    orders = _wall_orders(servo)
    made = [_pressure(servo, wall, value) for wall, (free, value) in enumerate(orders) if free]
    imposed = [
        Control("velocity", AXES[wall // 2], servo.bodies[wall], (value,), servo.place)
        for wall, (free, value) in enumerate(orders)
        if not free and value
    ]
    if servo.name == "tritriLodeAngle":
        _load(conf, servo, made)
    return made, imposed


def _load(conf: Conf, servo: Servo, presses: list[dict[str, Any]]) -> None:
    """Deviatoric stresses that grow with time, along a path of constant Lode angle."""
    pressure, angle, rate = servo.values
    second = (3.0 * tan(radians(angle)) - sqrt(3.0)) / (2.0 * sqrt(3.0))
    until = conf.numbers["tmax"]
    for press, part in zip(presses, (1.0, second, -1.0 - second), strict=True):
        growth = rate * part
        press["pressure"] = 1.0
        ramp = [[time - conf.numbers["t"], pressure + growth * time] for time in (0.0, until)]
        press["ramp"] = ramp


def _wall_orders(servo: Servo) -> list[tuple[bool, float]]:
    """For each wall xmin, xmax ... whether it presses; the pressure, or the velocity."""
    values = servo.values
    match servo.name:
        case "tritriCustom":
            return [
                (values[2 * wall] != 0.0, values[2 * wall + 1] * _inward(wall, values[2 * wall]))
                for wall in range(6)
            ]
        case "tritriBiaxialCompression":
            pressure, velocity = values
            return [
                (False, 0.0), (True, pressure),
                (False, 0.0), (False, -velocity),
                (False, 0.0), (True, pressure),
            ]  # fmt: skip
        case _:  # isostatic, and the start of LodeAngle
            return [(False, 0.0), (True, values[0])] * 3


def _inward(wall: int, kind: float) -> float:
    """Velocities of the far walls count inwards, along the axis downwards."""
    return -1.0 if wall % 2 and kind == 0.0 else 1.0


def _pressure(servo: Servo, wall: int, pressure: float) -> dict[str, Any]:
    axis = wall // 2
    names = [body_name(body) for body in servo.bodies]
    between = [names[2 * other : 2 * other + 2] for other in range(3) if other != axis]
    inwards = -1 if wall % 2 else 1
    return {
        "bodies": [names[wall]],
        "kind": "pressure",
        "pressure": abs(pressure) or 1.0,
        "between": between,
        "axis": AXES[axis],
        "sign": inwards if pressure >= 0.0 else -inwards,
        **({} if pressure else {"ramp": [[0.0, 0.0]]}),
    }


def _shaker(conf: Conf, servo: Servo) -> dict[str, Any]:
    x, y, z, amplitude, frequency, *start = servo.values
    length = hypot(x, y, z)
    driver: dict[str, Any] = {
        "bodies": [body_name(servo.bodies[0])],
        "kind": "sine",
        "translation": [amplitude * part / length for part in (x, y, z)],
        "frequency": frequency,
    }
    if servo.name != "shaker":
        driver["wave"] = "triangle"
    if start and start[0] * frequency >= 0.25:
        said = "Servo sawtooth_shaker: drifts away in the program when it starts past a quarter"
        conf.note(servo.place, f"{said} of a period; a triangle wave from that start is written")
        return driver | {"start": max(start[0] - conf.numbers["t"], 0.0)}
    if conf.numbers["t"]:
        driver["phase"] = 2.0 * pi * frequency * conf.numbers["t"]
    return driver
