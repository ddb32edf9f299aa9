"""What kernels see of the model and the state."""

import warp as wp
from warpdem.kernels.precision import mat33, quat, real, vec3, vec4


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
    face_convex: wp.array(dtype=wp.int32)
    side_start: wp.array(dtype=wp.int32)
    # of a side, a directed border edge of a face: inside is m.x <= o, above and below the face
    side_above: wp.array(dtype=vec4)
    side_below: wp.array(dtype=vec4)
    side_open: wp.array(dtype=wp.int32)  # a point on the border belongs to the other face
    side_vertex: wp.array(dtype=wp.vec2i)
    # half-spaces of the directions in which a terrain's vertex or edge may touch
    cone_start: wp.array(dtype=wp.int32)
    cone: wp.array(dtype=vec3)
    # of a body
    shape: wp.array(dtype=wp.int32)
    scale: wp.array(dtype=real)
    radius: wp.array(dtype=real)  # rounding, scaled
    bound: wp.array(dtype=real)  # bounding sphere about the centre of mass, rounding included
    arm_start: wp.array(dtype=wp.int32)
    group: wp.array(dtype=wp.int32)
    rank: wp.array(dtype=wp.int32)  # of two bodies the lower one owns the pair
    large: wp.array(dtype=wp.int32)  # found through the tree of large bodies, not the grid


@wp.struct
class Inertia:
    """Masses; zero inverses stand for fixed and driven bodies."""

    inverse_mass: wp.array(dtype=real)
    moment: wp.array(dtype=vec3)
    inverse_moment: wp.array(dtype=vec3)
    driven: wp.array(dtype=wp.int32)


@wp.struct
class Bodies:
    """State of the bodies."""

    position: wp.array(dtype=vec3)
    orientation: wp.array(dtype=quat)
    momentum: wp.array(dtype=vec3)
    angular_momentum: wp.array(dtype=vec3)
    force: wp.array(dtype=vec3)
    torque: wp.array(dtype=vec3)
    # derived in the drift
    rotation: wp.array(dtype=mat33)
    velocity: wp.array(dtype=vec3)  # at the half step
    spin: wp.array(dtype=vec3)
    velocity_end: wp.array(dtype=vec3)  # predicted for the end of the step
    spin_end: wp.array(dtype=vec3)
    arm: wp.array(dtype=vec3)  # vertices about the centre of mass, world axes
    # where the lists were made
    listed_position: wp.array(dtype=vec3)
    listed_orientation: wp.array(dtype=quat)


@wp.struct
class Pairs:
    """Body pairs near enough to touch before the next rebuild, sorted by owner and partner."""

    owner: wp.array(dtype=wp.int32)
    partner: wp.array(dtype=wp.int32)
    material: wp.array(dtype=wp.int32)
    start: wp.array(dtype=wp.int32)  # first candidate; one entry more than there are pairs
    touching: wp.array(dtype=wp.int32)  # number of touching candidates
    force: wp.array(dtype=vec3)  # on the owner
    torque: wp.array(dtype=vec3)  # on the owner, about its centre of mass
    torque_partner: wp.array(dtype=vec3)  # on the partner, about its own


@wp.struct
class Candidates:
    """Feature pairs of the body pairs, and what the contacts remember."""

    code: wp.array(dtype=wp.int64)  # kind << 58 | feature of owner << 29 | feature of partner
    past: wp.array(dtype=vec4)  # tangential force and normal force; -1 when it did not touch
    rolled: wp.array(dtype=vec4)  # rolling moment: tangent part, and about the normal
    # of the touching ones, packed from the start of the pair's slice
    which: wp.array(dtype=wp.int32)
    normal: wp.array(dtype=vec3)
    point: wp.array(dtype=vec3)  # about the partner's centre of mass
    gap: wp.array(dtype=real)


@wp.struct
class Incidence:
    """Pairs of each body: 2 pair + (1 where the body is the partner), in CSR."""

    start: wp.array(dtype=wp.int32)
    pair: wp.array(dtype=wp.int32)


@wp.struct
class Material:
    """Contact parameters of a pair of groups [N/m, 1, N m/rad, N]."""

    kn: real
    kt: real
    mu: real
    zeta: real
    kr: real
    mur: real
    fc: real


@wp.struct
class Clock:
    """What the host reads between batches of steps, one number each.

    Host threads share ``reach``, ``moved`` and ``fault``; each has its own ``halted``, ``steps``.
    """

    reach: wp.array(dtype=real)  # half of the skin: how far a body may go from where it was listed
    moved: wp.array(dtype=wp.int32)  # some body went farther
    fault: wp.array(dtype=wp.int32)  # some body moved more than its own size in one step
    halted: wp.array(dtype=wp.int32)  # steps are skipped until the host has looked
    steps: wp.array(dtype=wp.int32)


@wp.struct
class Account:
    """Energies: of a pair (elastic now; dashpot, friction, rolling since), of a driver."""

    pair: wp.array(dtype=vec4)
    power: wp.array(dtype=real)
    work: wp.array(dtype=real)


@wp.struct
class BondLaw:
    """Parameters of an interface's bonds [N/m, N m/rad, s, 1/s, N, N m, J]; inf: unbreakable."""

    kn: real
    kt: real
    kr: real
    tau: real  # of the dashpots: their force is kn tau times the velocity
    rate: real  # zeta omega of the pair: share of its own force a bond takes implicitly, a second
    decay: real  # fastest that dashpots of its bodies could make a mode decay
    fn0: real
    ft0: real
    m0: real
    power: real
    stretching: real  # energies beyond which the interface breaks
    shearing: real
    both: real


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
    force: wp.array(dtype=vec3)  # on the owner
    torque: wp.array(dtype=vec3)  # on the owner, about its centre of mass
    torque_partner: wp.array(dtype=vec3)
    energy: wp.array(dtype=vec4)  # elastic, its rate, lost in dashpots, released
    power: wp.array(dtype=real)  # of the dashpots
    # of a bond
    code: wp.array(dtype=wp.int64)  # as that of a candidate
    rest: wp.array(dtype=real)  # gap without force
    held: wp.array(dtype=vec4)  # elastic tangential force, and normal force
    viscous: wp.array(dtype=vec3)  # tangential force of the dashpot
    bent: wp.array(dtype=vec4)  # moment: tangent part, and about the normal
    normal: wp.array(dtype=vec3)
    point: wp.array(dtype=vec3)  # about the partner's centre of mass
    gap: wp.array(dtype=real)
