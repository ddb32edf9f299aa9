"""Reading Rockable's conf files: what follows each keyword.

The keywords are those of the program of 2026 (commit 2dc6dd5). The commands of its preparation
that have an outcome of their own (velocities, clones, sizes) are carried out while reading, as
there.
"""

from __future__ import annotations

from math import exp, pi, sqrt
from typing import TYPE_CHECKING

from warpdem.converting.bodies import ON_BODIES
from warpdem.converting.conf import DEFAULTS, Command, Conf, Particle
from warpdem.converting.words import Misread, Words, words_of
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

TABLES = (
    *(f"{key}Contact" for key in ("kn", "kt", "en2", "mu", "kr", "mur", "viscT")),
    *(
        f"{key}{kind}Bond"
        for kind in ("Inner", "Outer")
        for key in ("kn", "kt", "kr", "en2", "fn0", "ft0", "mom0", "pow", "gc")
    ),
)
"""Parameters of pairs of groups."""

UNUSED = {
    "DVerlet": 1,
    "parallel_mode": 1,
    "dynamicUpdateNL": 1,
    "dispUpdateNL": 1,
    "angleUpdateNL": 1,
    "AddOrRemoveInteractions": 1,
    "UpdateNL": 1,
    "cellMinSizes": 3,
    "boxForLinkCellsOpt": 1,
    "iconf": 1,
    "separator": 1,
    "precision": 1,
}
"""How the program lists neighbours, shares work and names files: no physics; values that follow."""

CELL = {"h": 9, "vh": 9, "ah": 9, "mh": 1, "dh": 1}
"""The periodic cell."""

ABSENT = {
    "preventCrossingLength": (1, "keeps bodies from passing through each other"),
    "initSpringJoint": (9, "a spring between points of two bodies"),
    "cellMomentumCorrection": (1, "drift of a periodic cell taken off now and then"),
    "cellVelocityCorrection": (1, "drift of a periodic cell taken off now and then"),
    "useKineticStress": (1, "which stress drives the periodic cell"),
    "useSoftParticles": (2, "bodies are rigid here"),
    "setStiffnessRatioInterfaces": (1, "the program itself does not know its command"),
    "randomlyOrientedVelocities": (1, "velocities drawn at random: write them into Particles"),
    "randomlyOrientedVelocitiesClusters": (2, "velocities drawn at random: write them out"),
}
"""Keywords without a counterpart: values that follow, and why or what they do."""

NAMED = {
    "BodyForce": {"AttractingPoint": 4, "PreferredDirection": 7, "ViscousFluid": 1},
    "DataExtractor": {
        "ClusterAABB": 3, "DuoBalance": 4, "MeanVelocity": 2, "TrackBody": 3, "TrackDamage": 2,
        "TrackRockfall": 5, "dnStat": 2,
    },
    "Tempo": {"NDCoeff": 5, "Inter": 8, "Body": 7},
}  # fmt: skip
"""Keywords without a counterpart that are followed by a kind, and how many values follow that."""

COMMANDS = {
    "stickVerticesInClusters": 1,
    "stickVerticesInClustersMoments": 1,
    "stickClusters": 1,
    "stickBCM": 1,
}
"""Commands that glue, followed by a distance."""

WIDEST = 0.5
"""Least modulus of a Weibull distribution: beyond, no bond is as strong as another."""


def read_conf(path: Path) -> Conf:
    """What a conf file says; what it says wrongly is in its ``problems``.

    Raises:
        SceneError: The file cannot be read, or is not Rockable's.
    """
    words = words_of(path)
    conf = Conf(path)
    if words.keyword() != "Rockable":
        conf.fault(words.place, "a conf file of Rockable begins with the word Rockable")
        return conf
    words.skip_line()  # the date of the format
    while key := words.keyword():
        conf.places.setdefault(key, words.place)
        try:
            _read(conf, key, words)
        except Misread as fault:
            conf.fault(words.place, f"{key}: {fault}")
            words.skip_line()
    return conf


def _read(conf: Conf, key: str, words: Words) -> None:
    if key in DEFAULTS:
        conf.numbers[key] = words.real(key)
    elif key in TABLES:
        pair, value = _pair(words), words.real("the value")
        conf.tables.setdefault(key, {})[pair] = value
    elif key in UNUSED:
        values = [words.word("a value") for _ in range(UNUSED[key])]
        conf.unused.append(" ".join([key, *values]))
    elif key in CELL:
        conf.cell[key] = words.vector("a component", CELL[key])
    elif key in COMMANDS:
        conf.commands.append(Command(key, (words.real("the distance"),), words.place))
    elif key in ABSENT:
        count, why = ABSENT[key]
        _absent(conf, words, [key], count, why)
    elif key in NAMED:
        _named(conf, key, words)
    elif key in ON_BODIES:
        ON_BODIES[key](conf, words)
    elif key in OTHERS:
        OTHERS[key](conf, words)
    else:
        known = [*DEFAULTS, *TABLES, *UNUSED, *CELL, *COMMANDS, *ABSENT, *NAMED, *OTHERS]
        raise Misread(f"no keyword of Rockable{did_you_mean(key, [*known, *ON_BODIES])}")


def _pair(words: Words) -> tuple[int, int]:
    first, second = words.count("the first group"), words.count("the second group")
    return min(first, second), max(first, second)


def _absent(conf: Conf, words: Words, said: list[str], count: int, why: str) -> None:
    place = words.place
    values = [words.word("a value") for _ in range(count)]
    conf.note(place, f"{' '.join([*said, *values])}: not brought ({why})")


def _named(conf: Conf, key: str, words: Words) -> None:
    kind = words.word("a name")
    if kind not in NAMED[key]:
        raise Misread(f"there is no {key} named {kind!r}; there are: {', '.join(NAMED[key])}")
    why = {
        "BodyForce": "gravity and drag are the forces on bodies here",
        "DataExtractor": "see [output] for tables; frames hold every body",
        "Tempo": "parameters do not change during a run",
    }[key]
    _absent(conf, words, [key, kind], NAMED[key][kind], why)


def _density(conf: Conf, words: Words) -> None:
    group = words.count("the group")
    conf.density[group] = words.real("the density")


def _gravity(conf: Conf, words: Words) -> None:
    conf.gravity = words.vector("a component of gravity")


def _rate(conf: Conf, words: Words) -> None:
    """Rockable takes exp(-pi z/sqrt(1 - z^2)) for the square of the restitution."""
    pair, ratio = _pair(words), words.real("the rate")
    if not 0.0 <= ratio < 1.0:
        raise Misread(f"the rate should lie from 0 to 1, not {ratio!r}")
    conf.tables.setdefault("en2Contact", {})[pair] = exp(-ratio * pi / sqrt(1.0 - ratio * ratio))


def _law(conf: Conf, words: Words) -> None:
    conf.law = words.word("the name of a law")
    known = ("Default", "Avalanche", "StickedLinks", "BCM", "geoVisc")
    if conf.law not in known:
        raise Misread(f"there is no law named {conf.law!r}; there are: {', '.join(known)}")


def _partnership(conf: Conf, words: Words) -> None:
    conf.partnership = words.word("a name")
    if conf.partnership not in {"None", "NumberWeight", "OverlapWeight"}:
        said = f"ContactPartnership {conf.partnership}"
        conf.note(words.place, f"{said}: does nothing in the program; left out")
        conf.partnership = "None"


def _integrator(conf: Conf, words: Words) -> None:
    name = words.word("a name")
    known = ("velocityVerlet", "Euler", "Beeman", "RungeKutta4")
    if name not in known:
        raise Misread(f"there is no integrator named {name!r}; there are: {', '.join(known)}")
    if name != "velocityVerlet":
        conf.note(words.place, f"Integrator {name}: not brought; velocity Verlet is the one here")


def _shape_file(conf: Conf, words: Words) -> None:
    conf.shape_file = words.word("the name of the shape file")


def _driven(conf: Conf, words: Words) -> None:
    conf.driven = words.count("nDriven")


def _glue(conf: Conf, words: Words) -> None:
    conf.glue_walls = words.word("yes or no") in {"yes", "YES", "y", "Y", "1"}


def _params(conf: Conf, words: Words) -> None:
    conf.numbers["ParamsInInterfaces"] = words.integer("0 or 1")


def _interactions(conf: Conf, words: Words) -> None:
    place, count = words.place, words.count("the number of interactions")
    for _ in range(count):
        for _ in range(5):
            words.integer("a number of a body or feature")
        words.vector("a component", 18)
    if count:
        said = f"{count} Interactions: their friction and moments are not brought"
        conf.note(place, f"{said}; contacts begin without a past")


def _interfaces(conf: Conf, words: Words) -> None:
    place, count = words.place, words.count("the number of interfaces")
    for _ in range(count):
        _, _, bonds = (words.count("a body or the number of bonds") for _ in range(3))
        words.real("dn0")
        if conf.numbers.get("ParamsInInterfaces") == 1:
            words.vector("a parameter", 8)
        for _ in range(3 * bonds):
            words.count("a feature")
    if count:
        said = f"{count} Interfaces: the bonds of a stored state are not brought"
        conf.note(place, f"{said}; write a [[bond]] that makes them anew")


def _copy_params(conf: Conf, words: Words) -> None:
    kind = _side(words)
    conf.note(words.place, f"copyParamsToInterfaces {kind}: changes nothing, left out")


def _variable(conf: Conf, words: Words) -> None:
    name = words.word("the name of a parameter")
    if name not in {"kn", "kt", "kr", "fn0", "ft0", "mom0"}:
        raise Misread(f"bonds have no {name!r}; there are: kn, kt, kr, fn0, ft0, mom0")
    side = _side(words)
    scale, modulus = words.real("lambda"), words.real("m")
    words.integer("0 or 1")
    if scale <= 0.0 or modulus < WIDEST:
        raise Misread(f"lambda should be positive and m at least {WIDEST}: {scale!r}, {modulus!r}")
    conf.commands.append(
        Command("setVariableStickParams", (name, side, scale, modulus), words.place)
    )


def _side(words: Words) -> str:
    return "inner" if words.word("inner or outer") == "inner" else "outer"


def _particles(conf: Conf, words: Words) -> None:
    left = words.count("the number of bodies")
    conf.particles.clear()
    while left > 0:
        name = words.word("a body")
        if name.startswith("#"):
            words.skip_line()
            continue
        left -= 1
        if name.startswith("!"):
            words.skip_line()
            continue
        conf.particles.append(_particle(name, words))


def _particle(name: str, words: Words) -> Particle:
    place = words.place
    group, cluster = words.count("the group"), words.integer("the cluster")
    homothety = words.real("the homothety")
    position, velocity = words.vector("the position"), words.vector("the velocity")
    words.vector("the acceleration")  # the program computes it anew, too
    orientation, spin = words.vector("the orientation", 4), words.vector("the spin")
    words.vector("the angular acceleration")
    return Particle(name, group, cluster, homothety, position, velocity, orientation, spin, place)


OTHERS: dict[str, Callable[[Conf, Words], None]] = {
    "density": _density,
    "gravity": _gravity,
    "en2ContactFromViscRate": _rate,
    "forceLaw": _law,
    "ContactPartnership": _partnership,
    "Integrator": _integrator,
    "shapeFile": _shape_file,
    "nDriven": _driven,
    "glue_with_walls": _glue,
    "ParamsInInterfaces": _params,
    "Particles": _particles,
    "Interactions": _interactions,
    "Interfaces": _interfaces,
    "copyParamsToInterfaces": _copy_params,
    "setVariableStickParams": _variable,
}
"""Keywords that are read each in its own way."""
