"""Rules on the keys of a contact law: what belongs to which law, and what excludes what."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, number, read, tables, text
from warpdem.input.scene_run import Run

if TYPE_CHECKING:
    from collections.abc import Iterator

CUSTOM_KEYS = ("file", "normal", "parameters")
WITHOUT_COMPAT = ("fc", "dncut", "gamma")


def _law(contact: Any) -> str:
    return text(contact, "law") or "default"


def dashpot(scene: Any) -> Iterator[Fault]:
    """A contact says how it damps, once, in the way its law can."""
    for index, contact in tables(scene, "contact"):
        en2, ratio = read(contact, "en2"), read(contact, "damping_ratio")
        law = _law(contact)
        path = ("contact", index, "en2")
        if law == "custom":
            continue
        if law == "avalanche" and ratio is not None:
            rule = 'law = "avalanche" has no dashpot; give en2'
            yield Fault(("contact", index, "damping_ratio"), ratio, rule)
        elif en2 is None and ratio is None:
            yield Fault(path, None, "missing: the energy kept by a rebound (or damping_ratio)")
        elif en2 is not None and ratio is not None:
            yield Fault(path, en2, "damping_ratio says the same: leave one of the two out")


def attraction(scene: Any) -> Iterator[Fault]:
    """An attraction that reaches has a strength."""
    cohesion = read(read(scene, "run"), "cohesion")
    for index, contact in tables(scene, "contact"):
        dncut = number(contact, "dncut")
        if dncut and not number(contact, "fc"):
            yield Fault(("contact", index, "dncut"), dncut, "has no effect without fc > 0")
        if dncut and cohesion == "documented" and _law(contact) in {"avalanche", "custom"}:
            rule = (
                f'cohesion = "documented" is a law with a dashpot, not law = "{_law(contact)}"; '
                'use cohesion = "exadem"'
            )
            yield Fault(("contact", index, "dncut"), dncut, rule)


def laws_of_their_own(scene: Any) -> Iterator[Fault]:
    """A custom law names its function and has all its stiffness; no other does."""
    partnership = read(read(scene, "run"), "partnership")
    for index, contact in tables(scene, "contact"):
        if _law(contact) == "custom":
            for key in ("file", "normal"):
                if read(contact, key) is None:
                    yield Fault(("contact", index, key), None, 'missing: law = "custom" needs it')
            if partnership not in {None, "auto", "sum"}:
                rule = 'a function of its own shares nothing: use run.partnership = "sum"'
                yield Fault(("contact", index, "law"), "custom", rule)
            for key in ("en2", "damping_ratio"):
                if read(contact, key) is not None:
                    rule = 'law = "custom" has no dashpot but its own; use parameters'
                    yield Fault(("contact", index, key), read(contact, key), rule)
            continue
        for key in CUSTOM_KEYS:
            if read(contact, key):
                rule = 'only with law = "custom"'
                yield Fault(("contact", index, key), read(contact, key), rule)


def programs(scene: Any) -> Iterator[Fault]:
    """The peers' programs lack some laws; p-norms have an exponent."""
    run = read(scene, "run")
    compat = read(run, "compat")
    if compat == "rockable":
        for index, contact in tables(scene, "contact"):
            for key in WITHOUT_COMPAT:
                if number(contact, key):
                    rule = 'Rockable\'s program has no cohesion: run it without compat = "rockable"'
                    yield Fault(("contact", index, key), number(contact, key), rule)
    exponent = number(run, "partnership_exponent")
    idle = read(run, "partnership") != "pnorm"
    if idle and exponent not in (None, Run.model_fields["partnership_exponent"].default):
        rule = 'only with partnership = "pnorm"'
        yield Fault(("run", "partnership_exponent"), exponent, rule)
