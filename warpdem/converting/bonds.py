"""Glued bodies of a Rockable file as [[bond]]: one for each command and pair of groups."""

from __future__ import annotations

from collections import Counter
from itertools import combinations_with_replacement
from math import gamma, sqrt
from typing import TYPE_CHECKING, Any

from warpdem.checks.restitution import zeta_bilateral
from warpdem.converting.laws import dashpot, group_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.converting.conf import Command, Conf, Groups

STRENGTHS = {"fn0": "fn0", "ft0": "ft0", "mom0": "m0"}
"""Names of the strengths, there and here."""


def bonds(conf: Conf, *, accurate: bool) -> list[dict[str, Any]]:
    """What the commands that glue make, with the parameters of the tables."""
    spread = [command for command in conf.commands if command.name == "setVariableStickParams"]
    glue = [command for command in conf.commands if command not in spread]
    if glue and conf.law not in {"StickedLinks", "BCM"}:
        for command in glue:
            said = f"{command.name}: left out, forceLaw {conf.law} does not act on bonds"
            conf.note(command.place, said)
        return []
    made = [
        _bond(conf, command, pair, accurate=accurate)
        for command in glue
        for pair in _pairs(conf, command)
        if _has_stiffness(conf, command, pair)
    ]
    for command in spread:
        _spread(conf, made, command)
    if conf.law == "BCM" and made:
        said = "forceLaw BCM: each bond keeps the whole dashpot of an interface in the program"
        conf.note(conf.places.get("forceLaw"), said)
    return made


def _side(command: Command) -> str:
    return "Outer" if command.name == "stickClusters" else "Inner"


def _with_walls(conf: Conf, command: Command) -> bool:
    """Two of the commands never glue driven bodies."""
    moments = command.name in {"stickClusters", "stickVerticesInClustersMoments"}
    return conf.glue_walls and moments


def _pairs(conf: Conf, command: Command) -> list[Groups]:
    """Pairs of groups of which two bodies lie in one cluster, or in two."""
    first = 0 if _with_walls(conf, command) else conf.driven
    count = Counter((body.cluster, body.group) for body in conf.particles[first:])
    groups = sorted({group for _, group in count})
    found = _together if _side(command) == "Inner" else _apart
    return [(a, b) for a, b in combinations_with_replacement(groups, 2) if any(found(count, a, b))]


def _together(count: Counter[tuple[int, int]], a: int, b: int) -> Iterator[bool]:
    for cluster, group in count:
        if group == a:
            yield count[cluster, a] > 1 if a == b else count[cluster, b] > 0


def _apart(count: Counter[tuple[int, int]], a: int, b: int) -> Iterator[bool]:
    others = {cluster for cluster, group in count if group == b}
    for cluster, group in count:
        if group == a:
            yield bool(others - {cluster})


def _has_stiffness(conf: Conf, command: Command, pair: Groups) -> bool:
    key = f"kn{_side(command)}Bond"
    if (conf.pair(key, *pair) or 0.0) > 0.0:
        return True
    a, b = pair
    said = f"{command.name}: {key} {a} {b} is not given; bodies of these groups are not bonded"
    conf.note(command.place, said)
    return False


def _bond(conf: Conf, command: Command, pair: Groups, *, accurate: bool) -> dict[str, Any]:
    side = _side(command)
    values = {
        key: conf.pair(f"{key}{side}Bond", *pair)
        for key in ("kn", "kt", "kr", "en2", "fn0", "ft0", "mom0", "pow", "gc")
    }
    bond: dict[str, Any] = {
        "groups": [group_name(group) for group in pair],
        "between": side.lower(),
        "rule": "clusters" if side == "Outer" else "vertices",
        "tolerance": command.values[0],
        "walls": _with_walls(conf, command),
        "kn": values["kn"],
        "kt": values["kt"] or 0.0,
        "kr": values["kr"] or 0.0,
    }
    if side == "Outer" and not accurate:
        bond |= _contact_dashpot(conf, command, pair, bond["kn"])
    else:
        bond |= dashpot(values["en2"])
    if conf.law == "BCM":
        return bond | {"kr": 0.0, "share": True} | _toughness(conf, pair, side)
    return bond | _strengths(conf, command, pair)


def _contact_dashpot(conf: Conf, command: Command, pair: Groups, kn: float) -> dict[str, float]:
    """The program's bonds between clusters keep the dashpot of the contact they were."""
    a, b = pair
    en2 = conf.pair("en2Contact", a, b)
    if en2 == conf.pair("en2OuterBond", a, b):
        return dashpot(en2)
    said = f"{command.name}: its bonds damp as contacts do (en2Contact {a} {b}) in the program"
    conf.note(command.place, f"{said}, whatever en2OuterBond says")
    softer = (conf.pair("knContact", a, b) or 0.0) / kn
    if softer == 1.0 or (en2 or 0.0) >= 1.0:
        return dashpot(en2)
    zeta = zeta_bilateral(sqrt(en2)) if en2 and en2 > 0.0 else 1.0
    return {"damping_ratio": zeta * sqrt(softer)}


def _strengths(conf: Conf, command: Command, pair: Groups) -> dict[str, float]:
    """A strength the file lacks is 0 in the program: the bonds would break at once."""
    side = _side(command)
    found: dict[str, float] = {}
    missing = []
    for key, name in [*STRENGTHS.items(), ("pow", "power")]:
        value = conf.pair(f"{key}{side}Bond", *pair)
        if key == "mom0" and not conf.pair(f"kr{side}Bond", *pair):
            continue  # without stiffness there is no moment
        if value is not None and value > 0.0:
            found[name] = value
        else:
            missing.append(f"{key}{side}Bond {pair[0]} {pair[1]}")
    if missing:
        rule = f"{command.name} needs positive {', '.join(missing)}; without, bonds break at once"
        conf.fault(command.place, rule)
    return found


def _toughness(conf: Conf, pair: Groups, side: str) -> dict[str, float]:
    value = conf.pair(f"gc{side}Bond", *pair)
    if value is not None and value > 0.0:
        return {"gc": value}
    rule = f"BCM needs a positive gc{side}Bond {pair[0]} {pair[1]}; without, bonds break at once"
    conf.fault(conf.places.get("forceLaw"), rule)
    return {}


def _spread(conf: Conf, made: list[dict[str, Any]], command: Command) -> None:
    """A Weibull distribution of one parameter: its mean, and the modulus for all strengths."""
    name, side, scale, modulus = command.values
    assert isinstance(name, str)
    assert isinstance(scale, float)
    assert isinstance(modulus, float)
    mean = scale * gamma(1.0 + 1.0 / modulus)
    key = STRENGTHS.get(name, name)
    drawn = "other draws than the program's"
    if name in STRENGTHS:
        drawn += ", one factor an interface for all of its strengths"
    else:
        drawn = "its mean for all interfaces"
    conf.note(command.place, f"setVariableStickParams {name} {side}: {drawn}")
    for bond in made:
        if bond["between"] == side and (key != "m0" or bond["kr"]):
            bond[key] = mean
            if name in STRENGTHS:
                bond["weibull"] = {"modulus": modulus}
