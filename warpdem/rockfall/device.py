"""A site and its rocks on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import warp as wp

from warpdem.kernels.contact_step import Parts
from warpdem.kernels.fall_views import (
    FOREST,
    SCREEN,
    TREE,
    GroundClasses,
    Obstacles,
    ResultGrid,
    Rocks,
    Rules,
    Terrain,
)
from warpdem.kernels.precision import wide, wide3
from warpdem.rockfall.nearby import around, cells_near

if TYPE_CHECKING:
    from collections.abc import Sequence

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.rockfall.flights import Method
    from warpdem.rockfall.rock import Rock
    from warpdem.rockfall.site import Barrier, Grid, Ground, Site, Trees

Pieces: TypeAlias = "tuple[FloatArray, FloatArray, IntArray]"
"""Both ends of straight pieces, shape [n, 2] each, and the barrier of each, shape [n]."""

TreeCells: TypeAlias = "tuple[IntArray, IntArray]"
"""First entry of each ground cell in the trunks, shape [cell_count + 1], and these, shape [n]."""

TRAVEL_CELLS = 16
"""Most cells of results that one pass goes along each axis."""


@dataclass(frozen=True, eq=False)
class Place:
    """What every trajectory of a site shares, as kernels see it."""

    parts: Parts
    terrain: Terrain
    rocks: Rocks
    classes: GroundClasses
    obstacles: Obstacles
    rules: Rules
    grid: ResultGrid
    vertex_room: int
    piece_count: int


def place_of(
    site: Site, rocks: Sequence[Rock], method: Method, device: Any, *, visits: bool, fused: bool
) -> Place:
    """Bring a site, its rocks and the method to a device."""
    pieces = _pieces(site.barriers)
    trees = _tree_cells(site.trees, site.ground.grid, rocks) if site.trees else None
    return Place(
        parts_of(site, rocks, method, visits=visits, fused=fused),
        _terrain(site, trees, pieces, device),
        _rocks(rocks, device),
        _classes(site, device),
        _obstacles(site, trees, pieces, device),
        _rules(site, method),
        _grid(site),
        max(len(rock.vertices) for rock in rocks),
        len(pieces[0]),
    )


def parts_of(
    site: Site, rocks: Sequence[Rock], method: Method, *, visits: bool, fused: bool
) -> Parts:
    """What the trajectories need compiled."""
    x, y, z = (float(part) for part in method.gravity)
    falls = x == y == 0.0 and z < 0.0
    return Parts(
        facets=site.ground.facets is not None,
        rounded=any(rock.rounding > 0.0 for rock in rocks),
        leine=method.gyroscope == "leine",
        scarring=any(kind.scar_modulus > 0.0 for kind in site.classes),
        forest=site.stand_of is not None,
        trees=site.trees is not None,
        screens=bool(site.barriers),
        visits=visits,
        lift=method.lift > 0.0,
        jumps=falls and method.skip == "jump",
        sphere=falls and method.skip != "none",
        fused=fused,
    )


def _terrain(site: Site, trees: TreeCells | None, pieces: Pieces, device: Any) -> Terrain:
    ground, grid = site.ground, site.ground.grid
    terrain = Terrain()
    terrain.x, terrain.y, terrain.cell = grid.x, grid.y, grid.cell
    terrain.per_metre = 1.0 / grid.cell
    terrain.rows, terrain.columns = grid.rows, grid.columns
    terrain.reach = ground.reach
    span = int(np.ceil(ground.reach / grid.cell - 1e-9))
    outside = np.pad(ground.known == 0, span, constant_values=True)
    unknown = around(outside, span)[span:-span, span:-span]
    # near the end of the known ground no flight is longer than a step
    terrain.steep = _reals(np.where(unknown, np.inf, ground.steep), device)
    terrain.known = _whole(ground.known, device)
    terrain.class_of = _whole(site.class_of, device)
    if ground.heights is not None:
        terrain.heights = _reals(ground.heights, device)
    if ground.facets is not None:
        _facets(terrain, ground, device)
    if site.stand_of is not None:
        terrain.stand_of = _whole(site.stand_of, device)
    near = np.zeros((grid.rows, grid.columns), np.int32)
    if site.stand_of is not None:
        near |= np.where(around(site.stand_of >= 0, span), int(FOREST), 0)
    if trees:
        found = (np.diff(trees[0]) > 0).reshape(near.shape)
        near |= np.where(around(found, span), int(TREE), 0)
    if site.barriers:
        seen = np.zeros_like(near, dtype=bool)
        for a, b in zip(*pieces[:2], strict=True):
            seen.ravel()[cells_near(grid, np.array([a, b]), ground.reach)] = True
        near |= np.where(seen, int(SCREEN), 0)
    terrain.near = _whole(near, device)
    return terrain


def _facets(terrain: Terrain, ground: Ground, device: Any) -> None:
    facets = ground.facets
    assert facets is not None
    corner = facets.points[facets.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    slope = -normal[:, :2] / normal[:, 2:]
    base = corner[:, 0, 2] - np.einsum("ij,ij->i", slope, corner[:, 0, :2])
    terrain.facet_start = _whole(facets.start, device)
    terrain.facet_member = _whole(facets.members, device)
    plan = np.ascontiguousarray(corner[:, :, :2])
    terrain.facet_corner = wp.array(plan, dtype=wp.vec2d, device=device)
    terrain.facet_plane = _vectors(np.column_stack([base, slope]), device)


def _rocks(rocks: Sequence[Rock], device: Any) -> Rocks:
    view = Rocks()
    view.vertex = _vectors(_padded([rock.vertices for rock in rocks]), device)
    view.vertex_count = _whole([len(rock.vertices) for rock in rocks], device)
    edges = _padded([rock.edges for rock in rocks]).astype(np.int32)
    view.edge = wp.array(edges, dtype=wp.vec2i, device=device)
    view.edge_count = _whole([len(rock.edges) for rock in rocks], device)
    view.skin = _vectors(_padded([rock.skin_points for rock in rocks]), device)
    facets = _padded([rock.skin_triangles for rock in rocks]).astype(np.int32)
    view.facet = wp.array(facets, dtype=wp.vec3i, device=device)
    view.facet_count = _whole([len(rock.skin_triangles) for rock in rocks], device)
    view.mass = _reals([rock.mass for rock in rocks], device)
    view.inertia = _vectors(np.array([rock.inertia for rock in rocks]), device)
    view.bound = _reals([rock.bound for rock in rocks], device)
    view.rounding = _reals([rock.rounding for rock in rocks], device)
    return view


def _classes(site: Site, device: Any) -> GroundClasses:
    view = GroundClasses()
    for name in ("mu_min", "mu_max", "kappa", "beta", "drag"):
        setattr(view, name, _reals([getattr(kind, name) for kind in site.classes], device))
    for name in ("restitution", "scar_modulus", "scar_drag"):
        setattr(view, name, _reals([getattr(kind, name) for kind in site.classes], device))
    return view


def _obstacles(site: Site, trees: TreeCells | None, pieces: Pieces, device: Any) -> Obstacles:
    view = Obstacles()
    if site.stand_of is not None:
        view.stand_drag = _reals([stand.drag for stand in site.stands], device)
        view.stand_height = _reals([stand.height for stand in site.stands], device)
    if site.trees is not None and trees:
        view.tree_start, view.tree_member = (_whole(part, device) for part in trees)
        trunks = np.column_stack([site.trees.position, site.trees.radius])
        view.tree = _vectors(trunks, device)
        view.tree_top = _reals(site.trees.top, device)
        view.tree_friction = _reals(site.trees.friction, device)
    if site.barriers:
        view.piece_from = wp.array(pieces[0], dtype=wp.vec2d, device=device)
        view.piece_to = wp.array(pieces[1], dtype=wp.vec2d, device=device)
        view.piece_barrier = _whole(pieces[2], device)
        view.barrier_height = _reals([barrier.height for barrier in site.barriers], device)
        view.barrier_capacity = _reals([barrier.capacity for barrier in site.barriers], device)
    return view


def _pieces(barriers: Sequence[Barrier]) -> Pieces:
    """Both ends of each straight piece of the barriers, and its barrier."""
    if not barriers:
        return np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, np.int32)
    owner = np.repeat(np.arange(len(barriers)), [len(barrier.line) - 1 for barrier in barriers])
    return (
        np.concatenate([barrier.line[:-1] for barrier in barriers]),
        np.concatenate([barrier.line[1:] for barrier in barriers]),
        owner.astype(np.int32),
    )


def _tree_cells(standing: Trees, grid: Grid, rocks: Sequence[Rock]) -> TreeCells:
    """The trunks that a rock above each cell of the ground may touch."""
    widest = max(rock.bound for rock in rocks)
    cells, trees = [], []
    for tree, (axis, radius) in enumerate(zip(standing.position, standing.radius, strict=True)):
        near = cells_near(grid, axis[None], widest + radius)
        cells.append(near)
        trees.append(np.full(len(near), tree))
    cell, tree = np.concatenate(cells), np.concatenate(trees)
    order = np.lexsort((tree, cell))
    start = np.searchsorted(cell[order], np.arange(grid.rows * grid.columns + 1))
    return start, tree[order]


def _rules(site: Site, method: Method) -> Rules:
    rules = Rules()
    rules.gravity = wp.vec3d(*method.gravity)
    for name in ("duration", "dt", "stride", "tolerance", "jump_angle", "lift", "slop"):
        setattr(rules, name, getattr(method, name))
    rules.sweeps, rules.accelerate_from = method.sweeps, method.accelerate_from
    rules.rest_time, rules.rest_move = method.rest_time, method.rest_move
    rules.travel = min(TRAVEL_CELLS * site.results.cell, site.ground.reach)
    rules.falling = float(np.sqrt(rules.travel / max(np.linalg.norm(method.gravity), 1e-9)))
    return rules


def _grid(site: Site) -> ResultGrid:
    view, grid = ResultGrid(), site.results
    view.x, view.y, view.cell = grid.x, grid.y, grid.cell
    view.per_metre = 1.0 / grid.cell
    view.rows, view.columns = grid.rows, grid.columns
    return view


def _padded(rows: Sequence[Any]) -> np.ndarray:
    """Arrays of different lengths as one, filled up with zeros."""
    longest = max(1, *(len(row) for row in rows))
    full = np.zeros((len(rows), longest, np.shape(rows[0])[1]))
    for target, row in zip(full, rows, strict=True):
        target[: len(row)] = row
    return full


def _reals(values: Any, device: Any) -> wp.array:
    return wp.array(np.ascontiguousarray(values, np.float64), dtype=wide, device=device)


def _whole(values: Any, device: Any) -> wp.array:
    return wp.array(np.ascontiguousarray(values, np.int32), dtype=wp.int32, device=device)


def _vectors(values: Any, device: Any) -> wp.array:
    return wp.array(np.ascontiguousarray(values, np.float64), dtype=wide3, device=device)
