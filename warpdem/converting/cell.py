"""The periodic cell of a Rockable file and its loading, as [cell]."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from warpdem.converting.driving import AXES

if TYPE_CHECKING:
    from warpdem.converting.conf import Conf
    from warpdem.converting.driving import Driving, Loading

DIAGONAL = (0, 4, 8)


def cell(conf: Conf, driving: Driving) -> dict[str, Any]:
    """Size and loading of the cell; empty without one."""
    if not conf.numbers["usePeriodicCell"]:
        for key in ("h", *(loading.name for loading in driving.loadings)):
            if key in conf.cell or key != "h":
                conf.note(conf.places.get(key), f"{key}: left out, usePeriodicCell is not 1")
        return {}
    place = conf.places["usePeriodicCell"]
    size = [conf.cell.get("h", (0.0,) * 9)[k] for k in DIAGONAL]
    if min(size) <= 0.0:
        conf.fault(conf.places.get("h", place), "h: the cell needs three positive lengths")
    _note_lacking(conf)
    made: dict[str, Any] = {"size": size, "origin": [0.0, 0.0, 0.0], "periodic": [True] * 3}
    for loading in driving.loadings[:-1]:
        conf.note(loading.place, f"PeriodicLoading {loading.name}: left out, the last one counts")
    for loading in driving.loadings[-1:]:
        made |= _loaded(loading)
    return made


def _note_lacking(conf: Conf) -> None:
    """What of the program's cell has no place in the scene."""
    said = {
        "h": "h: a cell is upright here; its entries off the diagonal are left out",
        "vh": "vh: the cell's velocity at the start is left out; see strain_rate",
        "ah": "ah: the cell's acceleration at the start is left out",
        "mh": "mh: the cell's mass is left out; see cell.inertia",
        "dh": "dh: the cell's damping is left out; see cell.damping",
    }
    for key, values in conf.cell.items():
        counted = [v for k, v in enumerate(values) if key != "h" or k not in DIAGONAL]
        if any(counted):
            conf.note(conf.places.get(key), said[key])


def _loaded(loading: Loading) -> dict[str, Any]:
    """Stresses held, compression positive, and the gradient of velocity."""
    rate = [[0.0] * 3 for _ in range(3)]
    stress = {f"{axis}{axis}": loading.pressure for axis in AXES}
    if loading.name == "TriaxialCompression":
        axis = AXES.index(loading.direction.lower())
        rate[axis][axis] = loading.rate
        del stress[AXES[axis] * 2]
    elif loading.name == "SimpleShearDeformable":
        row, column = (AXES.index(letter) for letter in loading.direction.lower())
        rate[row][column] = loading.rate
    sheared = {"strain_rate": rate} if loading.direction else {}
    return {"stress": stress, **sheared}
