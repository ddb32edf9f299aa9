"""Shapes as the device reads them: features of all shapes in one array each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.errors import CapacityError
from warpdem.kernels.codes import BALL, CYLINDER, FEATURE_LIMIT, PLANE
from warpdem.kernels.precision import real, vec3, vec4
from warpdem.kernels.regions import TIE
from warpdem.kernels.views import Geometry
from warpdem.model import on

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.polyhedron import Polyhedron

# neighbouring faces whose normals differ by less are one plane: they share one border half-space
FLAT = 1e-7
# faces times sides of a non-convex solid above which no thickness is looked for (some 4 s)
THICKNESS_LIMIT = 400_000_000
SURFACES = {"plane": int(PLANE), "cylinder": int(CYLINDER), "ball": int(BALL)}


def shape_arrays(
    shapes: list[Polyhedron], with_tree: BoolArray, device: Any, *, once: bool = False
) -> tuple[Geometry, tuple[wp.Bvh, ...]]:
    """Features of all shapes on a device, and the trees over some, shape [shape_count].

    ``once``: what lies beside edges and vertices too.
    """
    for shape in shapes:
        if max(len(shape.vertices), len(shape.edges), len(shape.face_offsets)) >= FEATURE_LIMIT:
            raise CapacityError(f'shape "{shape.name}" has more than {FEATURE_LIMIT} features')
    geometry = Geometry()
    _starts(geometry, shapes, device)
    _features(geometry, shapes, device)
    _sides(geometry, shapes, device, reach=TIE if once else 0.0)
    _cones(geometry, shapes, device)
    if once:
        _neighbours(geometry, shapes, device)
    analytic = [shape.analytic for shape in shapes]
    kinds = np.array([SURFACES[a.kind] if a else 0 for a in analytic], np.int32)
    geometry.surface = on(device, kinds, wp.int32)
    geometry.surface_radius = on(device, np.array([a.radius if a else 0.0 for a in analytic]), real)
    ids = np.zeros(len(shapes), dtype=np.uint64)
    trees = []
    for k in np.flatnonzero(with_tree):
        tree = feature_tree(shapes[k], device)
        trees.append(tree)
        ids[k] = tree.id
    geometry.tree = on(device, ids, wp.uint64)
    return geometry, tuple(trees)


def _starts(geometry: Geometry, shapes: list[Polyhedron], device: Any) -> None:
    def running(counts: list[int]) -> wp.array:
        return on(device, np.concatenate([[0], np.cumsum(counts)]).astype(np.int32), wp.int32)

    geometry.vertex_start = running([len(shape.vertices) for shape in shapes])
    geometry.edge_start = running([len(shape.edges) for shape in shapes])
    geometry.face_start = running([len(shape.face_offsets) for shape in shapes])


def _join(parts: list[Any], dtype: Any, width: int = 0) -> np.ndarray:
    """One array of all parts, of one spare row when there is none: kernels take no empty ones."""
    shape = (0, width) if width else (0,)
    spare = np.zeros(shape, dtype=dtype)
    rows = np.concatenate(
        [spare, *(np.asarray(p, dtype=dtype).reshape(-1, *shape[1:]) for p in parts)]
    )
    return rows if len(rows) else np.zeros((1, *shape[1:]), dtype=dtype)


def _features(geometry: Geometry, shapes: list[Polyhedron], device: Any) -> None:
    middle = [0.5 * (shape.core_min + shape.core_max) for shape in shapes]
    half = [0.5 * (shape.core_max - shape.core_min) for shape in shapes]
    geometry.core_middle = on(device, np.array(middle), vec3)
    geometry.core_half = on(device, np.array(half), vec3)
    two_sided = np.array([s.two_sided for s in shapes], dtype=np.int32)
    geometry.two_sided = on(device, two_sided, wp.int32)
    geometry.vertex = on(device, _join([s.vertices for s in shapes], np.float64, 3), vec3)
    active = _join([s.vertex_active for s in shapes], np.int32)
    geometry.vertex_active = on(device, active, wp.int32)
    geometry.edge = on(device, _join([s.edges for s in shapes], np.int32, 2), wp.vec2i)
    geometry.edge_active = on(device, _join([s.edge_active for s in shapes], np.int32), wp.int32)
    ends = [s.vertices[s.edges].reshape(-1, 2, 3) for s in shapes]
    half = [0.5 * np.linalg.norm(e[:, 1] - e[:, 0], axis=1) for e in ends]
    geometry.edge_half = on(device, _join(half, np.float64), real)
    geometry.normal = on(device, _join([s.face_normals for s in shapes], np.float64, 3), vec3)
    geometry.offset = on(device, _join([s.face_offsets for s in shapes], np.float64), real)
    geometry.depth = on(device, _join([_depths(s) for s in shapes], np.float64), real)
    solid = [2 if s.closed and s.convex else 1 for s in shapes]
    faces = [k * s.face_convex.astype(np.int32) for k, s in zip(solid, shapes, strict=True)]
    convex = _join(faces, np.int32)
    geometry.face_convex = on(device, convex, wp.int32)


def _depths(shape: Polyhedron) -> FloatArray:
    """How far behind each face a vertex still belongs to it [m], shape [face_count].

    Half the thickness of the solid there; half the shortest side where there is none.
    """
    faces = len(shape.face_offsets)
    if shape.two_sided or faces == 0:
        return np.zeros(faces)
    if shape.closed and shape.convex:
        lowest = np.array([(shape.vertices @ normal).min() for normal in shape.face_normals])
        return 0.5 * (shape.face_offsets - lowest)
    ends = shape.vertices[shape.side_vertices]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    shortest = 0.5 * np.minimum.reduceat(length, shape.side_start[:-1])
    if shape.closed and faces * len(ends) <= THICKNESS_LIMIT:
        return 0.5 * _thickness(shape, ends[:, 0])
    return shortest


def _thickness(shape: Polyhedron, corners: FloatArray) -> FloatArray:
    """Distance behind each face to the nearest face that looks the other way [m].

    Whole faces count, also where they do not lie under the face: the wall of a cup must not reach
    into its hollow.
    """
    extent = float(np.linalg.norm(shape.core_max - shape.core_min))
    thickness = np.empty(len(shape.face_offsets))
    for face, (normal, offset) in enumerate(
        zip(shape.face_normals, shape.face_offsets, strict=True)
    ):
        below = offset - np.maximum.reduceat(corners @ normal, shape.side_start[:-1])
        facing = (shape.face_normals @ normal < 0.0) & (below > 1e-9 * extent)
        lowest = offset - float((shape.vertices @ normal).min())
        thickness[face] = min(lowest, float(below[facing].min(initial=extent)))
    return thickness


def _sides(geometry: Geometry, shapes: list[Polyhedron], device: Any, *, reach: float) -> None:
    """``reach``: part of a shape's size by which convex faces reach over their borders."""
    above, below, shared, starts = [], [], [], [np.zeros(1, np.int64)]
    total = 0
    for shape in shapes:
        over, under, tie = side_planes(shape)
        over[:, 3] += reach * shape.bound * _bent(shape)
        above.append(over)
        below.append(under)
        shared.append(tie)
        starts.append(np.asarray(shape.side_start[1:], np.int64) + total)
        total += len(over)
    geometry.side_start = on(device, np.concatenate(starts).astype(np.int32), wp.int32)
    geometry.side_above = on(device, _join(above, np.float64, 4), vec4)
    geometry.side_below = on(device, _join(below, np.float64, 4), vec4)
    geometry.side_open = on(device, _join(shared, np.int32), wp.int32)
    vertices = _join([s.side_vertices for s in shapes], np.int32, 2)
    geometry.side_vertex = on(device, vertices, wp.vec2i)


def _neighbours(geometry: Geometry, shapes: list[Polyhedron], device: Any) -> None:
    """Sides of faces along each edge; edges at each vertex, and its two sides of each face."""
    sides, spokes, spoke_counts, corners, corner_counts, total = [], [], [], [], [], 0
    for shape in shapes:
        count = len(shape.vertices)
        found = edge_sides(shape)
        sides.append(np.where(found >= 0, found + total, -1))
        ends = np.asarray(shape.edges, np.int64).reshape(-1)
        spokes.append(np.argsort(ends, kind="stable") // 2)
        spoke_counts.append(np.bincount(ends, minlength=count))
        at = np.asarray(shape.side_vertices, np.int64).reshape(-1, 2)[:, 1]
        order = np.argsort(at, kind="stable")
        onward = shape.facets.following if len(at) else at
        corners.append(np.column_stack([order, onward[order]]) + total)
        corner_counts.append(np.bincount(at, minlength=count))
        total += len(at)
    geometry.edge_sides = on(device, _join(sides, np.int32, 2), wp.vec2i)
    geometry.spoke_start = on(device, _starting(spoke_counts), wp.int32)
    geometry.spoke = on(device, _join(spokes, np.int32), wp.int32)
    geometry.corner_start = on(device, _starting(corner_counts), wp.int32)
    geometry.corner = on(device, _join(corners, np.int32, 2), wp.vec2i)


def _starting(counts: list[IntArray]) -> IntArray:
    """Where the rows of each begin, and the last end."""
    return np.concatenate([[0], np.cumsum(np.concatenate(counts))]).astype(np.int32)


def edge_sides(shape: Polyhedron) -> IntArray:
    """Two sides of faces along each edge, or -1, shape [edge_count, 2]."""
    found = np.full((len(shape.edges), 2), -1)
    if not len(shape.edges) or not len(shape.side_vertices):
        return found
    size = len(shape.vertices)
    own = np.sort(np.asarray(shape.edges, np.int64), axis=1) @ (size, 1)
    keys = np.sort(np.asarray(shape.side_vertices, np.int64), axis=1) @ (size, 1)
    order = np.argsort(keys, kind="stable")
    first = np.searchsorted(keys[order], own)
    for k in range(2):
        place = np.minimum(first + k, len(order) - 1)
        has = (first + k < len(order)) & (keys[order[place]] == own)
        found[has, k] = order[place[has]]
    return found


def _bent(shape: Polyhedron) -> BoolArray:
    """Sides of convex faces whose neighbour lies in another plane, shape [side_count]."""
    count = len(shape.side_vertices)
    if not count:
        return np.zeros(0, bool)
    face = np.repeat(np.arange(len(shape.face_offsets)), np.diff(shape.side_start))
    other = np.asarray(shape.side_neighbour)
    apart = np.linalg.norm(shape.face_normals[other] - shape.face_normals[face], axis=1)
    return np.asarray(shape.face_convex, bool)[face] & ((other < 0) | (apart >= FLAT))


def side_planes(shape: Polyhedron) -> tuple[FloatArray, FloatArray, IntArray]:
    """Half-spaces m.x <= o of each side of each face, shapes [side_count, 4] twice, [side_count].

    Above the face it is bounded by planes normal to it; behind it by the planes halfway to its
    neighbours, so that a vertex inside the solid belongs to the nearest face alone. Two faces of
    one plane share the very same half-space, and a point on their border belongs to the first.
    """
    count = len(shape.side_vertices)
    if count == 0:
        return np.zeros((0, 4)), np.zeros((0, 4)), np.zeros(0, np.int32)
    face = np.repeat(np.arange(len(shape.face_offsets)), np.diff(shape.side_start))
    other = np.asarray(shape.side_neighbour)
    normal = shape.face_normals[face]
    a = shape.vertices[shape.side_vertices[:, 0]]
    b = shape.vertices[shape.side_vertices[:, 1]]
    outward = np.cross(b - a, normal)
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    above = np.column_stack([outward, np.einsum("ij,ij->i", outward, a)])
    has = other >= 0
    apart = np.where(has[:, None], shape.face_normals[other] - normal, outward)
    size = np.linalg.norm(apart, axis=1)
    flat = has & (size < FLAT)
    below = above.copy()
    bent = has & ~flat
    offset = shape.face_offsets[other] - shape.face_offsets[face]
    halfway = np.column_stack([apart, offset])
    # a face lies on its own side of the plane halfway to its neighbour: at a convex border where
    # it is the higher of the two, at a concave one where it is the lower
    middle = np.add.reduceat(a, shape.side_start[:-1]) / np.diff(shape.side_start)[:, None]
    wrong = np.einsum("ij,ij->i", halfway[:, :3], middle[face]) > halfway[:, 3]
    halfway[wrong] *= -1.0
    below[bent] = halfway[bent] / size[bent, None]
    _share(above, flat, face, other, shape)
    below[flat] = above[flat]
    return above, below, (flat & (face > other)).astype(np.int32)


def _share(
    above: FloatArray, flat: np.ndarray, face: IntArray, other: IntArray, shape: Polyhedron
) -> None:
    """Give the second of two faces in one plane the negative of the first one's half-space."""
    chosen = np.flatnonzero(flat)
    ends = np.sort(shape.side_vertices[chosen], axis=1)
    low = np.minimum(face[chosen], other[chosen])
    high = np.maximum(face[chosen], other[chosen])
    order = np.lexsort((face[chosen], high, low, ends[:, 1], ends[:, 0]))
    keys = np.column_stack([ends, low, high])[order]
    chosen = chosen[order]
    partners = (keys[1:] == keys[:-1]).all(axis=1) & (face[chosen[1:]] > face[chosen[:-1]])
    above[chosen[1:][partners]] = -above[chosen[:-1][partners]]


def _cones(geometry: Geometry, shapes: list[Polyhedron], device: Any) -> None:
    starts, planes = [], []
    total = 0
    for shape in shapes:
        features = len(shape.vertices) + len(shape.edges)
        start = np.asarray(shape.cone_start, np.int64)
        if len(start) != features + 1:
            start = np.zeros(features + 1, np.int64)
        starts.append(start[:-1] + total)
        planes.append(shape.cone_planes)
        total += int(start[-1])
    geometry.cone_start = on(device, np.concatenate([*starts, [total]]).astype(np.int32), wp.int32)
    geometry.cone = on(device, _join(planes, np.float64, 3), vec3)


def feature_tree(shape: Polyhedron, device: Any) -> wp.Bvh:
    """Tree over the boxes of vertices, edges and faces, grown for single precision."""
    low = [shape.vertices, shape.vertices[shape.edges].min(axis=1).reshape(-1, 3)]
    high = [shape.vertices, shape.vertices[shape.edges].max(axis=1).reshape(-1, 3)]
    corners = shape.vertices[shape.side_vertices[:, 0]]
    if len(shape.face_offsets):
        # down to where a vertex behind the face still belongs to it
        behind = -_depths(shape)[:, None] * shape.face_normals
        lower = np.minimum.reduceat(corners, shape.side_start[:-1], axis=0)
        upper = np.maximum.reduceat(corners, shape.side_start[:-1], axis=0)
        low.append(np.minimum(lower, lower + behind))
        high.append(np.maximum(upper, upper + behind))
    slack = 1e-6 * float(np.abs(shape.vertices).max())
    return wp.Bvh(
        wp.array((np.concatenate(low) - slack).astype(np.float32), dtype=wp.vec3, device=device),
        wp.array((np.concatenate(high) + slack).astype(np.float32), dtype=wp.vec3, device=device),
    )
