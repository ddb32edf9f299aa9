"""What a Rockable file says, as the tables of a scene."""

from __future__ import annotations

import os.path
from math import hypot
from typing import TYPE_CHECKING, Any

from warpdem.converting.bonds import bonds
from warpdem.converting.cell import cell
from warpdem.converting.drivers import body_name, drivers
from warpdem.converting.laws import contacts, group_name
from warpdem.converting.words import SMALLEST
from warpdem.errors import GeometryError
from warpdem.geometry.shp import ShpItem, read_shp
from warpdem.input.suggestions import did_you_mean

if TYPE_CHECKING:
    from pathlib import Path

    from warpdem.converting.conf import Conf, Particle
    from warpdem.converting.driving import Driving

UNIT = 1e-6
"""How far from one a quaternion's length may be."""


def tables(conf: Conf, driving: Driving, folder: Path, *, accurate: bool) -> dict[str, Any]:
    """The scene; what cannot be brought or is wrong is told to ``conf``.

    Args:
        conf: The conf file.
        driving: What moves its driven bodies.
        folder: Where the scene will lie.
        accurate: The default numerics, rather than the program's.
    """
    library = _library(conf)
    bodies = [
        _body(conf, number, particle, library) for number, particle in enumerate(conf.particles)
    ]
    _number_clusters(conf, bodies)
    if not bodies:
        conf.fault(None, "holds no Particles")
    return {
        "title": f"{conf.path.resolve().parent.name}/{conf.path.name}, from Rockable",
        "run": _run(conf, accurate=accurate),
        "gravity": {"vector": list(conf.gravity)},
        "shape": _shapes(conf, library, folder),
        "group": _groups(conf),
        "contact": contacts(conf, bodies),
        **_some("bond", bonds(conf, accurate=accurate)),
        **_some("force", _forces(conf)),
        **_some("driver", drivers(conf, driving)),
        **_some("cell", cell(conf, driving)),
        "output": {"every": conf.numbers["interConf"]},
        "body": bodies,
    }


def _some(name: str, value: Any) -> dict[str, Any]:
    return {name: value} if value else {}


def _run(conf: Conf, *, accurate: bool) -> dict[str, Any]:
    dt, begin = conf.numbers["dt"], conf.numbers["t"]
    place = conf.places.get("tmax")
    if dt < SMALLEST:
        conf.fault(conf.places.get("dt"), f"dt should be positive, not {dt!r}")
        return {}
    if conf.numbers["tmax"] <= begin:
        conf.fault(place, f"tmax should lie after t = {begin!r}")
        return {}
    if begin:
        conf.note(conf.places["t"], f"t {begin!r}: time begins at 0 here; intervals are the same")
    whole = abs(conf.numbers["tmax"] - begin - conf.step_count * dt) < UNIT * dt
    run: dict[str, Any] = {
        "duration": conf.numbers["tmax"] - begin if whole else conf.step_count * dt,
        "dt": dt,
    }
    if conf.partnership != "None":
        run["partnership"] = conf.partnership.removesuffix("Weight").lower()
    if not accurate:
        run["compat"] = "rockable"
        if conf.numbers["dVerlet"] > 0.0:
            run["list_distance"] = conf.numbers["dVerlet"]
        if "interVerlet" in conf.places and conf.numbers["interVerlet"] > 1.5 * dt:
            said = f"interVerlet {conf.numbers['interVerlet']!r}: contacts may begin so much late"
            conf.note(conf.places["interVerlet"], f"{said} in the program; here they do not")
    return run


def _groups(conf: Conf) -> list[dict[str, Any]]:
    free = {particle.group: particle for particle in conf.particles[conf.driven :]}
    used = {particle.group for particle in conf.particles}
    made = []
    for group in sorted(used):
        density = conf.density.get(group, 0.0)
        if density > 0.0:
            made.append({"name": group_name(group), "density": density})
        elif group in free:
            rule = f"density {group} is missing or not positive; bodies of the group move"
            conf.fault(free[group].place, rule)
    return made


def _library(conf: Conf) -> dict[str, ShpItem]:
    """The shapes of the library the file names; empty when it cannot be read."""
    path = _shape_path(conf)
    if not conf.shape_file:
        conf.fault(None, "names no shapeFile")
        return {}
    try:
        return read_shp(path)
    except GeometryError as fault:
        conf.fault(conf.places["shapeFile"], f"shapeFile: {fault}")
        return {}


def _shape_path(conf: Conf) -> Path:
    """A library beside the conf file goes before one of the same name elsewhere."""
    folder = conf.path.parent
    beside = folder / conf.shape_file.replace("\\", "/").rpartition("/")[2]
    return beside if beside.is_file() else folder / conf.shape_file


def _shapes(conf: Conf, library: dict[str, ShpItem], folder: Path) -> list[dict[str, Any]]:
    file = os.path.relpath(_shape_path(conf).resolve(), folder.resolve()).replace(os.sep, "/")
    used = dict.fromkeys(particle.shape for particle in conf.particles)
    for name in used:
        if name in library and not library[name].precomputed:
            said = f'shape "{name}": its mass and axes are computed exactly, the library has none'
            conf.note(None, said)
    return [{"kind": "shp", "name": name, "file": file} for name in used if name in library]


def _body(
    conf: Conf, number: int, particle: Particle, library: dict[str, ShpItem]
) -> dict[str, Any]:
    driven = number < conf.driven
    if library and particle.shape not in library:
        hint = did_you_mean(particle.shape, library)
        conf.fault(particle.place, f"the library holds no shape {particle.shape!r}{hint}")
    if particle.homothety <= 0.0:
        conf.fault(particle.place, f"the homothety should be positive, not {particle.homothety!r}")
    body: dict[str, Any] = {
        "name": body_name(number),
        "shape": particle.shape,
        "group": group_name(particle.group),
        **({"fixed": True} if driven else {}),
        "cluster": particle.cluster,
        "scale": particle.homothety,
        "position": list(particle.position),
        "orientation": _unit(conf, particle),
        "velocity": list(particle.velocity),
        "spin": list(particle.spin),
    }
    if driven:
        _stop(conf, body, particle)
    neutral = {"cluster": 0, "scale": 1.0, "orientation": [1.0, 0.0, 0.0, 0.0]}
    neutral |= {"velocity": [0.0] * 3, "spin": [0.0] * 3}
    return {key: value for key, value in body.items() if neutral.get(key) != value}


def _number_clusters(conf: Conf, bodies: list[dict[str, Any]]) -> None:
    """Clusters are counted from 0 on: move them all up when some lie below."""
    lowest = min((particle.cluster for particle in conf.particles), default=0)
    if lowest < 0:
        conf.note(None, f"clusters are counted from 0 on here: {-lowest} is added to each")
        for body in bodies:
            body["cluster"] = body.get("cluster", 0) - lowest


def _stop(conf: Conf, body: dict[str, Any], particle: Particle) -> None:
    """A driven body of the program moves by controls alone."""
    for key in ("velocity", "spin"):
        if any(body[key]):
            said = f"its {key} is left out: driven bodies move by their drivers alone"
            conf.note(particle.place, f"{body['name']}: {said}")
            body[key] = [0.0, 0.0, 0.0]


def _unit(conf: Conf, particle: Particle) -> list[float]:
    length = hypot(*particle.orientation)
    if not length:
        conf.fault(particle.place, "the orientation is a quaternion of length 0")
        return [1.0, 0.0, 0.0, 0.0]
    if abs(length - 1.0) <= UNIT:
        return list(particle.orientation)
    conf.note(particle.place, f"the orientation had length {length!r} and is divided by it")
    return [part / length for part in particle.orientation]


def _forces(conf: Conf) -> list[dict[str, Any]]:
    numbers = conf.numbers
    made: list[dict[str, Any]] = []
    if numbers["numericalDampingCoeff"] > 0.0:
        damping = numbers["numericalDampingCoeff"]
        made.append({"kind": "numerical_damping", "coefficient": damping})
    barrier: dict[str, Any] = {}
    for key, name in (("velocity", "VelocityBarrier"), ("spin", "AngularVelocityBarrier")):
        if numbers[name] > 0.0:
            barrier |= {key: numbers[name], f"{key}_exponent": numbers[f"{name}Exponent"]}
    return made + ([{"kind": "velocity_barrier", **barrier}] if barrier else [])
