"""Reading Rockable's drivingSystem.txt: what moves the driven bodies and the periodic cell."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from warpdem.converting.words import SMALLEST, Misread, words_of
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.converting.conf import Conf
    from warpdem.converting.words import Place, Words

AXES = "xyz"


CONTROLS: dict[str, tuple[str, str]] = {
    **{f"_{axis}_Vel_": ("velocity", axis) for axis in AXES},
    **{f"_{axis}_For_": ("force", axis) for axis in AXES},
    **{f"_{axis}rot_Vel_": ("spin", axis) for axis in AXES},
    **{f"_{axis}rot_Mom_": ("moment", axis) for axis in AXES},
    "_xyzrot_Vel_": ("spin", AXES),
    "_xyzrot_Mom_": ("moment", AXES),
}
"""Quantity and axes of each type of control."""

WALLS = 6
SERVOS = {
    "tritriIsostaticCompression": 1,
    "tritriBiaxialCompression": 2,
    "tritriLodeAngle": 3,
}
"""Servos on six walls: how many numbers follow the walls."""

SHAKERS = {"shaker": 5, "triangle_shaker": 5, "sawtooth_shaker": 6}
"""Shakers: how many numbers (direction, amplitude, frequency, start) follow the body."""

LOADINGS = ("IsotropicCompression", "TriaxialCompression", "SimpleShearDeformable")


@dataclass(frozen=True)
class Control:
    """One quantity of one body, imposed.

    Attributes:
        quantity: velocity, force, spin or moment.
        axes: The axes it is for, in the order of the values.
        body: Number of the body.
        values: One for each axis, in SI units.
        place: Where it stands.
        ramp: Value at the start, value at the end, time of the start, time of the end; or None.
    """

    quantity: str
    axes: str
    body: int
    values: tuple[float, ...]
    place: Place
    ramp: tuple[float, float, float, float] | None = None


@dataclass(frozen=True)
class Servo:
    """A rule that sets controls as time goes on.

    Attributes:
        name: Of the rule.
        bodies: The bodies it moves; six walls xmin, xmax, ymin ... zmax, or one body.
        values: What follows them.
        place: Where it stands.
    """

    name: str
    bodies: tuple[int, ...]
    values: tuple[float, ...]
    place: Place


@dataclass(frozen=True)
class Loading:
    """What is done to a periodic cell.

    Attributes:
        name: Of the loading.
        direction: Its axis or plane, in capitals; empty without.
        pressure: [Pa].
        rate: Of strain [1/s]; 0 without.
        place: Where it stands.
    """

    name: str
    direction: str
    pressure: float
    rate: float
    place: Place


@dataclass
class Driving:
    """The content of the file."""

    controls: list[Control] = field(default_factory=list)
    servos: list[Servo] = field(default_factory=list)
    loadings: list[Loading] = field(default_factory=list)


def read_driving(path: Path, conf: Conf) -> Driving:
    """What the file says; empty when there is no such file, as in the program.

    Args:
        path: The file.
        conf: Is told what is wrong.
    """
    driving = Driving()
    if not path.is_file():
        return driving
    words = words_of(path)
    while key := words.keyword():
        try:
            _read(driving, key, words, conf)
        except Misread as fault:
            conf.fault(words.place, f"{key}: {fault}")
            words.skip_line()
    return driving


def _read(driving: Driving, key: str, words: Words, conf: Conf) -> None:
    match key:
        case "Control":
            driving.controls.append(_control(words, conf))
        case "Servo":
            _servo(driving, words, conf)
        case "PeriodicLoading":
            driving.loadings.append(_loading(words))
        case _:
            known = ("Control", "Servo", "PeriodicLoading")
            raise Misread(f"no keyword of drivingSystem.txt{did_you_mean(key, known)}")


def _control(words: Words, conf: Conf) -> Control:
    quantity, axes = _type(words)
    body = _body(words, conf)
    values = words.vector("the value", len(axes))
    return Control(quantity, axes, body, values, words.place)


def _type(words: Words) -> tuple[str, str]:
    name = words.word("a type of control")
    if name not in CONTROLS:
        raise Misread(f"there is no control {name!r}{did_you_mean(name, CONTROLS)}")
    return CONTROLS[name]


def _body(words: Words, conf: Conf) -> int:
    body = words.count("the number of a body")
    if body >= conf.driven:
        raise Misread(f"body {body} is not among the first nDriven = {conf.driven}")
    return body


def _servo(driving: Driving, words: Words, conf: Conf) -> None:
    name = words.word("the name of a servo")
    if name == "ramp":
        driving.controls.append(_ramp(words, conf))
    elif name in SHAKERS:
        body = _body(words, conf)
        values = words.vector("a value", SHAKERS[name])
        if values[4] <= 0.0 or not any(values[:3]):
            raise Misread("a shaker has a direction and a frequency above 0")
        driving.servos.append(Servo(name, (body,), values, words.place))
    elif name in SERVOS or name == "tritriCustom":
        walls = tuple(_body(words, conf) for _ in range(WALLS))
        count = SERVOS.get(name, 2 * WALLS)
        values = words.vector("a value", count)
        if name == "tritriLodeAngle" and not 0.0 <= values[1] <= 60.0:
            raise Misread(f"the Lode angle should lie from 0 to 60 degrees, not {values[1]!r}")
        driving.servos.append(Servo(name, walls, values, words.place))
    else:
        known = [*SERVOS, *SHAKERS, "tritriCustom", "ramp"]
        raise Misread(f"there is no servo {name!r}{did_you_mean(name, known)}")


def _ramp(words: Words, conf: Conf) -> Control:
    quantity, axes = _type(words)
    body = _body(words, conf)
    if len(axes) > 1:
        raise Misread("a ramp is for one axis")
    first, last, begin, end = words.vector("a value", 4)
    if end - begin < SMALLEST:
        raise Misread(f"the ramp ends at {end!r} s, before it begins")
    return Control(quantity, axes, body, (last,), words.place, (first, last, begin, end))


def _loading(words: Words) -> Loading:
    name = words.word("the name of a loading")
    if name not in LOADINGS:
        raise Misread(f"there is no loading {name!r}{did_you_mean(name, LOADINGS)}")
    direction = words.word("a direction") if name != LOADINGS[0] else ""
    planes = {a + b for a in "XYZ" for b in "XYZ" if a != b}
    legal = {"TriaxialCompression": set("XYZ"), "SimpleShearDeformable": planes}.get(name)
    if legal and direction not in legal:
        raise Misread(f"there is no direction {direction!r}; there are: {', '.join(sorted(legal))}")
    pressure = words.real("the pressure")
    rate = words.real("the rate") if direction else 0.0
    return Loading(name, direction, pressure, rate, words.place)
