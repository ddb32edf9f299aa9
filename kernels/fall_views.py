"""What the kernel of falling rocks sees: ground, rocks, obstacles, and the flights it moves."""

import warp as wp
from warpdem.kernels.precision import quat, wide, wide3, wide33

vec2 = wp.vec2d

# Flights.fate, as rockfall.flights.Fate
MOVING = wp.constant(0)
REST = wp.constant(1)
LEFT = wp.constant(2)
TIMEOUT = wp.constant(3)
CAUGHT = wp.constant(4)
BROKEN = wp.constant(5)

# columns of Flights.count, as rockfall.flights.COUNTS
CONTACT_STEPS = wp.constant(0)
FLIGHT_STEPS = wp.constant(1)
JUMPS = wp.constant(2)
SWEEPS = wp.constant(3)
FROZEN = wp.constant(4)
UNCONVERGED = wp.constant(5)
LIMITED = wp.constant(6)
DROPPED = wp.constant(7)
MOST_SWEEPS = wp.constant(8)

# columns of Flights.measure, as rockfall.flights.MEASURES
DEPTH = wp.constant(0)
RESIDUAL = wp.constant(1)
GAIN = wp.constant(2)
LIFTED = wp.constant(3)
LARGEST = wp.constant(4)  # and on: energy, speed, jump, spin
LARGEST_COUNT = wp.constant(4)

# bits of Terrain.near: what may be within reach of the cell
FOREST = wp.constant(1)
TREE = wp.constant(2)
SCREEN = wp.constant(4)


@wp.struct
class Terrain:
    """Ground in cells, row 0 in the south; local coordinates."""

    x: wide
    y: wide
    cell: wide
    per_metre: wide  # cells
    reach: wide  # horizontal distance for which ``steep`` holds
    rows: int
    columns: int
    heights: wp.array(dtype=wide, ndim=2)  # at the nodes
    known: wp.array(dtype=wp.int32, ndim=2)
    steep: wp.array(dtype=wide, ndim=2)
    class_of: wp.array(dtype=wp.int32, ndim=2)
    stand_of: wp.array(dtype=wp.int32, ndim=2)
    near: wp.array(dtype=wp.int32, ndim=2)
    # triangles: those of each cell; corners in plan; height = (a, b, c) . (1, x, y)
    facet_start: wp.array(dtype=wp.int32)
    facet_member: wp.array(dtype=wp.int32)
    facet_corner: wp.array(dtype=vec2, ndim=2)
    facet_plane: wp.array(dtype=wide3)


@wp.struct
class Rocks:
    """The rocks, in their principal frames."""

    vertex: wp.array(dtype=wide3, ndim=2)  # [rock, vertex]
    vertex_count: wp.array(dtype=wp.int32)
    edge: wp.array(dtype=wp.vec2i, ndim=2)
    edge_count: wp.array(dtype=wp.int32)
    skin: wp.array(dtype=wide3, ndim=2)  # corners of the outer surface
    facet: wp.array(dtype=wp.vec3i, ndim=2)  # and its triangles
    facet_count: wp.array(dtype=wp.int32)
    mass: wp.array(dtype=wide)
    inertia: wp.array(dtype=wide3)
    bound: wp.array(dtype=wide)
    rounding: wp.array(dtype=wide)


@wp.struct
class GroundClasses:
    """Laws of the ground, by class."""

    mu_min: wp.array(dtype=wide)
    mu_max: wp.array(dtype=wide)
    kappa: wp.array(dtype=wide)
    beta: wp.array(dtype=wide)
    drag: wp.array(dtype=wide)
    restitution: wp.array(dtype=wide)
    scar_modulus: wp.array(dtype=wide)
    scar_drag: wp.array(dtype=wide)


@wp.struct
class Obstacles:
    """Forest, trunks and screens."""

    stand_drag: wp.array(dtype=wide)
    stand_height: wp.array(dtype=wide)
    tree_start: wp.array(dtype=wp.int32)  # of each ground cell
    tree_member: wp.array(dtype=wp.int32)
    tree: wp.array(dtype=wide3)  # axis x, y and radius
    tree_top: wp.array(dtype=wide)
    tree_friction: wp.array(dtype=wide)
    # straight pieces of the barriers
    piece_from: wp.array(dtype=vec2)
    piece_to: wp.array(dtype=vec2)
    piece_barrier: wp.array(dtype=wp.int32)
    barrier_height: wp.array(dtype=wide)
    barrier_capacity: wp.array(dtype=wide)


@wp.struct
class Rules:
    """How trajectories are stepped; see rockfall.flights.Method."""

    duration: wide
    gravity: wide3
    dt: wide
    stride: wide
    tolerance: wide
    sweeps: int
    accelerate_from: int
    jump_angle: wide
    travel: wide  # most horizontal way in one pass: what it passes is near
    falling: wide  # time in which a fall from rest covers half of that
    lift: wide
    slop: wide
    rest_time: wide
    rest_move: wide


@wp.struct
class ResultGrid:
    """Cells in which passages are counted."""

    x: wide
    y: wide
    cell: wide
    per_metre: wide  # cells
    rows: int
    columns: int


@wp.struct
class Motion:
    """State of a rock."""

    position: wide3
    orientation: quat
    velocity: wide3
    spin: wide3  # along its own axes
    slip: wide  # s of the friction law [m]
    time: wide
    scar: wide  # depth of the scarring layer of this impact, 0 in the air
    step: wide  # length of the last step in contact [s]
    touching: int  # some percussion pressed in the last step
    near_ground: int  # some vertex was below the surface in the last step


@wp.struct
class Window:
    """Where a rock was at the start of its rest window."""

    position: wide3
    orientation: quat
    time: wide


@wp.struct
class Contact:
    """One closed contact of a step; vectors along the world's axes."""

    vertex: int  # whose percussion is kept, -1 for a trunk
    gap: wide
    friction: wide
    arm: wide3
    normal: wide3
    turn: wide33  # spin by a unit percussion: I^-1 arm~
    push: wide3  # change of the contact's own velocity by a unit normal percussion
    bias: wide  # restitution: eps min(0, approach at the step's start)
    normal_yield: wide  # G_NN
    normal_relief: wide  # and its inverse
    tangent_yield: wide  # largest eigenvalue of G_TT
    tangent_relief: wide
    limit: wide  # friction bound while frozen
    percussion: wide3


@wp.struct
class Iterates:
    """Anderson acceleration's memory of one contact."""

    before: wide3
    last: wide3
    change: wide3
    step1: wide3
    turn1: wide3
    step2: wide3
    turn2: wide3


@wp.struct
class Visit:
    """Largest values in a cell of results."""

    cell: int
    energy: wp.float32
    speed: wp.float32
    jump: wp.float32
    spin: wp.float32


@wp.struct
class Crossing:
    """A passage through a barrier."""

    barrier: int
    caught: int
    time: wide
    position: wide3
    height: wide
    energy: wide
    speed: wide
    spin: wide


@wp.struct
class Flights:
    """Rocks in motion, by slot."""

    rock: wp.array(dtype=wp.int32)
    fate: wp.array(dtype=wp.int32)
    motion: wp.array(dtype=Motion)
    window: wp.array(dtype=Window)
    count: wp.array(dtype=wp.int32, ndim=2)  # [slot, what]
    measure: wp.array(dtype=wide, ndim=2)
    percussion: wp.array(dtype=wide3, ndim=2)  # [slot, vertex], for the warm start
    contact: wp.array(dtype=Contact, ndim=2)  # [slot, contact]
    iterates: wp.array(dtype=Iterates, ndim=2)
    here: wp.array(dtype=Visit)  # the cell it is in
    visit: wp.array(dtype=Visit, ndim=2)  # [slot, visit], the cells it left in this launch
    visit_count: wp.array(dtype=wp.int32)
    crossing: wp.array(dtype=Crossing, ndim=2)
    crossing_count: wp.array(dtype=wp.int32)
