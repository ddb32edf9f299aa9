"""Mass of rounded solids that are not convex: what their rounding counts twice, by quadrature.

``inertia.rounded_moments`` sweeps rays of length R from the faces, edges and vertices of the core.
Where the core is not convex some rays go on beyond the point from which another part of the core
is as near (the medial axis). Those ends are integrated here over the rays' origins, on triangles
divided until their parts agree with them, and taken off. All the rest stays exact.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from warpdem.filling.boxgrid import BoxGrid
from warpdem.filling.clearance import distances
from warpdem.filling.reach import reach
from warpdem.geometry.assembly import convex_faces
from warpdem.geometry.inertia import rounded_moments
from warpdem.geometry.moments import MassProperties, Moments, mass_properties
from warpdem.geometry.polygon import triangulated
from warpdem.geometry.rays import SAMPLES, Cells, cap_cells, edge_cells, face_cells

if TYPE_CHECKING:
    from warpdem.arrays import BoolArray, FloatArray, IntArray
    from warpdem.geometry.core import Core

_TOLERANCE = 1e-6  # aimed at, of volume and least inertia
_SHARES = 500  # cells among which the tolerance is shared evenly
_BUDGET = 300_000  # cells of each kind examined at most: some ten seconds
_CHUNK = 300_000  # rays times triangles held at once
_HIDDEN = 1e-7  # least error admitted: what samples may have missed altogether
_KINK = 0.002  # of a cell's largest value: its error where only some of its rays are cut short
_ABOVE = 1e-9  # of the size: facets that rise less above a plane lie in it


def overlapping_properties(core: Core, radius: float) -> MassProperties:
    """Mass properties of a rounded solid, sheet, frame or set of points that is not convex.

    Args:
        core: Its core.
        radius: Minkowski radius [m], not 0.
    """
    origin = 0.5 * (core.vertices.min(axis=0) + core.vertices.max(axis=0))
    size = float(np.linalg.norm(np.ptp(core.vertices, axis=0)))
    unit = replace(core, vertices=(core.vertices - origin) / size)
    swept = rounded_moments(unit, radius / size)
    twice, error = _overlap(unit, radius / size, swept)
    mass = mass_properties(swept - twice)
    least = float(np.linalg.eigvalsh(mass.inertia_over_mass)[0])
    relative = max(error[0], 2.0 * error[4:].max() / least) / mass.volume
    if twice.volume > 0.0:
        relative = max(relative, _HIDDEN)
    return MassProperties(
        mass.volume * size**3,
        mass.centre * size + origin,
        mass.inertia_over_mass * size**2,
        float(relative),
    )


def _overlap(core: Core, radius: float, swept: Moments) -> tuple[Moments, FloatArray]:
    """Moments of the rays' ends beyond the medial axis; errors of 1, x, y, z, xx, xy, ... zz."""
    ground = _Ground(core, radius)
    rough = mass_properties(swept)
    least = float(np.linalg.eigvalsh(rough.inertia_over_mass)[0])
    share = _TOLERANCE * rough.volume / _SHARES
    limit = share * np.array([1.0] + [np.sqrt(least)] * 3 + [least] * 6)
    total, error = np.zeros(10), np.zeros(10)
    for cells in (face_cells(core, *ground.faces, radius), edge_cells(core), cap_cells(core)):
        values, errors = _integrated(ground, cells, limit)
        total += values
        error += errors
    second = np.zeros((3, 3))
    second[np.triu_indices(3)] = total[4:]
    second = second + np.triu(second, 1).T
    return Moments(float(total[0]), total[1:4], second), error


def _integrated(ground: _Ground, cells: Cells, limit: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Integral over all cells and its error, dividing those whose parts disagree with them."""
    total, error = np.zeros(10), np.zeros(10)
    parents = ground.near(cells)
    values, _, cut = ground.overlaps(parents)
    spent = 0
    while parents.count:
        parts = ground.quartered(parents)
        part_values, part_doubts, part_cut = ground.overlaps(parts)
        spent += parts.count
        summed = part_values.reshape(-1, 4, 10).sum(axis=1)
        gap = np.maximum(np.abs(summed - values), part_doubts.reshape(-1, 4, 10).sum(axis=1))
        # a coarse cell's samples may agree by missing what there is, but for one triangle that
        # cuts all of its rays
        whole = ground.swept(parents)
        coarse = parents.is_coarse(ground.radius) & (whole > limit[0])
        coarse &= ~cut | (np.diff(parents.start) > 1)
        done = ~coarse & (gap <= limit).all(axis=1)
        if spent > _BUDGET:
            gap[coarse] = np.maximum(gap[coarse], whole[coarse, None] * parents.scale[coarse])
            done[:] = True
        total += summed[done].sum(axis=0)
        error += gap[done].sum(axis=0)
        kept = np.repeat(~done, 4) & (np.diff(parts.start) > 0)
        parents, values = parts.rows(np.flatnonzero(kept)), part_values[kept]
        cut = part_cut[kept]
    return total, error


class _Ground:
    """The core's surface as triangles, which cut rays short."""

    def __init__(self, core: Core, radius: float) -> None:
        self.radius = radius
        self.faces = triangulated(core.vertices, core.facets, core.normals, convex_faces(core))
        bare = [core.wires[:, [0, 1, 1]], np.column_stack([core.points] * 3)]
        self._triangles = core.vertices[np.concatenate([self.faces[0], *bare])]
        a, b, c = self._triangles.transpose(1, 0, 2)
        normals = np.cross(b - a, c - a)
        # zero for edges and points: no ball is off their plane
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        self._normals = normals / np.where(length > 0.0, length, 1.0)
        self._grid = BoxGrid(self._triangles.min(axis=1), self._triangles.max(axis=1))

    def near(self, cells: Cells) -> Cells:
        """Those cells of which some rays may be cut short, with the triangles that may do it."""
        centre, spread = cells.ends(self.radius)
        extent = (self.radius + spread)[:, None]
        found = self.culled(cells, *self._grid.pairs(centre - extent, centre + extent))
        return found.rows(np.flatnonzero(np.diff(found.start)))

    def culled(self, cells: Cells, cell: IntArray, triangle: IntArray) -> Cells:
        """All cells with those of the triangles, given by pairs, that may cut a ray short."""
        kept = [np.zeros(0, np.int64)]
        for k in range(0, len(cell), _CHUNK):
            own, other = cell[k : k + _CHUNK], triangle[k : k + _CHUNK]
            pair = np.arange(len(own))
            for may_cut in (self._meets_planes, self._meets_balls):
                pair = pair[may_cut(cells, own[pair], other[pair])]
            kept.append(k + pair)
        chosen = np.concatenate(kept)
        return cells.with_triangles(cell[chosen], triangle[chosen])

    def _meets_planes(self, cells: Cells, own: IntArray, triangle: IntArray) -> BoolArray:
        """Triangles that rise along some ray, with some ball of radius R across their plane."""
        other = self._triangles[triangle]
        base, direction = (rays[own] for rays in cells.corner_rays)
        offset = base + self.radius * direction - other[:, :1]
        height = np.einsum("nki,ni->nk", offset, self._normals[triangle])
        clear = (self.radius * (2.0 - cells.spread[own]) * (1.0 - 1e-12))[:, None]
        apart = (height >= clear).all(axis=1) | (height <= -clear).all(axis=1)
        return ~apart & (cells.rise(own, other) > _ABOVE)

    def _meets_balls(self, cells: Cells, own: IntArray, triangle: IntArray) -> BoolArray:
        """Triangles that may meet balls of radius R through the rays' origins.

        They meet the ball that holds all these; and one through x and y has the radius
        |y - x|^2 / 2 n . (y - x).
        """
        other = self._triangles[triangle]
        centre, spread = cells.ends(self.radius)
        near = distances(centre[own], other) < self.radius + spread[own]
        base = cells.corner_rays[0][own]
        middle = base.mean(axis=1)
        width = np.linalg.norm(base - middle[:, None], axis=2).max(axis=1)
        least = np.maximum(distances(middle, other) - width, 0.0)
        return near & (least**2 < 2.0 * self.radius * cells.rise(own, other))

    def quartered(self, cells: Cells) -> Cells:
        """Four cells for each, one after the other, with those of its triangles that matter."""
        parts = cells.halved(self.radius).halved(self.radius)
        return self.culled(parts, parts.owner, parts.triangles)

    def swept(self, cells: Cells) -> FloatArray:
        """Volume of the rays of each cell, shape [cell_count]."""
        power = cells.order + 1
        return cells.samples[1].sum(axis=1) * self.radius**power / power

    def overlaps(self, cells: Cells) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Integrals of 1, x, y, z, xx, xy, ... zz over the ends cut off, and their doubt.

        Returns:
            Both of shape [cell_count, 10], and the cells of which all rays are cut short.
        """
        load = np.cumsum(SAMPLES * np.diff(cells.start)) // _CHUNK
        values, doubts = np.zeros((cells.count, 10)), np.zeros((cells.count, 10))
        cut = np.zeros(cells.count, bool)
        busy = np.flatnonzero(np.diff(cells.start))
        for rows in np.split(busy, np.flatnonzero(np.diff(load[busy])) + 1):
            if len(rows):
                values[rows], doubts[rows], cut[rows] = self._overlaps(cells.rows(rows))
        return values, doubts, cut

    def _overlaps(self, cells: Cells) -> tuple[FloatArray, FloatArray, BoolArray]:
        points, weights = cells.samples
        base, direction = cells.rays(points)
        other = self._triangles[cells.triangles][:, None]
        lengths = reach(base[cells.owner], direction[cells.owner], other)
        length = np.minimum.reduceat(lengths, cells.start[:-1], axis=0)
        longest, shortest = length.max(axis=1), length.min(axis=1)
        kinked = (shortest < self.radius) & (longest >= self.radius)
        length = np.minimum(length, self.radius)
        powers = [
            (self.radius**power - length**power) / power
            for power in range(cells.order + 1, cells.order + 4)
        ]
        doubt = _KINK * weights.sum(axis=1) * powers[0].max(axis=1)
        doubt[~kinked] = 0.0
        values = _moments(base, direction, [weights * power for power in powers])
        return values, doubt[:, None] * cells.scale, longest < self.radius


def _moments(base: FloatArray, direction: FloatArray, weights: list[FloatArray]) -> FloatArray:
    """Sums of 1, x, y, z, xx, xy, ... zz over rays x + t n, shape [cell_count, 10].

    Args:
        base: Shape [cell_count, n, 3].
        direction: Shape [cell_count, n, 3].
        weights: Integrals of 1, t, t^2 along each ray, each of shape [cell_count, n].
    """
    zeroth, once, twice = weights
    first = np.einsum("cq,cqi->ci", zeroth, base) + np.einsum("cq,cqi->ci", once, direction)
    mixed = np.einsum("cq,cqi,cqj->cij", once, base, direction)
    second = np.einsum("cq,cqi,cqj->cij", zeroth, base, base) + mixed + mixed.transpose(0, 2, 1)
    second += np.einsum("cq,cqi,cqj->cij", twice, direction, direction)
    row, column = np.triu_indices(3)
    return np.column_stack([zeroth.sum(axis=1), first, second[:, row, column]])
