"""Rules on the names by which the parts of a scene refer to one another."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, Path, entries, group_of, number, read, tables, text
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


_NAMED = ("shape", "group", "body", "fill", "bond", "terrain_class", "barrier")


def unique_names(scene: Any) -> Iterator[Fault]:
    """One thing of a kind bears a name."""
    for kind in _NAMED:
        first: dict[str, int] = {}
        for index, entry in tables(scene, kind):
            name = text(entry, "name")
            if name and first.setdefault(name, index) != index:
                rule = f"already the name of {kind}[{first[name]}]"
                yield Fault((kind, index, "name"), name, rule)


def known_shapes(scene: Any) -> Iterator[Fault]:
    """Bodies and fills name shapes there are."""
    names = sorted({name for _, shape in tables(scene, "shape") if (name := text(shape, "name"))})
    wanted: dict[str, list[Path]] = defaultdict(list)
    for index, body in tables(scene, "body"):
        wanted[text(body, "shape") or ""].append(("body", index, "shape"))
    for index, fill in tables(scene, "fill"):
        for place, name in enumerate(entries(fill, "shapes")):
            if isinstance(name, str):
                wanted[name].append(("fill", index, "shapes", place))
    for name in sorted(wanted.keys() - {*names, ""}):
        path, *others = wanted[name]
        hint = did_you_mean(name, names) or f"; there are: {', '.join(names[:12]) or 'none'}"
        yield Fault(path, name, f"no shape has this name{hint}{_more(others)}")


def _more(others: Sequence[Any]) -> str:
    return f" (and {len(others)} more alike)" if others else ""


def densities(scene: Any) -> Iterator[Fault]:
    """Every free body has a density, its own or its group's."""
    dense = {
        name
        for _, group in tables(scene, "group")
        if (name := text(group, "name")) and read(group, "density") is not None
    }
    lacking: dict[str, list[Path]] = defaultdict(list)
    for kind in ("body", "fill"):
        for index, entry in tables(scene, kind):
            free = read(entry, "fixed") in (None, False)
            if free and read(entry, "density") is None and (group := group_of(entry)):
                lacking[group].append((kind, index))
    for group in sorted(lacking.keys() - dense):
        path, *others = lacking[group]
        yield Fault(
            (*path, "density"),
            None,
            f'missing: what moves needs a density [kg/m^3] here or in a [[group]] named "{group}"'
            + did_you_mean(group, dense)
            + _more(others),
        )


def terrain_stands(scene: Any) -> Iterator[Fault]:
    """A terrain has no mass: it is only for fixed bodies."""
    terrains = {
        text(shape, "name")
        for _, shape in tables(scene, "shape")
        if text(shape, "kind") == "terrain"
    } - {None}
    for index, body in tables(scene, "body"):
        if text(body, "shape") in terrains and read(body, "fixed") in (None, False):
            rule = "a terrain has no mass: give the body fixed = true"
            yield Fault(("body", index, "shape"), read(body, "shape"), rule)
    for index, fill in tables(scene, "fill"):
        for place, name in enumerate(entries(fill, "shapes")):
            if isinstance(name, str) and name in terrains:
                yield Fault(("fill", index, "shapes", place), name, "a terrain cannot be strewn")


def _population(scene: Any) -> dict[str, tuple[int, int]]:
    """Numbers of free and of fixed bodies by group; a fill counts as two at most."""
    free: dict[str, int] = defaultdict(int)
    fixed: dict[str, int] = defaultdict(int)
    for _, body in tables(scene, "body"):
        if group := group_of(body):
            (fixed if read(body, "fixed") is True else free)[group] += 1
    for _, fill in tables(scene, "fill"):
        if group := group_of(fill):
            free[group] += 1 if number(fill, "count") == 1 else 2
    return {group: (free[group], fixed[group]) for group in sorted(free.keys() | fixed.keys())}


def meeting_groups(scene: Any) -> list[tuple[str, str]]:
    """Pairs of groups of which two bodies, not both fixed, exist; each pair once, sorted.

    In a periodic cell a body may meet its own image.
    """
    population = _population(scene)
    alone = 1 if read(scene, "cell") is None else 0
    names = list(population)
    return [
        (a, b)
        for place, a in enumerate(names)
        for b in names[place:]
        if (population[a][0] or population[b][0]) and (a != b or sum(population[a]) > alone)
    ]


def contact_pairs(scene: Any) -> Iterator[Fault]:
    """Groups that can meet have one contact law; contacts name groups there are."""
    known = {*_population(scene)} | {text(group, "name") for _, group in tables(scene, "group")}
    names = sorted(name for name in known if name)
    first: dict[frozenset[str], int] = {}
    readable = True
    for index, contact in tables(scene, "contact"):
        pair = [name for name in entries(contact, "groups") if isinstance(name, str)]
        readable = readable and len(pair) == 2
        for place, name in enumerate(pair):
            if name not in known:
                rule = f"no group, body or fill uses this name{did_you_mean(name, names)}"
                yield Fault(("contact", index, "groups", place), name, rule)
        if len(pair) == 2 and first.setdefault(frozenset(pair), index) != index:
            rule = f"contact[{first[frozenset(pair)]}] is for these groups already"
            yield Fault(("contact", index, "groups"), pair, rule)
    missing = [pair for pair in meeting_groups(scene) if frozenset(pair) not in first]
    alone = read(read(scene, "run"), "method") == "nonsmooth"  # bodies do not meet one another
    if missing and readable and not alone:
        listed = ", ".join(f'["{a}", "{b}"]' for a, b in missing[:12])
        more = f" and {len(missing) - 12} more" if len(missing) > 12 else ""
        yield Fault(("contact",), None, f"groups that can meet lack a [[contact]]: {listed}{more}")
