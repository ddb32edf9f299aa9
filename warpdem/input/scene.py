"""The scene: everything a run depends on. The docstrings here are the manual of its file format."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import (
    Discriminator,
    Field,
    PrivateAttr,
    Tag,
    ValidationError,
    model_validator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from warpdem.input.consistency import consistency
from warpdem.input.scene_bond import Bond
from warpdem.input.scene_cell import Cell
from warpdem.input.scene_contact import Contact
from warpdem.input.scene_driver import Driver
from warpdem.input.scene_fill import Fill
from warpdem.input.scene_force import Force
from warpdem.input.scene_release import Release
from warpdem.input.scene_rock import Rock
from warpdem.input.scene_rockfall import (
    Barrier,
    Ensemble,
    Forest,
    GroundArea,
    Terrain,
    TerrainClass,
    Tree,
)
from warpdem.input.scene_run import Run
from warpdem.input.scene_shapes import Shape
from warpdem.input.scene_values import (
    Name,
    Positive,
    Quaternion,
    Section,
    Vector,
)

Count = Annotated[int, Field(ge=0, le=2**40)]
CountOrList = Annotated[
    Annotated[Count, Tag("number")]
    | Annotated[tuple[Count, ...], Field(strict=False), Tag("list")],
    Discriminator(lambda value: "list" if isinstance(value, list | tuple) else "number"),
]


class Gravity(Section):
    """The acceleration of free fall."""

    vector: Vector = (0.0, 0.0, -9.81)
    """Acceleration [m/s^2]; [0, 0, 0] switches it off."""


class Group(Section):
    """A set of bodies alike in material; contact parameters belong to pairs of groups."""

    name: Name
    """By which bodies and contacts refer to it."""

    density: Positive | None = None
    """Mass per volume of its bodies, unless they have their own [kg/m^3]."""


class Body(Section):
    """One body, free or driven."""

    shape: Name
    """Name of its shape."""

    name: str = ""
    """By which results refer to it; default: body[i]."""

    group: Name = "default"
    """Name of its group."""

    cluster: Annotated[int, Field(ge=0, le=2**31 - 1)] = 0
    """Number of the cluster it is part of."""

    position: Vector
    """Where the origin of the shape's file goes (box, sphere: the centre) [m]."""

    orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
    """Unit quaternion w, x, y, z that turns the shape's own axes into the world's."""

    velocity: Vector = (0.0, 0.0, 0.0)
    """Velocity of the centre of mass [m/s]."""

    spin: Vector = (0.0, 0.0, 0.0)
    """Angular velocity, along the world's axes [rad/s]."""

    scale: Positive = 1.0
    """Homothety: the body is so many times its shape's size, rounding included."""

    density: Positive | None = None
    """Mass per volume [kg/m^3]; default: that of its group."""

    fixed: bool = False
    """true: no force moves it; it keeps its velocity and spin, or a [[driver]] moves it."""


class Output(Section):
    """What a run writes, and how often."""

    every: Positive | None = None
    """Simulated time between frames [s]; default: a fiftieth of run.duration."""

    surface: bool = True
    """Write the bodies' surfaces (bodies.pvd) for ParaView."""

    contacts: bool = False
    """Write the contacts (contacts.pvd)."""

    table: bool = False
    """Write every body at every frame as text (trajectory.csv)."""

    orientation: Literal["auto"] | bool = "auto"
    """Follow the orientations of spheres too, which no force depends on: "auto", where output.table
    writes them. Without, they stay as they were at the start."""

    energy: bool = True
    """Keep account of the energies (energy.csv)."""

    drivers: bool = True
    """Write motion, contact force and work of the bodies that [[driver]]s move (drivers.csv)."""
    bonds: bool = True
    """Write every breakage (bonds.csv), when there are bonds."""

    fragments: bool = True
    """Write number and size of the fragments (fragments.csv), when there are bonds."""

    checkpoint_every: Positive | None = None
    """Simulated time between checkpoints [s]; default: at every frame."""

    compression: Literal["lz4", "zlib", "none"] = "lz4"
    """Of the files for ParaView."""

    fields: Annotated[
        tuple[
            Literal[
                "body",
                "group",
                "cluster",
                "fragment",
                "speed",
                "velocity",
                "spin",
                "force",
                "mass",
            ],
            ...,
        ],
        Field(strict=False),
    ] = ("body", "group", "cluster", "fragment", "speed", "velocity", "spin", "force", "mass")
    """What is written with the surfaces; fragment when there are bonds."""

    rasters: bool = True
    """Rockfall: write passages, deposits, energies and so on of the cells of the terrain."""

    cellsize: Positive | None = None
    """Rockfall: edge length of these cells [m]; default: that of the terrain."""

    formats: Annotated[tuple[Literal["asc", "tif"], ...], Field(min_length=1, strict=False)] = (
        "asc",
    )
    """Rockfall: "asc", ESRI ASCII grids; "tif", GeoTIFF with the reference system (extra geo)."""

    trajectories: CountOrList = 50
    """Rockfall: trajectories written as lines (VTU, CSV); how many from the first, or a list of
    their numbers."""

    trajectory_every: Positive = 0.05
    """Rockfall: time between two points of such a line [s]."""

    map: bool = True
    """Rockfall: draw a map (map.png)."""


class Scene(Section):
    """All of a simulation's input, in SI units; one TOML file."""

    title: str = ""
    """What the scene shows."""

    run: Run
    """[run]: duration, time step and method."""

    gravity: Gravity = Gravity()
    """[gravity]: on by default, along -z."""

    cell: Cell | None = None
    """[cell]: space repeats itself; default: it is open."""

    shape: Annotated[tuple[Shape, ...], Field(strict=False)] = ()
    """[[shape]]: the solids, by name."""

    group: Annotated[tuple[Group, ...], Field(strict=False)] = ()
    """[[group]]: materials by name; a group without density may also just be named by bodies."""

    body: Annotated[tuple[Body, ...], Field(strict=False)] = ()
    """[[body]]: bodies given one by one."""

    fill: Annotated[tuple[Fill, ...], Field(strict=False)] = ()
    """[[fill]]: generated bodies."""

    contact: Annotated[tuple[Contact, ...], Field(strict=False)] = ()
    """[[contact]]: the laws between groups; one for each pair of groups that can meet."""

    force: Annotated[tuple[Force, ...], Field(strict=False)] = ()
    """[[force]]: drag, a flowing fluid, numerical damping, barriers."""
    driver: Annotated[tuple[Driver, ...], Field(strict=False)] = ()
    """[[driver]]: what moves fixed bodies."""
    bond: Annotated[tuple[Bond, ...], Field(strict=False)] = ()
    """[[bond]]: breakable bonds between bodies."""

    terrain: Terrain | None = None
    """[terrain]: the ground of rockfall."""

    terrain_class: Annotated[tuple[TerrainClass, ...], Field(strict=False)] = ()
    """[[terrain_class]]: classes of ground of one's own."""

    ground: Annotated[tuple[GroundArea, ...], Field(strict=False)] = ()
    """[[ground]]: where other classes hold."""

    forest: Annotated[tuple[Forest, ...], Field(strict=False)] = ()
    """[[forest]]: where forests stand."""

    tree: Annotated[tuple[Tree, ...], Field(strict=False)] = ()
    """[[tree]]: single trees."""

    barrier: Annotated[tuple[Barrier, ...], Field(strict=False)] = ()
    """[[barrier]]: screens that record what crosses, or stop it."""

    rock: Annotated[tuple[Rock, ...], Field(strict=False)] = ()
    """[[rock]]: the rocks that fall, by name."""

    release: Annotated[tuple[Release, ...], Field(strict=False)] = ()
    """[[release]]: where and how rocks start."""

    ensemble: Ensemble = Ensemble()
    """[ensemble]: how many trajectories."""

    output: Output = Output()
    """[output]: what is written."""

    _source: Path | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if faults := consistency(self):
            raise ValidationError.from_exception_data(
                "Scene",
                [
                    InitErrorDetails(
                        type=PydanticCustomError("scene", "{rule}", {"rule": fault.rule}),
                        loc=fault.path,
                        input=fault.value,
                    )
                    for fault in faults
                ],
            )
        return self

    def located(self, source: Path) -> "Scene":
        """The same scene as read from the file ``source``."""
        scene = self.model_copy()
        scene._source = source  # noqa: SLF001 - of its own class
        return scene

    @property
    def source(self) -> Path | None:
        """The scene file, when there is one."""
        return self._source

    @property
    def directory(self) -> Path:
        """Folder at which relative paths start."""
        return self._source.parent if self._source else Path()

    @property
    def frame_interval(self) -> float:
        """Simulated time between frames [s]."""
        return self.output.every or self.run.duration / 50.0

    @property
    def partnership(self) -> str:
        """How sub-contacts share stiffness, after "auto"."""
        if self.run.partnership != "auto":
            return self.run.partnership
        springs = all(law.law in {"default", "sticked_links"} for law in self.contact)
        return "once" if springs and not self.bond and self.run.compat == "none" else "sum"

    def contact_table(self, groups: Sequence[str]) -> dict[tuple[str, str], Contact]:
        """Laws between the named groups, under both orders of each pair."""
        wanted = set(groups)
        laws = {contact.groups: contact for contact in self.contact if wanted >= {*contact.groups}}
        return {pair: law for (a, b), law in laws.items() for pair in ((a, b), (b, a))}
