"""What a run shows of itself at one instant: NumPy arrays, free of Warp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    IntArray = NDArray[np.int32]
    BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Contacts:
    """Touching sub-contacts, sorted by pair and feature.

    Attributes:
        bodies: The two bodies i, j of each contact, shape [contact_count, 2].
        kind: 0 vertex-vertex, 1 vertex-edge, 2 edge-vertex, 3 vertex-face, 4 face-vertex,
            5 edge-edge (feature of i first), shape [contact_count].
        features: Index of the feature of i and of j in its shape, shape [contact_count, 2].
        point: Contact point, world [m], shape [contact_count, 3].
        normal: Unit normal from j to i, world, shape [contact_count, 3].
        gap: Signed distance, negative in overlap [m], shape [contact_count].
        normal_force: fn on i along the normal, positive repels [N], shape [contact_count].
        tangential_force: ft on i, world [N], shape [contact_count, 3].
        moment: Rolling moment on i, world [N m], shape [contact_count, 3].
        bonded: It is a bond; these come last, sorted alike, open or closed; shape [contact_count].
    """

    bodies: IntArray
    kind: IntArray
    features: IntArray
    point: FloatArray
    normal: FloatArray
    gap: FloatArray
    normal_force: FloatArray
    tangential_force: FloatArray
    moment: FloatArray
    bonded: BoolArray


@dataclass(frozen=True)
class Breakage:
    """The interfaces of a scene with bonds: which stand, when the others broke.

    Attributes:
        bodies: Owner and partner of each, shape [interface_count, 2].
        bond_count: Bonds of each while it stands, shape [interface_count].
        intact: Whether it stands, shape [interface_count].
        step, time: When it broke [1, s]; 0, NaN while it stands; shape [interface_count].
        mode: What broke it: 1 tension, 2 shear, 3 bending, 4 energy; shape [interface_count].
        released: Elastic energy that became neither motion nor a contact's [J], shape
            [interface_count].
        fragment: Lowest number of the free bodies that each body hangs together with, shape
            [body_count].
    """

    bodies: IntArray
    bond_count: IntArray
    intact: BoolArray
    step: IntArray
    time: FloatArray
    mode: IntArray
    released: FloatArray
    fragment: IntArray


@dataclass(frozen=True)
class Energy:
    """Energies of the free bodies and what entered or left since the start [J].

    ``bond`` is elastic energy in bonds, ``broken`` what went with those that broke; ``dashpot``
    holds the dashpots of bonds too. ``balance`` is kinetic + potential + elastic + bond +
    dissipated + broken - work of drivers, less its value at the start: zero but for the error of
    the time step.
    """

    kinetic: float
    potential: float
    elastic: float
    dashpot: float
    friction: float
    rolling: float
    work: float
    balance: float
    contact_count: int
    largest_overlap: float
    bond: float = 0.0
    broken: float = 0.0


@dataclass(frozen=True)
class Snapshot:
    """State of all bodies at one instant.

    Attributes:
        time: Simulated time [s].
        step: Number of steps done.
        position: Centres of mass, world [m], shape [body_count, 3].
        orientation: Unit quaternions w, x, y, z of the principal frames, body to world,
            shape [body_count, 4].
        velocity: Of the centres of mass [m/s], shape [body_count, 3].
        spin: Angular velocities, world [rad/s], shape [body_count, 3].
        force: Resultant contact and body force [N], shape [body_count, 3].
        torque: Resultant torque about the centre of mass, world [N m], shape [body_count, 3].
        contacts: The touching sub-contacts, when asked for.
        energy: The energy account, when the scene keeps one.
        breakage: The state of the bonds, when the scene has any.
    """

    time: float
    step: int
    position: FloatArray
    orientation: FloatArray
    velocity: FloatArray
    spin: FloatArray
    force: FloatArray
    torque: FloatArray
    contacts: Contacts | None = None
    energy: Energy | None = None
    breakage: Breakage | None = None
