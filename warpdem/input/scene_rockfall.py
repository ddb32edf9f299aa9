"""Rockfall (run.method = "nonsmooth"): the terrain, what covers it, and what stands on it."""

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from warpdem.input.scene_values import Name, NotNegative, Number, Positive, Section

Point = Annotated[tuple[Number, ...], Field(min_length=2, max_length=2, strict=False)]
Polygon = Annotated[tuple[Point, ...], Field(min_length=3, strict=False)]
Line = Annotated[tuple[Point, ...], Field(min_length=2, strict=False)]
Share = Annotated[float, Field(ge=0, le=1)]


class _Classed(Section):
    """A section with the key ``class``, which is no name in Python: there it is ``class_``."""

    model_config = ConfigDict(populate_by_name=True)


class Terrain(_Classed):
    """The ground, in national or any other plane coordinates in metres.

    Results are in the same coordinates. The computation takes place about a local origin, so that
    large ones lose nothing.
    """

    file: Name
    """A raster of heights (.asc, ESRI ASCII grid; .tif, .tiff, GeoTIFF, with the extra geo),
    bilinear between its nodes; or a mesh (.stl, .obj, .ply) of triangles without overhangs. A
    relative path starts at the scene's folder."""

    class_: Annotated[Name, Field(alias="class")]
    """Class of the ground where no [[ground]] says another: "extra soft", "soft", "medium soft",
    "medium", "medium hard", "hard", "extra hard", "snow", or the name of a [[terrain_class]]."""

    nodes: Literal["centre", "corner"] = "centre"
    """Where in its cell a raster's height lies: "centre", the convention of ESRI (xllcorner) and of
    GeoTIFF; "corner", the lower-left one: some programs write nodes so."""

    crs: Name | None = None
    """Reference system of the results, such as "EPSG:2056"; default: that of the GeoTIFF."""


class TerrainClass(Section):
    """A class of ground of one's own, or a published one with other numbers.

    Without ``like``, and unless ``name`` is that of a published class, mu_min, mu_max, kappa, beta
    and drag must be given.
    """

    name: Name
    """By which [terrain] and [[ground]] refer to it."""

    like: Name | None = None
    """Class to start from, a published one or one above; default: the published one called so."""

    mu_min: NotNegative | None = None
    """Friction coefficient at first touch [-]."""

    mu_max: NotNegative | None = None
    """Friction coefficient after long slip [-]."""

    kappa: NotNegative | None = None
    """How fast slip raises it: mu = mu_min + (2/pi)(mu_max - mu_min) atan(kappa s) [1/m]."""

    beta: NotNegative | None = None
    """How fast slip is forgotten without contact: ds/dt = -beta s [1/s]."""

    drag: NotNegative | None = None
    """nu of the drag -nu m v while in contact [1/s]."""

    restitution: Share | None = None
    """Of the normal velocity [-]; default: 0."""

    scar_modulus: NotNegative | None = None
    """M_E of the layer that impacts scar [kN/m^2]; default: 0, no layer."""

    scar_drag: NotNegative | None = None
    """C_s of that layer [-]; default: 0."""


class GroundArea(_Classed):
    """Where another class holds than that of [terrain]; later entries win.

    Give polygon or file. A cell of the terrain belongs to a polygon when its centre does.
    """

    class_: Annotated[Name | None, Field(alias="class")] = None
    """Name of the class; not with field or classes, which name it."""

    polygon: Polygon | None = None
    """Corners x, y [m]."""

    file: Name | None = None
    """Polygons (.shp, with the extra geo) or a raster of class numbers (.asc, .tif); a relative
    path starts at the scene's folder."""

    field: Name | None = None
    """Attribute of the polygons that names their class."""

    classes: dict[str, Name] | None = None
    """Class of each number of a raster, such as {"1" = "soft"}; other cells stay as they are."""


class Forest(Section):
    """A forest: F = -c v on a rock while its centre is below the canopy; later entries win.

    Give polygon or file, and density or drag.
    """

    density: Literal["open", "medium", "dense"] | None = None
    """"open", c = 250 kg/s; "medium", 500 kg/s; "dense", 750 kg/s."""

    drag: Positive | None = None
    """c, instead of density [kg/s]."""

    height: Positive
    """Of the canopy above ground [m]."""

    polygon: Polygon | None = None
    """Corners x, y [m]."""

    file: Name | None = None
    """Polygons (.shp, with the extra geo) or a raster (.asc, .tif) that is not zero in the forest;
    a relative path starts at the scene's folder."""

    @property
    def coefficient(self) -> float:
        """What multiplies the velocity [kg/s]."""
        return self.drag or DENSITIES[self.density or "open"]


DENSITIES = {"open": 250.0, "medium": 500.0, "dense": 750.0}
"""Drag of the forests of RAMMS::ROCKFALL [kg/s]."""


class Tree(Section):
    """A tree as a vertical cylinder, or many from a table; position or file."""

    position: Point | None = None
    """Of the axis, x, y [m]."""

    diameter: Positive | None = None
    """Of the trunk [m]; a table has its own."""

    height: Positive | None = None
    """Of the trunk above ground [m]; a table has its own."""

    mu: NotNegative
    """Friction coefficient of the trunk [-]."""

    file: Name | None = None
    """Table with the columns x, y, diameter, height (.csv); a relative path starts at the scene's
    folder. Trees beside the terrain are left out, and counted by ``check``."""


class Barrier(Section):
    """A vertical screen along a line that records which rocks cross it, and may stop them."""

    name: Name
    """By which results refer to it."""

    line: Line
    """Points x, y, joined by straight pieces [m]."""

    height: Positive | None = None
    """Above ground [m]; default: endless, a line that only records."""

    capacity: Positive | None = None
    """Energy it takes [J]: a rock below its height with no more is caught, one with more goes on
    with so much less; default: it only records."""


class Ensemble(Section):
    """How many trajectories, and in what portions they are computed."""

    count: Annotated[int, Field(ge=1, le=2**40)] | None = None
    """Number of trajectories; default: one for each release point."""

    chunk: Annotated[int, Field(ge=1, le=2**31 - 1)] | None = None
    """Trajectories a chunk, which is the unit of files and of work; default: chosen. Changes no
    result."""
