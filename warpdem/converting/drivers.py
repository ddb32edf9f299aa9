"""What moves the driven bodies of a Rockable file, as [[driver]]."""

from __future__ import annotations

from collections import defaultdict
from math import hypot, pi
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
    """A driver for each body under control, each ramp and each servo."""
    servos = driving.servos[-1:]
    for servo in driving.servos[:-1]:
        said = f"Servo {servo.name}: left out, the program obeys the last servo alone"
        conf.note(servo.place, said)
    made: list[dict[str, Any]] = []
    controls = list(driving.controls)
    for servo in servos:
        more, imposed = _servo(conf, servo)
        made += more
        controls += imposed
    steady: dict[int, list[Control]] = defaultdict(list)
    for control in controls:
        if control.ramp and control.quantity not in FREE:
            made.append(_ramp(conf, control))
        else:
            steady[control.body].append(control)
    return [driver for body in steady for driver in _controlled(conf, body, steady[body])] + made


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
        made.append(_free(conf, body, controls, values))
    return made


def _free(
    conf: Conf, body: int, controls: list[Control], values: dict[str, dict[str, float]]
) -> dict[str, Any]:
    driver: dict[str, Any] = {"bodies": [body_name(body)], "kind": "control"}
    driver |= {key: values[key] for key in FREE if values[key]}
    ramps = [control for control in controls if control.ramp]
    if ramps and len(controls) == 1 and ramps[0].ramp:
        first, last, begin, end = ramps[0].ramp
        largest = last if abs(last) >= abs(first) else first
        driver[ramps[0].quantity] = {ramps[0].axes: largest}
        start = conf.numbers["t"]
        factors = [first / largest, last / largest] if largest else [1.0, 1.0]
        driver["ramp"] = [[begin - start, factors[0]], [end - start, factors[1]]]
    for control in ramps[(1 if "ramp" in driver else 0) :]:
        said = "Servo ramp of a force: not brought beside other controls of its body"
        conf.note(control.place, f"{said}; its last value is written")
    return driver


def _ramp(conf: Conf, control: Control) -> dict[str, Any]:
    """A velocity that changes steadily from one time to another, as the path it leads along."""
    assert control.ramp
    first, last, begin, end = control.ramp
    begin, end = (time - conf.numbers["t"] for time in (begin, end))
    slope = (last - first) / (end - begin)
    axis = control.axes if control.quantity == "velocity" else f"r{control.axes}"
    since = f"(min(max(t, {begin!r}), {end!r}) - ({begin!r}))"
    at_zero = min(max(0.0, begin), end) - begin
    path = (
        f"({first!r})*t + 0.5*({slope!r})*({since}**2 - ({at_zero * at_zero!r}))"
        f" + ({last - first!r})*(max(t, {end!r}) - max(0.0, {end!r}))"
    )
    return {"bodies": [body_name(control.body)], "kind": "expression", axis: path}


def _servo(conf: Conf, servo: Servo) -> tuple[list[dict[str, Any]], list[Control]]:
    """Drivers of a servo, and the steady controls it amounts to."""
    if len(servo.bodies) == 1:
        return [_shaker(conf, servo)], []
    if servo.name == "tritriLodeAngle":
        said = "Servo tritriLodeAngle: the walls keep the first pressure"
        conf.note(servo.place, f"{said}; stresses that change with time are not brought")
    sides = _wall_orders(servo)
    made = [_pressure(servo, wall, value) for wall, (free, value) in enumerate(sides) if free]
    imposed = [
        Control("velocity", AXES[wall // 2], servo.bodies[wall], (value,), servo.place)
        for wall, (free, value) in enumerate(sides)
        if not free and value
    ]
    return made, imposed


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
    return {
        "bodies": [names[wall]],
        "kind": "pressure",
        "pressure": pressure,
        "between": between,
        "axis": AXES[axis],
        "sign": -1 if wall % 2 else 1,
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
