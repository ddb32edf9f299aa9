"""The periodic cell against the bodies in it: walls, control, whether its rims are felt."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from warpdem.checks.timestep import masses
from warpdem.errors import SceneError
from warpdem.features import surface_bodies
from warpdem.geometry.orientation import turned
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.input.scene_cell import Cell


ALONG = 1e-9
"""Sine of the angle by which a plane may lean against a periodic axis."""


class CellControl(NamedTuple):
    """How stresses drive the cell.

    Attributes:
        held: 1 for the components held at a stress, shape [3, 3].
        target: Those stresses, compression positive [Pa], shape [3, 3].
        inertia: M of M L' = V (stress - target) [kg m^2].
        damping: [1/s].
    """

    held: FloatArray
    target: FloatArray
    inertia: float
    damping: float


def cell_control(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> CellControl:
    """The stress control of a scene, its defaults filled in."""
    held, target = np.zeros((3, 3)), np.zeros((3, 3))
    cell = scene.cell
    if cell is None or not cell.stress.components():
        return CellControl(held, target, 1.0, 0.0)
    for (a, b), stress in cell.stress.components().items():
        held[a, b] = held[b, a] = 1.0
        target[a, b] = target[b, a] = stress
    own = cell_frequency(scene, placement, polyhedra)
    damping = own if cell.damping is None else cell.damping
    moment = _inertia(scene, placement, polyhedra) * float(np.prod(cell.size)) ** (2.0 / 3.0)
    return CellControl(held, target, moment, damping)


def _inertia(scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> float:
    mass = masses(placement, polyhedra)[0][~placement.fixed]
    return (scene.cell and scene.cell.inertia) or float(mass.sum())


def cell_frequency(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> float:
    """Own frequency of the cell on a packing of the stiffest contacts [1/s].

    sqrt(V^(1/3) kn / (2 r M)): a packing's modulus is about kn over the bodies' diameter 2 r.
    """
    if scene.cell is None or placement.fixed.all():
        return 0.0
    length = float(np.prod(scene.cell.size)) ** (1.0 / 3.0)
    bound = np.array([shape.bound for shape in polyhedra.values()])[placement.shape]
    radius = float(np.median((bound * placement.scale)[~placement.fixed]))
    stiffest = max((law.kn for law in scene.contact), default=0.0)
    mass = _inertia(scene, placement, polyhedra)
    return float(np.sqrt(length * stiffest / (2.0 * radius * mass)))


def spanning_axes(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> BoolArray:
    """Periodic axes along which a fixed body is at least as long as the cell.

    Such a body is a wall, the same everywhere along the axis, and has no images along it.

    Returns:
        Shape [body_count, 3].

    Raises:
        SceneError: Bodies near the boundary would feel a wall's rim.
    """
    spanning = np.zeros((len(placement.shape), 3), dtype=bool)
    cell = scene.cell
    if cell is None:
        return spanning
    shapes = list(polyhedra.values())
    bound = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    margin = bound[~placement.fixed].max(initial=0.0)
    size, centre = np.array(cell.size), np.array(cell.centre)
    surface = surface_bodies(placement, shapes)
    # no images: it is the same all along the axes
    spanning[surface] = cell.periodic
    problems = [
        problem_at(scene, ("cell", "periodic"), rule)
        for body in np.flatnonzero(surface)
        if (rule := _cut_surface(shapes[placement.shape[body]], placement, int(body), cell))
    ]
    for body in np.flatnonzero(placement.fixed & ~surface & (2.0 * bound >= size.min())):
        low, high = body_box(shapes[placement.shape[body]], placement, int(body))
        long = np.array(cell.periodic) & (high - low >= size * (1.0 - 1e-9))
        # where the search sees it: with its centre in the cell
        home = np.floor((placement.position[body] - centre) / size + 0.5) * long * size
        room = np.minimum(centre - 0.5 * size - (low - home), high - home - centre - 0.5 * size)
        spanning[body] = long
        for axis in np.flatnonzero(long & (room < margin)):
            rule = (
                f'"{placement.names[body]}" is as long as the periodic cell along {"xyz"[axis]} '
                f"and must reach beyond it by a body's radius, {margin:.4g} m, on both sides "
                f"(it does by {room[axis]:.4g} m), or bodies near the boundary feel its rim; "
                f"make it longer, or shorter than the cell"
            )
            problems.append(problem_at(scene, ("cell",), rule))
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    return spanning


def _cut_surface(shape: Polyhedron, placement: Placement, body: int, cell: Cell) -> str:
    """What is wrong with an analytic surface that is not the same all along the periodic axes."""
    assert shape.analytic
    own = turned(placement.orientation[body][None], np.array([[0.0, 0.0, 1.0]]))[0]
    periodic = np.array(cell.periodic)
    along = {"plane": np.abs(own) < ALONG, "cylinder": np.abs(own) > 1.0 - ALONG}
    bad = np.flatnonzero(periodic & ~along.get(shape.analytic.kind, np.zeros(3, dtype=bool)))
    if not len(bad):
        return ""
    axes = " and ".join("xyz"[axis] for axis in bad)
    return (
        f'the {shape.analytic.kind} "{placement.names[body]}" is not the same all along {axes}: '
        f"make the cell not periodic there"
    )


def body_box(shape: Polyhedron, placement: Placement, body: int) -> tuple[FloatArray, FloatArray]:
    """Upright box around a body, rounding included [m]."""
    turn = np.repeat(placement.orientation[body][None], len(shape.vertices), axis=0)
    corners = turned(turn, shape.vertices) * placement.scale[body] + placement.position[body]
    radius = shape.radius * placement.scale[body]
    return corners.min(axis=0) - radius, corners.max(axis=0) + radius
