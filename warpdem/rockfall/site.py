"""What rocks fall on: ground, its classes, forest, trees and barriers, in local coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpdem.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Grid:
    """Square cells laid over the ground, in local coordinates; row 0 lies in the south.

    Attributes:
        x, y: South-west corner of the cell in row 0, column 0 [m].
        cell: Edge length of a cell [m].
        rows, columns: Number of cells.
    """

    x: float
    y: float
    cell: float
    rows: int
    columns: int

    def index(self, x: FloatArray, y: FloatArray) -> IntArray:
        """Number row * columns + column of the cell under each point; -1 outside."""
        column = np.floor((np.asarray(x) - self.x) / self.cell)
        row = np.floor((np.asarray(y) - self.y) / self.cell)
        inside = (column >= 0) & (column < self.columns) & (row >= 0) & (row < self.rows)
        # numbers of cells far outside need not be whole numbers of the machine
        return np.where(inside, row * self.columns + column, -1.0).astype(np.int64)


@dataclass(frozen=True, eq=False)
class Facets:
    """A ground of triangles without overhangs, found through the cells of a grid.

    Attributes:
        points: Corners [m], local, shape [point_count, 3].
        triangles: Corners of each, counter-clockwise seen from above, shape [triangle_count, 3].
        start: First entry of each cell in ``members``, shape [cell_count + 1].
        members: Triangles whose plan reaches into the cell, cell after cell.
    """

    points: FloatArray
    triangles: IntArray
    start: IntArray
    members: IntArray


@dataclass(frozen=True, eq=False)
class Ground:
    """Heights as a raster (bilinear between its nodes) or as triangles.

    Attributes:
        grid: The cells between four nodes; of triangles, those they are found through.
        heights: At the nodes [m], local, NaN without data, shape [rows + 1, columns + 1]; None for
            triangles.
        facets: The triangles; None for a raster.
        known: Whether a rock's centre may be above the cell, shape [rows, columns].
        steep: Largest slope (tangent) in the cells within ``reach`` of the cell, shape
            [rows, columns].
        reach: Horizontal distance for which ``steep`` holds, from anywhere in the cell [m].
    """

    grid: Grid
    heights: FloatArray | None
    facets: Facets | None
    known: np.ndarray
    steep: FloatArray
    reach: float

    def height(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Height of the ground under each local point [m], NaN where there is none."""
        from warpdem.rockfall.heights import height_at  # noqa: PLC0415 - the two know each other

        return height_at(self, x, y)

    def slopes(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Slopes dh/dx, dh/dy of the ground under each local point [-], NaN where there is none."""
        from warpdem.rockfall.heights import slopes_at  # noqa: PLC0415 - the two know each other

        return slopes_at(self, x, y)


@dataclass(frozen=True)
class GroundClass:
    """How a ground acts on a rock.

    Attributes:
        name: Of the class.
        mu_min, mu_max: Friction before and after long slip [-].
        kappa: How fast slip raises it [1/m].
        beta: How fast it is forgotten in the air [1/s].
        drag: nu, of the velocity while in contact [1/s].
        restitution: Of the normal velocity [-].
        scar_modulus: M_E [kN/m^2]; 0: no scarring layer.
        scar_drag: C_s [-].
        source: Where the numbers are from; "unverified" for those nobody could confirm.
    """

    name: str
    mu_min: float
    mu_max: float
    kappa: float
    beta: float
    drag: float
    restitution: float = 0.0
    scar_modulus: float = 0.0
    scar_drag: float = 0.0
    source: str = "scene"


@dataclass(frozen=True)
class Stand:
    """A kind of forest: F = -drag v while the centre is lower than the canopy.

    Attributes:
        drag: [kg/s].
        height: Of the canopy above ground [m].
    """

    drag: float
    height: float


@dataclass(frozen=True, eq=False)
class Trees:
    """Trunks as vertical cylinders.

    Attributes:
        position: Of the axes, local x, y [m], shape [tree_count, 2].
        radius: [m], shape [tree_count].
        top: Local height of the upper end [m], shape [tree_count].
        friction: Of a trunk [-], shape [tree_count].
        left_out: Number of trees of tables that stand beside the ground.
    """

    position: FloatArray
    radius: FloatArray
    top: FloatArray
    friction: FloatArray
    left_out: int = 0


@dataclass(frozen=True)
class Barrier:
    """A vertical screen along a line, of any number of straight pieces.

    Attributes:
        name: Of the barrier.
        line: Its plan, local [m], shape [point_count, 2].
        height: Above ground [m]; infinite: a line that only records.
        capacity: Energy it can take [J]; 0: it only records. A rock that meets it below its height
            with no more than that is caught; one with more goes through and loses so much.
    """

    name: str
    line: FloatArray
    height: float
    capacity: float


@dataclass(frozen=True, eq=False)
class Site:
    """All that a trajectory can meet; local coordinates are national ones less ``origin``.

    Attributes:
        origin: Of the local coordinates in national ones [m], shape [3].
        crs: Reference system, such as "EPSG:2056"; empty when unknown.
        ground: The terrain.
        classes: The classes that occur.
        class_of: Number of the class of each cell of the ground's grid, shape [rows, columns].
        stands: The kinds of forest that occur.
        stand_of: Number of the stand of each cell, -1 without, shape [rows, columns]; None when
            there is no forest at all.
        trees: Trunks; None when there are none.
        barriers: Screens that record what crosses, or stop it.
        results: The cells in which results are counted.
    """

    origin: FloatArray
    crs: str
    ground: Ground
    classes: tuple[GroundClass, ...]
    class_of: IntArray
    stands: tuple[Stand, ...]
    stand_of: IntArray | None
    trees: Trees | None
    barriers: tuple[Barrier, ...]
    results: Grid
