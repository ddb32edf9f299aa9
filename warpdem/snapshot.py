"""What a run shows of itself at one instant: NumPy arrays, free of Warp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
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
            5 edge-edge, 6 vertex-surface (feature of i first), shape [contact_count].
        features: Index of the feature of i and of j in its shape, shape [contact_count, 2].
        point: Contact point, world [m], shape [contact_count, 3].
        normal: Unit normal from j to i, world, shape [contact_count, 3].
        gap: Signed distance, negative in overlap [m], shape [contact_count].
        normal_force: fn on i along the normal, positive repels [N], shape [contact_count]. What two
            edges do beside it where they end (kernels/excess.py) is in the bodies' forces alone.
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

    ``external`` is the work of forces on single bodies but gravity: drag, fluid, numerical damping,
    barriers; ``bond`` is elastic energy in bonds, ``broken`` what went with those that broke;
    ``dashpot`` holds the dashpots of bonds too. ``balance`` is kinetic + potential + elastic +
    bond + dissipated + broken - work of drivers - external, less its value at the start: zero but
    for the error of the time step.
    """

    kinetic: float
    potential: float
    elastic: float
    dashpot: float
    friction: float
    rolling: float
    work: float
    external: float
    balance: float
    contact_count: int
    largest_overlap: float
    bond: float = 0.0
    broken: float = 0.0


@dataclass(frozen=True)
class CellState:
    """The periodic cell at one instant; compression is positive.

    Attributes:
        centre: [m], shape [3].
        edges: H, its columns are the edges [m], shape [3, 3]; those of a cell that shears far are
            exchanged for shorter ones, which repeat the same space.
        periodic: Along which of them space repeats itself.
        velocity_gradient: L = H' H^-1 [1/s], shape [3, 3].
        deformation: Gradient of the deformation since the start, shape [3, 3].
        volume: [m^3].
        solid_fraction: Volume of the free bodies over that of the cell.
        contact_stress: Sum of f (x) d over the volume [Pa], shape [3, 3].
        kinetic_stress: Sum of m c (x) c over the volume, c = v - L x [Pa], shape [3, 3].
    """

    centre: FloatArray
    edges: FloatArray
    periodic: tuple[bool, ...]
    velocity_gradient: FloatArray
    deformation: FloatArray
    volume: float
    solid_fraction: float
    contact_stress: FloatArray
    kinetic_stress: FloatArray

    @property
    def stress(self) -> FloatArray:
        """Of contacts and motion together [Pa], shape [3, 3]."""
        return self.contact_stress + self.kinetic_stress

    def velocity_seen(self, points: FloatArray, velocity: FloatArray) -> FloatArray:
        """Velocity of the images that ``wrapped`` shows [m/s], shape [n, 3]."""
        return velocity + (self.wrapped(points) - points) @ self.velocity_gradient.T

    def wrapped(self, points: FloatArray) -> FloatArray:
        """The same points as seen in the cell [m], shape [n, 3]."""
        s = (points - self.centre) @ np.linalg.inv(self.edges).T
        return points - (np.floor(s + 0.5) * np.array(self.periodic)) @ self.edges.T


@dataclass(frozen=True)
class Snapshot:
    """State of all bodies at one instant.

    Attributes:
        time: Simulated time [s].
        step: Number of steps done.
        position: Centres of mass, world [m], shape [body_count, 3].
        orientation: Unit quaternions w, x, y, z of the principal frames, body to world,
            shape [body_count, 4]; of spheres only where output.orientation says so.
        velocity: Of the centres of mass [m/s], shape [body_count, 3].
        spin: Angular velocities, world [rad/s], shape [body_count, 3].
        force: Resultant contact and body force [N], shape [body_count, 3].
        torque: Resultant torque about the centre of mass, world [N m], shape [body_count, 3].
        contacts: The touching sub-contacts, when asked for.
        energy: The energy account, when the scene keeps one; its kinetic energy is that of the
            motion against the homogeneous flow of a periodic cell.
        cell: The periodic cell, when there is one; positions are not wrapped into it.
        work: What each body's driver has done [J], shape [body_count], when something is driven.
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
    cell: CellState | None = None
    work: FloatArray | None = None
    breakage: Breakage | None = None
