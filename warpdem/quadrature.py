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

from warpdem.assembly import convex_faces
from warpdem.boxgrid import BoxGrid
from warpdem.clearance import distances
from warpdem.inertia import rounded_moments
from warpdem.moments import MassProperties, Moments, mass_properties
from warpdem.polygon import triangulated
from warpdem.rays import SAMPLES, Cells, cap_cells, edge_cells, face_cells
from warpdem.reach import reach

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray
    from warpdem.core import Core

_TOLERANCE = 1e-6  # aimed at, of volume and least inertia
_SHARES = 500  # cells among which the tolerance is shared evenly
_BUDGET = 150_000  # cells examined at most
_CHUNK = 300_000  # rays times triangles held at once
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


def _integrated(
    ground: _Ground, cells: Cells, limit: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Integral over all cells and its error, dividing those whose parts disagree with them."""
    total, error = np.zeros(10), np.zeros(10)
    parents = ground.near(cells)
    values, _ = ground.overlaps(parents)
    spent = 0
    while parents.count:
        divided = parents.divided()
        parts = ground.culled(divided, divided.owner, divided.triangles)
        part_values, part_doubts = ground.overlaps(parts)
        spent += parts.count
        summed = part_values.reshape(-1, 4, 10).sum(axis=1)
        gap = np.maximum(np.abs(summed - values), part_doubts.reshape(-1, 4, 10).sum(axis=1))
        # a coarse cell's samples may agree by missing all there is
        whole = ground.swept(parents)
        coarse = parents.is_coarse(ground.radius) & (whole > limit[0])
        done = ~coarse & (gap <= limit).all(axis=1)
        if spent > _BUDGET:
            gap[coarse] = np.maximum(gap[coarse], whole[coarse, None])
            done[:] = True
        total += summed[done].sum(axis=0)
        error += gap[done].sum(axis=0)
        kept = np.repeat(~done, 4) & (np.diff(parts.start) > 0)
        parents, values = parts.rows(np.flatnonzero(kept)), part_values[kept]
    return total, error


class _Ground:
    """The core's surface as triangles, which cut rays short."""

    def __init__(self, core: Core, radius: float) -> None:
        self.radius = radius
        self.faces = triangulated(core.vertices, core.facets, core.normals, convex_faces(core))
        bare = [core.wires[:, [0, 1, 1]], np.column_stack([core.points] * 3)]
        self._triangles = core.vertices[np.concatenate([self.faces[0], *bare])]
        self._grid = BoxGrid(self._triangles.min(axis=1), self._triangles.max(axis=1))

    def near(self, cells: Cells) -> Cells:
        """Those cells of which some rays may be cut short, with the triangles that may do it."""
        centre, spread = cells.ends(self.radius)
        extent = (self.radius + spread)[:, None]
        found = self.culled(cells, *self._grid.pairs(centre - extent, centre + extent))
        return found.rows(np.flatnonzero(np.diff(found.start)))

    def culled(self, cells: Cells, cell: IntArray, triangle: IntArray) -> Cells:
        """All cells with those of the triangles, given by pairs, that may cut a ray short.

        Such a triangle meets the balls of the rays' whole length, and rises above some corner's
        ray: between corners, directions are their sums.
        """
        centre, spread = cells.ends(self.radius)
        base, direction = cells.corner_rays
        middle = base.mean(axis=1)
        width = np.linalg.norm(base - middle[:, None], axis=2).max(axis=1)
        kept = np.zeros(len(cell), bool)
        for k in range(0, len(cell), _CHUNK):
            own, other = cell[k : k + _CHUNK], self._triangles[triangle[k : k + _CHUNK]]
            near = distances(centre[own], other) < self.radius + spread[own]
            offset = other[:, None] - base[own][:, :, None]
            rise = np.einsum("nijk,nik->nij", offset, direction[own]).max(axis=(1, 2))
            # a ball through x and y has the radius |y - x|^2 / 2 n . (y - x)
            least = np.maximum(distances(middle[own], other) - width[own], 0.0)
            near &= least**2 < 2.0 * self.radius * rise
            kept[k : k + _CHUNK] = near & (rise > _ABOVE)
        return cells.with_triangles(cell[kept], triangle[kept])

    def swept(self, cells: Cells) -> FloatArray:
        """Volume of the rays of each cell, shape [cell_count]."""
        power = cells.order + 1
        return cells.samples[1].sum(axis=1) * self.radius**power / power

    def overlaps(self, cells: Cells) -> tuple[FloatArray, FloatArray]:
        """Integrals of 1, x, y, z, xx, xy, ... zz over the ends cut off, and their doubt.

        Shapes [cell_count, 10].
        """
        load = np.cumsum(SAMPLES * np.diff(cells.start)) // _CHUNK
        values, doubts = np.zeros((cells.count, 10)), np.zeros((cells.count, 10))
        busy = np.flatnonzero(np.diff(cells.start))
        for rows in np.split(busy, np.flatnonzero(np.diff(load[busy])) + 1):
            if len(rows):
                values[rows], doubts[rows] = self._overlaps(cells.rows(rows))
        return values, doubts

    def _overlaps(self, cells: Cells) -> tuple[FloatArray, FloatArray]:
        points, weights = cells.samples
        base, direction = cells.rays(points)
        other = self._triangles[cells.triangles][:, None]
        lengths = reach(base[cells.owner], direction[cells.owner], other)
        length = np.minimum.reduceat(lengths, cells.start[:-1], axis=0)
        # cells may end just where rays begin to be cut short
        cut, whole = length < (1.0 - 1e-9) * self.radius, length > (1.0 + 1e-9) * self.radius
        kinked = cut.any(axis=1) & whole.any(axis=1)
        length = np.minimum(length, self.radius)
        powers = [
            (self.radius**power - length**power) / power
            for power in range(cells.order + 1, cells.order + 4)
        ]
        doubt = _KINK * weights.sum(axis=1) * powers[0].max(axis=1)
        doubt[~kinked] = 0.0
        place = np.linalg.norm(base, axis=2).max(axis=1) + self.radius
        scale = np.column_stack([np.ones_like(place), *[place] * 3, *[place**2] * 6])
        values = _moments(base, direction, [weights * power for power in powers])
        return values, doubt[:, None] * scale


def _moments(
    base: FloatArray, direction: FloatArray, weights: list[FloatArray]
) -> FloatArray:
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
