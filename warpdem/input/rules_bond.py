"""Rules of [[bond]]: its keys fit together, and its groups exist."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, group_of, number, read, tables, text
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

STRENGTHS = ("fn0", "ft0", "m0", "gc", "gc_normal", "gc_tangential")
ENERGIES = ("gc", "gc_normal", "gc_tangential")


def bonds(scene: Any) -> Iterator[Fault]:
    """What each [[bond]] says fits together."""
    for index, bond in tables(scene, "bond"):
        path = ("bond", index)
        yield from _damping(bond, path)
        if number(bond, "m0") and not number(bond, "kr"):
            rule = "has no effect without kr > 0: the bonds carry no moment"
            yield Fault((*path, "m0"), read(bond, "m0"), rule)
        if number(bond, "ft0") and number(bond, "kt") == 0.0:
            yield Fault((*path, "ft0"), read(bond, "ft0"), "has no effect without kt > 0")
        if read(bond, "weibull") is not None and not any(number(bond, k) for k in STRENGTHS):
            rule = f"spreads strengths: give one of {', '.join(STRENGTHS)}"
            yield Fault((*path, "weibull"), None, rule)
        for key in ENERGIES:
            if number(bond, key) and text(bond, "rule") == "clusters":
                rule = 'a single bond has no area: use fn0, ft0, m0, or rule = "faces"'
                yield Fault((*path, key), read(bond, key), rule)


def _damping(bond: Any, path: tuple[str | int, ...]) -> Iterator[Fault]:
    ratio, en2 = number(bond, "damping_ratio"), number(bond, "en2")
    if ratio is not None and en2 is not None and en2 != 1.0:
        yield Fault((*path, "damping_ratio"), ratio, "leave out either damping_ratio or en2")


def bond_groups(scene: Any) -> Iterator[Fault]:
    """Bonds name groups there are."""
    known = {group_of(entry) for kind in ("body", "fill") for _, entry in tables(scene, kind)}
    known |= {text(group, "name") for _, group in tables(scene, "group")}
    names = sorted(name for name in known if name)
    for index, bond in tables(scene, "bond"):
        for place, name in enumerate(entries(bond, "groups")):
            if isinstance(name, str) and name not in known:
                rule = f"no group, body or fill uses this name{did_you_mean(name, names)}"
                yield Fault(("bond", index, "groups", place), name, rule)


RULES = (bonds, bond_groups)
