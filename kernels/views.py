"""What kernels see of the model and the state."""

import warp as wp
from warpdem.kernels.precision import (
    mat33,
    quat,
    real,
    vec3,
    vec4,
    vec8,
    wide,
    wide3,
    wide4,
    wide33,
)


@wp.struct
class Geometry:
    """Shapes (features in the principal frame, unscaled) and which body has which."""

    # of a shape; *_start have one entry more than there are shapes
    vertex_start: wp.array(dtype=wp.int32)
    edge_start: wp.array(dtype=wp.int32)
    face_start: wp.array(dtype=wp.int32)
    core_middle: wp.array(dtype=vec3)
    core_half: wp.array(dtype=vec3)
    tree: wp.array(dtype=wp.uint64)  # BVH over the features, 0 without
    two_sided: wp.array(dtype=wp.int32)
    # of a vertex
    vertex: wp.array(dtype=vec3)
    vertex_active: wp.array(dtype=wp.int32)
    # of an edge: its two vertices, counted within the shape
    edge: wp.array(dtype=wp.vec2i)
    edge_active: wp.array(dtype=wp.int32)
    edge_half: wp.array(dtype=real)  # half its length
    # of a face: unit normal and its offset n.v
    normal: wp.array(dtype=vec3)
    offset: wp.array(dtype=real)
    depth: wp.array(dtype=real)  # how far behind the face a vertex still belongs to it
    face_convex: wp.array(dtype=wp.int32)  # 1; 2: that of a convex solid
    side_start: wp.array(dtype=wp.int32)
    # of a side, a directed border edge of a face: inside is m.x <= o, above and below the face
    side_above: wp.array(dtype=vec4)
    side_below: wp.array(dtype=vec4)
    side_open: wp.array(dtype=wp.int32)  # a point on the border belongs to the other face
    side_vertex: wp.array(dtype=wp.vec2i)
    # where vertices count once: the sides of faces along an edge, or -1; of a vertex its edges,
    # counted within the shape, and the two sides there of each of its faces
    edge_sides: wp.array(dtype=wp.vec2i)
    spoke_start: wp.array(dtype=wp.int32)  # one entry more than there are vertices
    spoke: wp.array(dtype=wp.int32)
    corner_start: wp.array(dtype=wp.int32)
    corner: wp.array(dtype=wp.vec2i)
    # half-spaces of the directions in which a terrain's vertex or edge may touch
    cone_start: wp.array(dtype=wp.int32)
    cone: wp.array(dtype=vec3)
    # of a shape that is an analytic surface: which (codes.py), 0 for others, and its radius
    surface: wp.array(dtype=wp.int32)
    surface_radius: wp.array(dtype=real)
    # of a body
    shape: wp.array(dtype=wp.int32)
    scale: wp.array(dtype=real)
    radius: wp.array(dtype=real)  # rounding, scaled
    # bounding sphere about the centre of mass, rounding included; of a surface that moves: the
    # distance of the farthest body when the lists were made
    bound: wp.array(dtype=wide)
    arm_start: wp.array(dtype=wp.int32)
    group: wp.array(dtype=wp.int32)
    rank: wp.array(dtype=wp.int32)  # of two bodies the lower one owns the pair
    large: wp.array(dtype=wp.int32)  # a surface, or found through the tree of large bodies


@wp.struct
class Inertia:
    """Masses; zero inverses stand for fixed and driven bodies."""

    mass: wp.array(dtype=wide)  # 0 where the inverse is
    inverse_mass: wp.array(dtype=wide)
    moment: wp.array(dtype=wide3)
    inverse_moment: wp.array(dtype=wide3)
    driven: wp.array(dtype=wp.int32)  # place among the driven bodies + 1; 0 for all others


@wp.struct
class Sleep:
    """Bodies that stand still until the wrench of their contacts changes, see sleep.py.

    Arrays are those of bodies; there are none where nothing may sleep.
    """

    speed: wide  # of the farthest point, below which a body is slow [m/s]
    after: wide  # for how long it is so before it falls asleep [s]
    tolerance: wide  # change of the force that wakes it, over its weight or largest contact force
    asleep: wp.array(dtype=wp.int32)  # 1: it stands still; so do fixed bodies that nothing drives
    deep: wp.array(dtype=wp.int32)  # 1: so do all bodies in its pairs, nothing need be looked at
    slow: wp.array(dtype=wide)  # for how long it has been [s]
    # when it fell asleep: wrench of its contacts, and the change of the force that wakes it; this
    # is negative while it is awake
    force: wp.array(dtype=wide3)
    torque: wp.array(dtype=wide3)
    allowed: wp.array(dtype=wide)
    woken: wp.array(dtype=wp.int32)  # how often it was
    taken: wp.array(dtype=wide)  # kinetic energy that it lost by falling asleep [J]


@wp.struct
class Bodies:
    """State of the bodies."""

    position: wp.array(dtype=wide3)
    orientation: wp.array(dtype=quat)
    momentum: wp.array(dtype=wide3)
    angular_momentum: wp.array(dtype=wide3)
    force: wp.array(dtype=wide3)
    torque: wp.array(dtype=wide3)
    # derived in the drift
    rotation: wp.array(dtype=mat33)
    velocity: wp.array(dtype=wide3)  # at the half step
    spin: wp.array(dtype=wide3)
    velocity_end: wp.array(dtype=wide3)  # predicted for the end of the step
    spin_end: wp.array(dtype=wide3)
    arm: wp.array(dtype=vec3)  # vertices about the centre of mass, world axes
    braked: wp.array(dtype=wp.int32)  # number of pairs that acted in the last pass
    # way of the farthest point since the lists were made, where there are hot lists [m]
    path: wp.array(dtype=wide)
    reach: wp.array(dtype=wide)  # its part of the skin: so far it may go from where it was listed
    # where the lists were made
    listed_position: wp.array(dtype=wide3)
    listed_orientation: wp.array(dtype=quat)
    sleep: Sleep


@wp.struct
class Drives:
    """Imposed motion of the driven bodies, and what those move by that follow a force.

    Rows are of a step and a driven body, at (step - base) * count + place.
    """

    count: int
    base: wp.array(dtype=wp.int32)  # first step of the rows
    steps: wp.array(dtype=wp.int32)  # number of steps done, of the first host thread's clock
    # imposed, rows: at the step's end; velocities also at the half step
    position: wp.array(dtype=wide3)
    orientation: wp.array(dtype=quat)
    velocity: wp.array(dtype=wide3)
    spin: wp.array(dtype=wide3)
    velocity_end: wp.array(dtype=wide3)
    spin_end: wp.array(dtype=wide3)
    # imposed on those that follow a force, rows, along the world's axes
    force: wp.array(dtype=wide3)  # at the step's end [N]
    moment: wp.array(dtype=wide3)  # [N m]
    pressure: wp.array(dtype=wide3)  # to be multiplied by the area [Pa]
    loose: wp.array(dtype=wide3)  # 1 where the axis follows the force during the step, else 0
    loose_spin: wp.array(dtype=wide3)
    # of a driven body, along the world's axes; inverses are 0 where no force moves it
    inverse_mass: wp.array(dtype=wide3)
    inverse_inertia: wp.array(dtype=wide3)
    damping: wp.array(dtype=wide3)
    spin_damping: wp.array(dtype=wide3)
    # of a driven body: the rows of the present step, for the kick
    now: wp.array(dtype=wide33)  # force, moment, pressure in its rows
    now_loose: wp.array(dtype=wide33)  # loose, loose_spin in its first two
    now_end: wp.array(dtype=wide33)  # velocity_end, spin_end in its first two
    area: wp.array(dtype=wide)  # a pressure acts on, at 3 place + axis [m^2]
    # state: how far a force has moved it from the imposed motion
    offset: wp.array(dtype=wide3)
    turn: wp.array(dtype=quat)


@wp.struct
class Gauge:
    """A rectangle between two pairs of walls: where its area goes, and how it is measured."""

    place: int  # in Drives.area
    low: wp.vec2i  # body on the lower side of each pair
    high: wp.vec2i
    axis: wp.vec2i
    less: wp.vec2d  # distance of the centres less the clear width [m]


@wp.struct
class Pairs:
    """Body pairs near enough to touch before the next rebuild, sorted by owner and partner."""

    owner: wp.array(dtype=wp.int32)
    partner: wp.array(dtype=wp.int32)
    image: wp.array(dtype=wp.vec3i)  # of the partner, in a periodic cell
    material: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.int32)  # first candidate; one entry more than there are pairs
    hot_end: wp.array(dtype=wp.int32)  # of the hot candidates, which begin where the others do
    cold: wp.array(dtype=wide)  # path of both bodies after which others may touch [m]
    touching: wp.array(dtype=wp.int32)  # number of touching candidates
    force: wp.array(dtype=vec3)  # on the owner
    torque: wp.array(dtype=vec3)  # on the owner, about its centre of mass
    torque_partner: wp.array(dtype=vec3)  # on the partner, about its own
    # of the last look at its modes (braking.py): how many touched, and the fastest one
    looked: wp.array(dtype=wp.int32)
    fastest: wp.array(dtype=real)  # square of its frequency, per stiffness [1/kg]


@wp.struct
class Cell:
    """The periodic cell, one entry each; image n of a body lies at x + edges n."""

    centre: wp.array(dtype=wide3)
    spanning: wp.array(dtype=wp.vec3i)  # of a body: axes along which it has no images
    edges: wp.array(dtype=wide33)  # H, its columns [m]
    rate: wp.array(dtype=wide33)  # H' at the half step
    rate_end: wp.array(dtype=wide33)  # predicted for the end of the step
    acceleration: wp.array(dtype=wide33)  # A: bodies are accelerated by A x
    jump: wp.array(dtype=wide33)  # of the velocity gradient at the end of the step
    gradient: wp.array(dtype=wide33)  # L at the end of the step
    time: wp.array(dtype=wide)
    lattice: wp.array(dtype=wide33)  # integers U: edges are those of the start, deformed, times U
    # since the lists were made: their edges, F = H H_listed^-1, |F - 1|
    listed: wp.array(dtype=wide33)
    since: wp.array(dtype=wide33)
    stretch: wp.array(dtype=wide)
    # control: rates given; 1 where a stress is; that stress, compression positive
    given: wp.array(dtype=wide33)
    held: wp.array(dtype=wide33)
    target: wp.array(dtype=wide33)
    inertia: wp.array(dtype=wide)  # M of M L' = V (stress - target) - M damping L [kg m^2]
    damping: wp.array(dtype=wide)
    start: wp.array(dtype=wide)
    stop: wp.array(dtype=wide)
    # partial sums of the volume times the stress; work done on the bodies
    sums: wp.array(dtype=wide33)
    power: wp.array(dtype=wide)
    work: wp.array(dtype=wide)


@wp.struct
class Candidates:
    """Feature pairs of the body pairs, and what the contacts remember."""

    code: wp.array(dtype=wp.int64)  # kind << 58 | feature of owner << 29 | feature of partner
    past: wp.array(dtype=wide4)  # tangential force and normal force; -1 when it did not touch
    rolled: wp.array(dtype=wide4)  # rolling moment: tangent part, and about the normal
    share: wp.array(dtype=real)  # of the pair's stiffness, where shares move
    last: wp.array(dtype=real)  # gap of the last step, where a law needs it
    clear: wp.array(dtype=wide)  # path of both bodies before which it cannot touch [m]
    # of the hot ones, and of the touching ones, packed from the start of the pair's slice
    hot: wp.array(dtype=wp.int32)
    which: wp.array(dtype=wp.int32)
    normal: wp.array(dtype=vec3)
    point: wp.array(dtype=vec3)  # about the partner's centre of mass
    gap: wp.array(dtype=real)


@wp.struct
class Incidence:
    """Pairs of each body (incidence.py): as partner in CSR, as owner in the slices of the lists.

    ``own_force`` and ``own_torque`` are the sums over the pairs it owns, where the pair kernel
    makes them: for spheres.
    """

    start: wp.array(dtype=wp.int32)
    pair: wp.array(dtype=wp.int32)
    ends: wp.array(dtype=wp.int32)
    own_force: wp.array(dtype=wide3)
    own_torque: wp.array(dtype=wide3)


@wp.struct
class Joints:
    """Interfaces of each body: 2 interface + (1 where the body is the partner), in CSR."""

    start: wp.array(dtype=wp.int32)
    interface: wp.array(dtype=wp.int32)


@wp.struct
class Material:
    """Contact parameters of a pair of groups [N/m, 1, N m/rad, N, m, J/m^2]."""

    kind: wp.int32  # HOOKE, AVALANCHE, CUSTOM + number: see laws.py
    elastic_cap: wp.int32  # friction is cut by k d instead of the whole normal force
    kn: real
    kt: real
    mu: real
    zeta: real
    en2: real
    kr: real
    mur: real
    fc: real
    dncut: real
    gamma: real
    exponent: real  # of the p-norm
    parameters: vec8  # of a custom law


@wp.struct
class Clock:
    """What the host reads between batches of steps, one number each.

    Host threads share ``moved`` and ``fault``; each has its own of the others.
    """

    moved: wp.array(dtype=wp.int32)  # some body went farther
    fault: wp.array(dtype=wp.int32)  # some body moved more than its own size in one step
    halted: wp.array(dtype=wp.int32)  # steps are skipped until the host has looked
    steps: wp.array(dtype=wp.int32)
    left: wp.array(dtype=wp.int32)  # steps that are still to be done before the host looks
    going: wp.array(dtype=wp.int32)  # the loop goes on


@wp.struct
class External:
    """Forces on single bodies: coefficients of each body, and what all share."""

    drag: wp.array(dtype=wide)  # [kg/m]
    fluid: wp.array(dtype=wide)  # friction against the flow [kg/m]
    flow: wp.array(dtype=wide3, ndim=3)  # velocity of the fluid at the nodes of a grid [m/s]
    origin: wide3  # its first node [m]
    spacing: wide3
    damping: wide
    speed_limit: wide
    speed_exponent: wide
    spin_limit: wide
    spin_exponent: wide


@wp.struct
class Account:
    """Energies: of a pair (elastic now; dashpot, friction, rolling since), of a driver or force.

    A pair's powers [W] of this instant have been counted for a whole step, half of it ahead.
    ``body_power`` and ``work`` are, of a driven body, what its motion does; of a free one, what
    the external forces but gravity do on it.
    """

    pair: wp.array(dtype=wide4)
    power: wp.array(dtype=wide4)
    body_power: wp.array(dtype=wide)
    work: wp.array(dtype=wide)


@wp.struct
class BondLaw:
    """Parameters of an interface's bonds [N/m, N m/rad, s, 1/s, N, N m, J]; inf: unbreakable."""

    kn: wide
    kt: wide
    kr: wide
    tau: wide  # of the dashpots: their force is kn tau times the velocity
    rate: wide  # zeta omega of the pair: share of its own force a bond takes implicitly, a second
    decay: wide  # fastest that dashpots of its bodies could make a mode decay
    fn0: wide
    ft0: wide
    m0: wide
    power: wide
    stretching: wide  # energies beyond which the interface breaks
    shearing: wide
    both: wide


@wp.struct
class Bonds:
    """Interfaces sorted by owner and partner, and their bonds; they never change places."""

    # of a body: its first interface as owner; one entry more than there are bodies
    owned: wp.array(dtype=wp.int32)
    # of an interface
    owner: wp.array(dtype=wp.int32)
    partner: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.int32)  # first bond; one entry more than there are interfaces
    law: wp.array(dtype=BondLaw)
    state: wp.array(dtype=wp.int32)  # BROKEN, INTACT or YIELDED
    mode: wp.array(dtype=wp.int32)  # what broke it
    step: wp.array(dtype=wp.int32)  # at which it broke
    force: wp.array(dtype=wide3)  # on the owner
    torque: wp.array(dtype=wide3)  # on the owner, about its centre of mass
    torque_partner: wp.array(dtype=wide3)
    energy: wp.array(dtype=wide4)  # elastic, its rate, lost in dashpots, released
    power: wp.array(dtype=wide)  # of the dashpots
    # of a bond
    code: wp.array(dtype=wp.int64)  # as that of a candidate
    rest: wp.array(dtype=wide)  # gap without force
    held: wp.array(dtype=wide4)  # elastic tangential force, and normal force
    viscous: wp.array(dtype=wide3)  # tangential force of the dashpot
    bent: wp.array(dtype=wide4)  # moment: tangent part, and about the normal
    normal: wp.array(dtype=wide3)
    point: wp.array(dtype=wide3)  # about the partner's centre of mass
    gap: wp.array(dtype=wide)
