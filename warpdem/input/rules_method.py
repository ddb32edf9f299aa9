"""Rules on what belongs to one method alone, smooth or non-smooth, and what a method needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.input.scene_reading import Fault, entries, number, numbers, read, tables, text
from warpdem.input.scene_run import Numerics, Run

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

ROCKFALL_TABLES = (
    "terrain",
    "terrain_class",
    "ground",
    "forest",
    "tree",
    "barrier",
    "rock",
    "release",
    "ensemble",
)
ROCKFALL_RUN = ("stride", "tolerance", "gyroscope", "skip", "lift")
ROCKFALL_OUTPUT = ("rasters", "cellsize", "formats", "trajectories", "trajectory_every", "map")
SMOOTH_TABLES = ("cell", "force", "driver", "bond")
SMOOTH_RUN = (
    *Numerics.model_fields,
    "precision",
    "adaptive_dt",
    "skin",
    "compat",
    "partnership",
    "partnership_exponent",
    "cohesion",
    "list_distance",
    "overlap",
    "relax",
    "energy_guard",
    "sleep",
)


def nonsmooth(scene: Any) -> bool:
    """Whether a scene is run by the non-smooth method."""
    return text(read(scene, "run"), "method") == "nonsmooth"


def _other(method: str) -> str:
    return f'only with run.method = "{method}"'


def smooth_alone(scene: Any) -> Iterator[Fault]:
    """The non-smooth method has no forces, drivers, bonds and periodic cells."""
    if not nonsmooth(scene):
        return
    for name in SMOOTH_TABLES:
        if read(scene, name):
            path = (name,) if name == "cell" else (name, 0)
            yield Fault(path, None, f"{_other('smooth')}: rocks meet nothing but the ground")
    yield from _chosen(scene, "run", SMOOTH_RUN, Run, "smooth")


def rockfall_alone(scene: Any) -> Iterator[Fault]:
    """The smooth method has no releases, classes of ground and ensembles."""
    if text(read(scene, "run"), "method") not in {None, "smooth"}:
        return
    from warpdem.input.scene import Output  # noqa: PLC0415 - the scene is checked by these rules
    from warpdem.input.scene_rockfall import Ensemble  # noqa: PLC0415 - beside its neighbour

    for name in ROCKFALL_TABLES:
        value = read(scene, name)
        if value and value != Ensemble():
            path = (
                (name, 0) if entries(scene, name) and isinstance(value, list | tuple) else (name,)
            )
            yield Fault(path, None, _other("nonsmooth"))
    yield from _chosen(scene, "run", ROCKFALL_RUN, Run, "nonsmooth")
    yield from _chosen(scene, "output", ROCKFALL_OUTPUT, Output, "nonsmooth")


def _chosen(scene: Any, name: str, keys: Sequence[str], model: Any, method: str) -> Iterator[Fault]:
    """Keys of a section that differ from their defaults."""
    for key in keys:
        value, default = read(read(scene, name), key), model.model_fields[key].default
        plain = tuple(value) if isinstance(value, list) else value
        if value is not None and plain != default:
            yield Fault((name, key), value, _other(method))


def _terrains(scene: Any) -> dict[str, Any]:
    """Shapes that are terrains, by name."""
    return {
        name: shape
        for _, shape in tables(scene, "shape")
        if text(shape, "kind") == "terrain" and (name := text(shape, "name"))
    }


def ground(scene: Any) -> Iterator[Fault]:
    """Rocks fall on one ground: [terrain], or a fixed body that is one."""
    if not nonsmooth(scene):
        return
    terrains = _terrains(scene)
    bodies = [k for k, body in tables(scene, "body") if text(body, "shape") in terrains]
    own = read(scene, "terrain") is not None
    if not own and not bodies:
        rule = 'missing: the ground, or a fixed [[body]] whose shape is of kind = "terrain"'
        yield Fault(("terrain",), None, rule)
    for index in bodies if own else bodies[1:]:
        rule = "there is another ground already: " + ("[terrain]" if own else f"body[{bodies[0]}]")
        yield Fault(("body", index, "shape"), text(scene_body(scene, index), "shape"), rule)
    for name in ("ground", "terrain_class"):
        if not own and bodies and entries(scene, name):
            rule = "needs [terrain]: the ground is a body, and [[contact]] says how it acts"
            yield Fault((name, 0), None, rule)
    for index in bodies:
        yield from _level(scene_body(scene, index), index)
    for index, shape in tables(scene, "shape"):
        if text(shape, "name") in terrains and number(shape, "rounding"):
            rule = f'{_other("smooth")}: the ground of run.method = "nonsmooth" has no rounding'
            yield Fault(("shape", index, "rounding"), read(shape, "rounding"), rule)


def scene_body(scene: Any, index: int) -> Any:
    """One [[body]] of a scene."""
    return entries(scene, "body")[index]


def _level(body: Any, index: int) -> Iterator[Fault]:
    """A terrain body rests, neither turned nor scaled."""
    still = {"orientation": [1.0, 0.0, 0.0, 0.0], "velocity": [0.0] * 3, "spin": [0.0] * 3}
    for key, value in still.items():
        said = numbers(body, key, len(value))
        if said is not None and said != value:
            rule = 'the ground of run.method = "nonsmooth" rests as its file has it: leave this out'
            yield Fault(("body", index, key), said, rule)
    if number(body, "scale") not in {None, 1.0}:
        rule = 'the ground of run.method = "nonsmooth" is as large as its file says'
        yield Fault(("body", index, "scale"), number(body, "scale"), rule)


def rocks(scene: Any) -> Iterator[Fault]:
    """Something falls: releases on a [terrain], or free bodies."""
    if not nonsmooth(scene):
        return
    free = [k for k, body in tables(scene, "body") if read(body, "fixed") in (None, False)]
    fills = [k for k, _ in tables(scene, "fill")]
    releases = [k for k, _ in tables(scene, "release")]
    if not (free or fills or releases):
        yield Fault(("release",), None, "missing: where rocks start, or a free [[body]]")
    if releases and (free or fills):
        path = ("body", free[0]) if free else ("fill", fills[0])
        rule = "falls beside [[release]]: leave out the free bodies or the releases"
        yield Fault(path, None, rule)
    if releases and read(scene, "terrain") is None:
        rule = "needs [terrain], which says of what class the ground is"
        yield Fault(("release", releases[0]), None, rule)
    if not releases and (count := read(read(scene, "ensemble"), "count")) is not None:
        rule = "only with [[release]]: every free body is one trajectory"
        yield Fault(("ensemble", "count"), count, rule)
    yield from _obstacles(scene)


def _obstacles(scene: Any) -> Iterator[Fault]:
    terrains = _terrains(scene)
    for index, body in tables(scene, "body"):
        if read(body, "fixed") is True and text(body, "shape") not in terrains:
            rule = 'rocks of run.method = "nonsmooth" meet no bodies: give trees, barriers, or none'
            yield Fault(("body", index, "fixed"), True, rule)


def lift_with_weight(scene: Any) -> Iterator[Fault]:
    """What a rock is lifted costs it potential energy, which there must be."""
    lift = number(read(scene, "run"), "lift")
    if nonsmooth(scene) and lift and numbers(read(scene, "gravity"), "vector", 3) == [0.0] * 3:
        rule = "needs gravity, against which a rock is lifted: set gravity.vector, or leave it out"
        yield Fault(("run", "lift"), lift, rule)


METHOD_RULES = (smooth_alone, rockfall_alone, ground, rocks, lift_with_weight)
