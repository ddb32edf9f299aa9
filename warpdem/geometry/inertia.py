"""Volume, centre and inertia of a rounded solid, exact but for where its rounding overlaps itself.

A point outside the core belongs to its nearest core point: the rounding falls apart into prisms on
the faces, sectors around the edges and balls' sectors around the vertices (Steiner's formula).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from warpdem.geometry.moments import NOTHING, MassProperties, Moments, mass_properties

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray
    from warpdem.geometry.arcs import Cap
    from warpdem.geometry.core import Core
    from warpdem.geometry.facets import Facets


def rounded_box(extent: FloatArray, radius: float) -> MassProperties:
    """Of a box with rounding, in closed form; also plates, capsules and spheres.

    Args:
        extent: Edge lengths of the core, any of them 0 [m], shape [3].
        radius: Minkowski radius [m].
    """
    a, b, c = (float(length) for length in extent)
    volume = a * b * c + 2.0 * radius * (a * b + b * c + c * a)
    volume += np.pi * radius**2 * (a + b + c) + 4.0 / 3.0 * np.pi * radius**3
    x, y, z = (_box_square(*lengths, radius) for lengths in ((a, b, c), (b, c, a), (c, a, b)))
    inertia = np.diag([y + z, z + x, x + y]) / volume
    return MassProperties(volume, np.zeros(3), inertia)


def _box_square(a: float, b: float, c: float, r: float) -> float:
    """Integral of x^2 over a rounded box of core a x b x c, x along a [m^5]."""
    straight = a**3 / 12.0
    ends = 2.0 * (r * a**2 / 4.0 + r**2 * a / 2.0 + r**3 / 3.0)  # slabs beyond |x| = a/2
    along = straight * (b * c + 2.0 * r * (b + c) + np.pi * r**2) + ends * b * c
    # quarter cylinders along b and c: x = a/2 + s, moments of a quarter disc in s
    quarter = np.pi * r**2 / 4.0 * (a / 2.0) ** 2 + a * r**3 / 3.0 + np.pi * r**4 / 16.0
    # eighth balls
    eighth = np.pi * r**3 / 6.0 * (a / 2.0) ** 2 + a * np.pi * r**4 / 16.0 + np.pi * r**5 / 30.0
    return along + 4.0 * (b + c) * quarter + 8.0 * eighth


def rounded_moments(core: Core, radius: float) -> Moments:
    """Moments of core and rounding, as if no two parts of the rounding overlapped.

    Exact for convex cores, also flat and open ones; see ``quadrature`` for the overlap of others.
    """
    inside = enclosed(core.vertices, core.facets) if core.closed else NOTHING
    if radius == 0.0:
        return inside
    faces = _prisms(core, radius, core.normals)
    if not core.closed:
        faces = faces + _prisms(core, radius, -core.normals)
    return inside + faces + _sectors(core, radius) + _caps(core, radius)


def enclosed(vertices: FloatArray, facets: Facets) -> Moments:
    """Moments of the region inside closed, outward facets.

    Source: signed tetrahedra over fans of the facets; Mirtich (1996),
    doi:10.1080/10867651.1996.10487458, gives the same integrals by lines.
    """
    a, b, c = _fan(vertices, facets)
    determinant = np.einsum("ij,ij->i", a, np.cross(b, c))
    corner_sum = a + b + c
    second = _outer(corner_sum, corner_sum, determinant)
    second += sum(_outer(x, x, determinant) for x in (a, b, c))
    return Moments(float(determinant.sum()) / 6.0, determinant @ corner_sum / 24.0, second / 120.0)


def _fan(vertices: FloatArray, facets: Facets) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Corners of triangles from each facet's first vertex to its sides; some are negative."""
    if not facets.count:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3))
    apex = facets.sides[facets.start[:-1], 0][facets.owner]
    return vertices[apex], vertices[facets.sides[:, 0]], vertices[facets.sides[:, 1]]


def _outer(x: FloatArray, y: FloatArray, weight: FloatArray) -> FloatArray:
    return (x * weight[:, None]).T @ y


def _symmetric(matrix: FloatArray) -> FloatArray:
    return matrix + matrix.T


def _prisms(core: Core, radius: float, normals: FloatArray) -> Moments:
    """Moments of the slabs of thickness ``radius`` on the faces."""
    a, b, c = _fan(core.vertices, core.facets)
    normal = normals[core.facets.owner]
    area = 0.5 * np.einsum("ij,ij->i", np.cross(b - a, c - a), core.normals[core.facets.owner])
    corner_sum = a + b + c
    first = corner_sum * (area / 3.0)[:, None]
    second = _outer(corner_sum, corner_sum, area / 12.0)
    second += sum(_outer(x, x, area / 12.0) for x in (a, b, c))
    return Moments(
        radius * float(area.sum()),
        radius * first.sum(axis=0) + 0.5 * radius**2 * (area @ normal),
        radius * second
        + 0.5 * radius**2 * _symmetric(first.T @ normal)
        + radius**3 / 3.0 * _outer(normal, normal, area),
    )


def _sectors(core: Core, radius: float) -> Moments:
    """Moments of the cylinder sectors around the edges."""
    arcs = core.edge_arcs
    a, b = core.vertices[arcs.ends[:, 0]], core.vertices[arcs.ends[:, 1]]
    length = np.linalg.norm(b - a, axis=1)
    across = np.cross((b - a) / length[:, None], arcs.middle)
    slice_area = arcs.half * radius**2
    mean = 2.0 * np.sin(arcs.half)[:, None] * arcs.middle
    line = 0.5 * (a + b) * length[:, None]
    lean = np.sin(arcs.half) * np.cos(arcs.half)
    second = sum(_outer(x, x, slice_area * length / 6.0) for x in (a + b, a, b))
    second += radius**3 / 3.0 * _symmetric(line.T @ mean)
    second += radius**4 / 4.0 * _outer(arcs.middle, arcs.middle, length * (arcs.half + lean))
    second += radius**4 / 4.0 * _outer(across, across, length * (arcs.half - lean))
    return Moments(
        float(slice_area @ length),
        slice_area @ line + radius**3 / 3.0 * (length @ mean),
        second,
    )


def _caps(core: Core, radius: float) -> Moments:
    """Moments of the balls' sectors around the vertices."""
    solid_angle, mean, square = _plain_caps(core)
    solid_angle[core.points] = 4.0 * np.pi
    square += 4.0 / 3.0 * np.pi * len(core.points) * np.eye(3)
    for vertex, cap in core.caps:
        solid_angle[vertex] = cap.solid_angle
        mean[vertex] = -0.5 * cap.angles @ cap.outward
        square += _cap_square(cap)
    volume = radius**3 / 3.0 * solid_angle
    return Moments(
        float(volume.sum()),
        volume @ core.vertices + radius**4 / 4.0 * mean.sum(axis=0),
        _outer(core.vertices, core.vertices, volume)
        + radius**4 / 4.0 * _symmetric(core.vertices.T @ mean)
        + radius**5 / 5.0 * square,
    )


def _cap_square(cap: Cap) -> FloatArray:
    """Integral of n n^T over a spherical polygon, by the divergence of n_i times a constant.

    With O its area, and over its arcs the integral m of n and the outward conormal v, it is
    (O 1 - sum m v^T) / 3.
    """
    middle = cap.corners + np.roll(cap.corners, -1, axis=0)
    line = middle * np.tan(0.5 * cap.angles)[:, None]
    square = (cap.solid_angle * np.eye(3) - line.T @ cap.outward) / 3.0
    return 0.5 * _symmetric(square)


def _plain_caps(core: Core) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Area and mean of the normal cones of the plain vertices, 0 for others; sum of n n^T.

    The area is the angle missing from the corners around the vertex, 2 pi less their sum; the
    arcs are those of the edges, their conormals the edges' directions away from the vertex.
    """
    count = len(core.vertices)
    plain, arcs = core.plain_vertices, core.edge_arcs
    corners = np.bincount(core.facets.sides[:, 0], core.corner_angles, minlength=count)
    solid_angle = np.where(plain, 2.0 * np.pi - corners, 0.0)
    mean = np.zeros((count, 3))
    square = np.zeros((3, 3))
    along = core.vertices[arcs.ends[:, 1]] - core.vertices[arcs.ends[:, 0]]
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    for end, away in ((0, along), (1, -along)):
        at = arcs.ends[:, end]
        np.add.at(mean, at, -arcs.half[:, None] * away)
        kept = plain[at]
        square -= _outer(arcs.middle[kept], away[kept], 2.0 * np.sin(arcs.half[kept]))
    mean[~plain] = 0.0
    square += solid_angle.sum() * np.eye(3)
    return solid_angle, mean, 0.5 * _symmetric(square) / 3.0


def solid_properties(core: Core, radius: float) -> MassProperties:
    """Mass properties of a convex core with rounding, or of any without.

    The integrals are taken about the middle of the core: far from it they would lose digits.
    """
    middle = 0.5 * (core.vertices.min(axis=0) + core.vertices.max(axis=0))
    near = replace(core, vertices=core.vertices - middle)
    mass = mass_properties(rounded_moments(near, radius))
    return replace(mass, centre=mass.centre + middle)
