"""Vertices over faces of solids: convex ones of all aspects, and one that is not convex."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp
from reference import hull_distance
from warpdem.kernels.narrow import vertex_face
from warpdem.kernels.precision import mat33, real, vec3
from warpdem.kernels.views import Geometry  # noqa: TC002 - Warp reads the annotation

from warpdem.device_shapes import shape_arrays
from warpdem.geometry.hull import convex_hull
from warpdem.geometry.orientation import matrix, random_orientations
from warpdem.geometry.polyhedron import build

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

SOLIDS = 40
ELL = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
FAR_AWAY = 1e9
over_face = vertex_face(convex=False, two_sided=False)


@wp.kernel(enable_backward=False)
def vertex_over_face(
    geometry: Geometry,
    rotation: wp.array(dtype=mat33),
    body: wp.array(dtype=wp.int32),
    face: wp.array(dtype=wp.int32),
    vertex: wp.array(dtype=vec3),
    radius: wp.array(dtype=real),
    gap: wp.array(dtype=real),
    outside: wp.array(dtype=real),
    normal: wp.array(dtype=vec3),
    point: wp.array(dtype=vec3),
):
    """A vertex of the owner, about the centre of the partner that has the face."""
    k = wp.tid()
    far = real(FAR_AWAY)
    hit = over_face(geometry, rotation[k], body[k], face[k], vertex[k], radius[k], far, True)
    gap[k] = hit.gap
    outside[k] = hit.outside
    normal[k] = hit.normal
    point[k] = hit.point


class Prisms:
    """Solids whose faces vertices are held over; each with a rounding and a scale."""

    def __init__(self, random: np.random.Generator) -> None:
        self.shapes = [_solid(random, k) for k in range(SOLIDS)]
        geometry, self._trees = shape_arrays(self.shapes, np.zeros(SOLIDS, bool), "cpu")
        self.scale = 10.0 ** random.uniform(-3.0, 2.0, SOLIDS)
        self.radius = self.scale * [shape.radius for shape in self.shapes]
        geometry.shape = wp.array(np.arange(SOLIDS, dtype=np.int32), dtype=wp.int32, device="cpu")
        geometry.scale = wp.array(self.scale, dtype=real, device="cpu")
        geometry.radius = wp.array(self.radius, dtype=real, device="cpu")
        self.geometry = geometry

    def examine(
        self, random: np.random.Generator, count: int, fault_of: Callable[..., str]
    ) -> Iterator[tuple[str, str, tuple[Any, ...]]]:
        """Of so many vertices: how they lie, what is wrong, and the case."""
        body = random.integers(0, SOLIDS, count)
        face = np.array([random.integers(len(self.shapes[b].face_offsets)) for b in body])
        turn = matrix(random_orientations(count, random))
        corners = [self._corners(b, f) @ m.T for b, f, m in zip(body, face, turn, strict=True)]
        normal = [
            m @ self.shapes[b].face_normals[f] for b, f, m in zip(body, face, turn, strict=True)
        ]
        vertex = np.array([_over(c, n, random) for c, n in zip(corners, normal, strict=True)])
        radius = self.radius[body] * 10.0 ** random.uniform(-2.0, 0.0, count)
        found = self._hits(turn, body, face, vertex, radius)
        for k in range(count):
            hit = tuple(values[k] for values in found)
            polygon = _triangles(corners[k], normal[k])
            sides = list(zip(corners[k], np.roll(corners[k], -1, axis=0), strict=True))
            others = [(vertex[k][None], np.array(side)) for side in sides]
            # the nearest part of the face stands for it
            near = min(polygon, key=lambda t, p=vertex[k][None]: hull_distance(p, t))
            both = np.array([radius[k], self.radius[body[k]]])
            told = fault_of(vertex[k][None], near, others, both, hit)
            yield "outside" if hit[1] else "admissible", told, (vertex[k], corners[k], both, hit)

    def _corners(self, body: int, face: int) -> np.ndarray:
        shape = self.shapes[body]
        sides = shape.side_vertices[shape.side_start[face] : shape.side_start[face + 1]]
        return self.scale[body] * shape.vertices[sides[:, 0]]

    def _hits(self, turn: np.ndarray, *each: np.ndarray) -> tuple[np.ndarray, ...]:
        kinds = (mat33, wp.int32, wp.int32, vec3, real)
        arrays = [
            wp.array(
                values.astype(np.int32) if kind is wp.int32 else values, dtype=kind, device="cpu"
            )
            for values, kind in zip((turn, *each), kinds, strict=True)
        ]
        out = [wp.zeros(len(turn), dtype=t, device="cpu") for t in (real, real, vec3, vec3)]
        inputs = [self.geometry, *arrays]
        wp.launch(vertex_over_face, dim=len(turn), inputs=inputs, outputs=out, device="cpu")
        return tuple(array.numpy() for array in out)


def _solid(random: np.random.Generator, number: int) -> Any:
    """A hull of random points, drawn out along two axes by up to 1:100; one is an L."""
    if number == 0:
        count = len(ELL)
        vertices = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ELL])
        ring = range(count)
        sides = [[k, (k + 1) % count, count + (k + 1) % count, count + k] for k in ring]
        faces = [list(ring)[::-1], [count + k for k in ring], *sides]
        return build(vertices, faces, name="ell", radius=0.05, declared=(1.0, (1.0, 1.0, 1.0)))
    vertices = random.normal(size=(random.integers(4, 16), 3))
    vertices *= 10.0 ** random.uniform(-1.0, 1.0, 3)
    declared = (1.0, (1.0, 1.0, 1.0))
    faces = convex_hull(vertices)
    return build(vertices, faces, name=f"hull {number}", radius=0.05, declared=declared)


def _over(corners: np.ndarray, normal: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A point above the plane of a face: anywhere near, over a corner, or over a border."""
    size = float(np.ptp(corners, axis=0).max())
    k = random.integers(len(corners))
    a, b = corners[k], corners[(k + 1) % len(corners)]
    place = random.integers(4)
    if place == 0:
        foot = a
    elif place == 1:
        foot = a + random.uniform(-0.1, 1.1) * (b - a)
    else:
        foot = a + random.uniform(-0.5, 1.5) * (b - a)
        foot = foot + random.uniform(-0.5, 1.0) * (corners.mean(axis=0) - foot)
    slip = random.choice([0.0, 1e-15, 1e-12, 1e-9]) * size * random.normal(size=3)
    return (
        foot + slip - (slip @ normal) * normal + size * 10.0 ** random.uniform(-6.0, 0.5) * normal
    )


def _triangles(corners: np.ndarray, normal: np.ndarray) -> list[np.ndarray]:
    """A polygon in triangles, by cutting off ears."""
    left, triangles = list(range(len(corners))), []
    while len(left) > 3:
        for at in range(len(left)):
            i, j, k = left[at - 1], left[at], left[(at + 1) % len(left)]
            tip = corners[[i, j, k]]
            rest = [n for n in left if n not in {i, j, k}]
            turn = np.cross(tip[1] - tip[0], tip[2] - tip[1]) @ normal
            if turn > 0.0 and not any(_within(corners[n], tip, normal) for n in rest):
                triangles.append(tip)
                left.pop(at)
                break
        else:
            raise AssertionError("no ear")
    return [*triangles, corners[left]]


def _within(p: np.ndarray, tip: np.ndarray, normal: np.ndarray) -> bool:
    ahead = np.roll(tip, -1, axis=0)
    return bool((np.cross(ahead - tip, p - tip) @ normal >= 0.0).all())
