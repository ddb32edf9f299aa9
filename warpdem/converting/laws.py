"""Contact laws of a Rockable file as [[contact]]."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_references import meeting_groups

if TYPE_CHECKING:
    from warpdem.converting.conf import Conf, Groups

LAWS = {"Avalanche": "avalanche", "StickedLinks": "sticked_links", "BCM": "sticked_links"}
"""Names here of the laws that are not the default."""


def group_name(group: int) -> str:
    """What a group is called in the scene."""
    return f"g{group}"


def contacts(conf: Conf, bodies: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A law for each pair of groups that can meet."""
    if conf.law == "geoVisc":
        place = conf.places.get("forceLaw")
        conf.note(place, 'forceLaw geoVisc: not brought; the laws are "default", without viscT')
    elif conf.tables.get("viscTContact"):
        place = conf.places["viscTContact"]
        conf.note(place, f"viscTContact: of geoVisc alone, without effect with {conf.law}")
    numbers = {group_name(particle.group): particle.group for particle in conf.particles}
    pairs = [(numbers[a], numbers[b]) for a, b in meeting_groups({"body": bodies})]
    soft = [pair for pair in pairs if (conf.pair("knContact", *pair) or 0.0) <= 0.0]
    if soft:
        listed = ", ".join(f"{a} {b}" for a, b in soft)
        rule = "groups that can meet lack a positive knContact; they would pass through each other"
        conf.fault(None, f"{rule}: {listed}")
    return [_contact(conf, pair) for pair in pairs if pair not in soft]


def dashpot(en2: float | None) -> dict[str, float]:
    """Rockable's en2 as keys: from 1 on no dashpot, up to 0 a critical one."""
    if en2 is None or en2 <= 0.0:
        return {"damping_ratio": 1.0}
    return {"en2": min(en2, 1.0)}


def _contact(conf: Conf, pair: Groups) -> dict[str, Any]:
    values = {key: conf.pair(f"{key}Contact", *pair) for key in ("kt", "en2", "mu", "kr", "mur")}
    a, b = pair
    for key in ("kt", "en2", "mu"):
        if values[key] is None:
            conf.note(None, f"{key}Contact {a} {b}: not given; 0, as the program takes it")
    law: dict[str, Any] = {"groups": [group_name(a), group_name(b)]}
    if conf.law in LAWS:
        law["law"] = LAWS[conf.law]
    en2 = values["en2"]
    if conf.law == "Avalanche" and (en2 is None or en2 <= 0.0):
        rule = "Avalanche needs an energy kept by a rebound above 0"
        conf.fault(conf.places.get("en2Contact"), f"en2Contact {a} {b}: {rule}")
    law |= {"kn": conf.pair("knContact", *pair), "kt": values["kt"] or 0.0, **dashpot(en2)}
    law["mu"] = values["mu"] or 0.0
    if values["kr"]:
        law |= {"kr": values["kr"], "mur": values["mur"] or 0.0}
    elif values["mur"]:
        conf.note(None, f"murContact {a} {b}: without effect, krContact being 0; left out")
    return law
