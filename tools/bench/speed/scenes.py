"""Problems made: slightly disordered lattices in boxes; and as text of scene files."""

from __future__ import annotations

from math import ceil, sqrt
from typing import TYPE_CHECKING

import numpy as np

from speed.problem import Law, Problem, Solid, Wall

if TYPE_CHECKING:
    from collections.abc import Sequence

    from speed.problem import FloatArray

SEED = 20
UP = (0.0, 0.0, 1.0)
TURNS = {
    UP: (1.0, 0.0, 0.0, 0.0),
    (1.0, 0.0, 0.0): (sqrt(0.5), 0.0, sqrt(0.5), 0.0),
    (-1.0, 0.0, 0.0): (sqrt(0.5), 0.0, -sqrt(0.5), 0.0),
    (0.0, 1.0, 0.0): (sqrt(0.5), -sqrt(0.5), 0.0, 0.0),
    (0.0, -1.0, 0.0): (sqrt(0.5), sqrt(0.5), 0.0, 0.0),
}
"""Orientation of a plane's own z axis along each normal."""


def floor() -> tuple[Wall, ...]:
    """The plane z = 0."""
    return (Wall((0.0, 0.0, 0.0), UP),)


def box(width: float) -> tuple[Wall, ...]:
    """The plane z = 0 and four walls around [0, width]^2."""
    sides = [n for n in TURNS if n != UP]
    far = (width, width, 0.0)
    return (*floor(), *(Wall(far if min(n) < 0.0 else (0.0, 0.0, 0.0), n) for n in sides))


def lattice(columns: int, layers: int, pitch: float) -> FloatArray:
    """Centres of a cubic lattice on the corner of a box [m], shape [columns^2 layers, 3]."""
    x = np.arange(columns) + 0.5
    z, y, x = np.meshgrid(np.arange(layers) + 0.5, x, x, indexing="ij")
    return pitch * np.stack([x, y, z], axis=-1).reshape(-1, 3)


def _upright(count: int) -> FloatArray:
    return np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))


def layers_of(count: int, columns: int) -> int:
    """Layers that hold ``count`` bodies."""
    return ceil(count / columns**2)


def spheres(count: int, columns: int, *, name: str = "spheres") -> Problem:
    """Equal spheres of diameter .1 above the floor of a box, each off its site by up to 4 mm."""
    solid = Solid("sphere", 0.1, 0.05)
    pitch = 1.09 * solid.size
    sites = lattice(columns, layers_of(count, columns), pitch)[:count]
    away = np.random.default_rng(SEED).uniform(-0.004, 0.004, sites.shape)
    return Problem(name, solid, sites + away, _upright(count), box(columns * pitch))


def cubes(count: int, columns: int, *, name: str = "cubes") -> Problem:
    """Cubes of edge .1 above the floor of a box, in columns, each turned and shifted a little."""
    solid = Solid("cube", 0.1, 0.005)
    pitch = 1.25 * solid.size
    sites = lattice(columns, layers_of(count, columns), pitch)[:count]
    draw = np.random.default_rng(SEED)
    away = draw.uniform(-0.004, 0.004, sites.shape)
    turn = _small_turns(draw.uniform(-1.0, 1.0, (count, 3)) * [0.15, 0.15, 0.35])
    return Problem(name, solid, sites + away, turn, box(columns * pitch))


def _small_turns(rotation: FloatArray) -> FloatArray:
    """Quaternions of rotation vectors [rad], shape [count, 4]."""
    angle = np.linalg.norm(rotation, axis=1, keepdims=True)
    return np.concatenate([np.cos(angle / 2), np.sin(angle / 2) * rotation / angle], axis=1)


def octahedra(count: int, columns: int, *, name: str = "octahedra") -> Problem:
    """Octahedra of exaDEM's reference shape (size 1, r = .05) falling onto a plane."""
    solid = Solid("octahedron", 1.0, 0.05)
    sites = lattice(columns, layers_of(count, columns), 1.02 * solid.size)[:count]
    turn = np.random.default_rng(SEED).normal(size=(count, 4))
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    law = Law(kn=1e7, kt=8e6)
    return Problem(name, solid, sites, turn, floor(), law=law, dt=2e-4, density=1000.0)


def tower(count: int, columns: int, *, name: str = "cubes_to_rest") -> Problem:
    """Cubes of edge .1 in the air above a box, turned at random, as far apart as they are wide."""
    solid = Solid("cube", 0.1, 0.01)
    pitch = 2.02 * solid.bound
    sites = lattice(columns, layers_of(count, columns), pitch)[:count]
    turn = np.random.default_rng(SEED).normal(size=(count, 4))
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    return Problem(name, solid, sites, turn, box(columns * pitch))


def text(problem: Problem, *, law: str = "", extra: str = "", arithmetic: str = "fused") -> str:
    """The scene file of a problem; ``law`` is added to its contact laws, ``extra`` to its end."""
    grains = zip(problem.position.tolist(), problem.orientation.tolist(), strict=True)
    return "\n".join(
        [
            f'title = "{problem.name}"',
            f'run = {{duration = 100.0, dt = {problem.dt!r}, arithmetic = "{arithmetic}"}}',
            f"gravity = {{vector = {list(problem.gravity)}}}",
            "[output]\nenergy = false",
            f'[[group]]\nname = "grain"\ndensity = {problem.density!r}',
            '[[group]]\nname = "wall"',
            *(contact(problem.law, other, law) for other in ("grain", "wall")),
            _shape(problem.solid),
            '[[shape]]\nname = "plane"\nkind = "plane"',
            *(_wall(wall) for wall in problem.walls),
            *(_body("grain", place, turn) for place, turn in grains),
            extra,
        ]
    )


def contact(law: Law, other: str, more: str = "") -> str:
    """The law between the bodies and another group; ``more``: further lines of it."""
    return (
        f'[[contact]]\ngroups = ["grain", "{other}"]\nkn = {law.kn!r}\nkt = {law.kt!r}\n'
        f"en2 = {law.en2!r}\nmu = {law.mu!r}\n{more}"
    )


def _shape(solid: Solid) -> str:
    head = '[[shape]]\nname = "grain"\n'
    if solid.kind == "sphere":
        return f'{head}kind = "sphere"\nradius = {solid.rounding!r}'
    if solid.kind == "cube":
        return f'{head}kind = "box"\nsize = {[solid.size] * 3}\nrounding = {solid.rounding!r}'
    reach = 0.5 * solid.size - solid.rounding
    corners = [[s * reach * (k == axis) for k in range(3)] for axis in range(3) for s in (1, -1)]
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    return (
        f'{head}kind = "polyhedron"\nvertices = {corners}\nfaces = {faces}\n'
        f"rounding = {solid.rounding!r}"
    )


def _wall(wall: Wall) -> str:
    turn = TURNS[wall.normal]
    return _body("plane", wall.point, turn, group="wall") + "\nfixed = true"


def _body(
    shape: str, place: Sequence[float], turn: Sequence[float], *, group: str = "grain"
) -> str:
    return (
        f'[[body]]\nshape = "{shape}"\ngroup = "{group}"\n'
        f"position = {list(place)}\norientation = {list(turn)}"
    )
