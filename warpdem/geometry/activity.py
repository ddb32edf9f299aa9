"""Edges of a surface, and which vertices and edges can touch another body."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.core import Core
    from warpdem.geometry.facets import Facets

FLAT = 1e-6  # rad: facets at a smaller angle count as one plane


def borders(facets: Facets) -> IntArray:
    """The segments along which facets end, each once, sorted; shape [edge_count, 2]."""
    pairs = np.sort(facets.sides, axis=1)
    return _unique_pairs(pairs)


def _unique_pairs(pairs: IntArray) -> IntArray:
    if not len(pairs):
        return np.zeros((0, 2), np.int64)
    key = np.unique(pairs[:, 0].astype(np.int64) * (int(pairs.max()) + 1) + pairs[:, 1])
    return np.column_stack(np.divmod(key, int(pairs.max()) + 1))


def side_of_edges(edges: IntArray, facets: Facets) -> IntArray:
    """A side of a facet along each edge, or -1; shape [edge_count]."""
    if not len(facets.sides) or not len(edges):
        return np.full(len(edges), -1)
    base = int(max(facets.sides.max(), edges.max())) + 1
    wanted = np.sort(edges.astype(np.int64), axis=1) @ np.array([base, 1])
    keys = np.sort(facets.sides.astype(np.int64), axis=1) @ np.array([base, 1])
    order = np.argsort(keys, kind="stable")
    place = np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)
    return np.where(keys[order[place]] == wanted, order[place], -1)


def active_edges(core: Core, edges: IntArray) -> BoolArray:
    """Edges that stick out: not flat, and of closed surfaces not concave; shape [edge_count]."""
    side = side_of_edges(edges, core.facets)
    angle = np.where(side < 0, np.pi, np.append(core.side_angles, 0.0)[side])
    return angle > FLAT if core.closed else np.abs(angle) > FLAT


def active_vertices(count: int, edges: IntArray, edge_active: BoolArray) -> BoolArray:
    """Vertices with an active edge or with no edge at all; shape [count]."""
    active = np.ones(count, bool)
    active[edges] = False
    active[edges[edge_active]] = True
    return active


def terrain_edges(core: Core, edges: IntArray) -> BoolArray:
    """Edges of a terrain that stick out: convex ones and borders; shape [edge_count]."""
    return core.side_angles[side_of_edges(edges, core.facets)] > FLAT


def terrain_cones(core: Core, edges: IntArray) -> tuple[IntArray, FloatArray]:
    """Cones of directions in which features of a terrain are its nearest points.

    The planes of an edge are its facets' side vectors in their planes, away from them; those of a
    vertex the directions of its edges, reversed. On the border the facets' normals join them, so
    that the ground is touched from above only.

    Returns:
        First plane of each vertex, then each edge, shape [vertex_count + edge_count + 1], and the
        planes, shape [plane_count, 3].
    """
    count = len(core.vertices)
    normals = core.normals[core.facets.owner]
    outward = np.cross(core.side_directions, normals)
    side = side_of_edges(edges, core.facets)
    other = core.twin[side]
    second = np.where((other < 0)[:, None], normals[side], outward[other])
    at, planes = _vertex_planes(core, edges, normals)
    length = np.bincount(at, minlength=count)
    start = np.concatenate([[0], np.cumsum(np.append(length, np.full(len(edges), 2)))])
    of_edges = np.stack([outward[side], second], axis=1).reshape(-1, 3)
    return start, np.concatenate([planes, of_edges])


def _vertex_planes(core: Core, edges: IntArray, normals: FloatArray) -> tuple[IntArray, FloatArray]:
    """Vertex and vector of each plane of the vertex cones, sorted by vertex."""
    along = core.vertices[edges[:, 1]] - core.vertices[edges[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    border = core.twin < 0
    at = np.concatenate(
        [edges[:, 0], edges[:, 1], core.facets.sides[border, 0], core.facets.sides[border, 1]]
    )
    planes = np.concatenate([-along, along, normals[border], normals[border]])
    order = np.argsort(at, kind="stable")
    return at[order], planes[order]
