"""The bonds of a simulation on the device: allocation, breakage, checkpoints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import warp as wp

from warpdem.bonds.fragments import fragments
from warpdem.bonds.stiffness import highest
from warpdem.checks.restitution import zeta_bilateral
from warpdem.checks.timestep import masses, movable_masses
from warpdem.kernels.bond_bound import bond_bound
from warpdem.kernels.bonding import BROKEN, INTACT, YIELDED
from warpdem.kernels.precision import wide, wide3, wide4
from warpdem.kernels.release import release
from warpdem.kernels.views import BondLaw, Bonds, Joints
from warpdem.model import on
from warpdem.snapshot import Breakage
from warpdem.stages import laws

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from warpdem.arrays import BoolArray, FloatArray
    from warpdem.bonds.creation import Interfaces
    from warpdem.driving.plan import Plan
    from warpdem.features import Features
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.lists import Lists
    from warpdem.model import Model
    from warpdem.state import State

# what a checkpoint holds: of the interfaces, and of the bonds
OF_INTERFACES = ("state", "mode", "step", "force", "torque", "torque_partner", "energy", "power")
OF_BONDS = ("held", "viscous", "bent", "normal", "point", "gap")


class Bonding:
    """The interfaces of a simulation.

    Attributes:
        made: How they were made.
        bonds: Their arrays on the device (see kernels.views).
        joined: Interfaces of each body.
        time: When each broke [s], NaN before, shape [interface_count].
    """

    def __init__(
        self,
        scene: Scene,
        placement: Placement,
        polyhedra: Mapping[str, Polyhedron],
        made: Interfaces,
        features: Features,
        device: Any,
        *,
        plan: Plan,
    ) -> None:
        self.made = made
        self._device = device
        self.bonds = _allocate(made, features, len(placement.shape), device)
        decay = _decay(made, placement, movable_masses(placement, polyhedra, plan))
        self.bonds.law = _laws(scene, placement, polyhedra, made, decay, device)
        self.joined = _joined(made, len(placement.shape), device)
        self.time = np.full(len(made), np.nan)

    def __len__(self) -> int:
        return len(self.made)

    @property
    def standing(self) -> BoolArray:
        """Interfaces whose forces still act, shape [interface_count]."""
        return self.bonds.state.numpy() != BROKEN

    def resolve(self, model: Model, state: State, lists: Lists, *, dt: float, time: float) -> None:
        """Break what has yielded, after the lists were made anew; ``time`` is when it yielded."""
        yielded = self.bonds.state.numpy() == YIELDED
        if not yielded.any():
            return
        self.time[yielded] = time
        step = int(state.clock.steps.numpy()[0]) - 1
        wp.launch(
            release_kernel(model.features),
            dim=len(self),
            inputs=[
                model.geometry,
                model.materials,
                dt,
                step,
                lists.ends,
                state.bodies,
                lists.pairs,
            ],
            outputs=[lists.candidates, self.bonds],
            device=self._device,
        )

    def add_bound(self, model: Model, state: State, square: wp.array) -> None:
        """Add the bonds' part to the squares of the highest frequencies of the bodies [1/s^2]."""
        wp.launch(
            bond_bound,
            dim=model.body_count,
            inputs=[model.inertia, self.joined, state.bodies, self.bonds],
            outputs=[square],
            device=self._device,
        )

    def energies(self) -> tuple[float, float, float]:
        """Elastic energy now, lost in dashpots so far, released by breakage so far [J]."""
        energy = self.bonds.energy.numpy()
        elastic, lost, released = map(float, energy[:, [0, 2, 3]].sum(axis=0))
        return elastic, lost, released

    def breakage(self, free: BoolArray) -> Breakage:
        """What has broken so far and what hangs together."""
        bonds = self.bonds
        standing = self.standing
        return Breakage(
            bodies=self.made.bodies.astype(np.int32),
            bond_count=self.made.counts.astype(np.int32),
            intact=standing,
            step=bonds.step.numpy().copy(),
            time=self.time.copy(),
            mode=bonds.mode.numpy().copy(),
            released=bonds.energy.numpy()[:, 3].copy(),
            fragment=fragments(self.made.bodies[standing], free).astype(np.int32),
        )

    def arrays(self) -> dict[str, np.ndarray]:
        """Host copies of everything a step depends on."""
        names = (*OF_INTERFACES, *OF_BONDS)
        saved = {f"bond_{name}": getattr(self.bonds, name).numpy().copy() for name in names}
        return saved | {"bond_time": self.time.copy()}

    def put_back_states(self, saved: Mapping[str, np.ndarray]) -> None:
        """Which interfaces stood when the lists of a checkpoint were made."""
        state = saved["bond_state"]
        self.bonds.state.assign(np.where(state == YIELDED, INTACT, state).astype(np.int32))

    def put_back(self, saved: Mapping[str, np.ndarray]) -> bool:
        """Restore what ``arrays`` gave; whether some have yielded and wait to be broken."""
        for name in (*OF_INTERFACES, *OF_BONDS):
            getattr(self.bonds, name).assign(saved[f"bond_{name}"])
        self.time = saved["bond_time"].copy()
        return bool((saved["bond_state"] == YIELDED).any())


def release_kernel(has: Features) -> wp.Kernel:
    """The kernel that breaks interfaces, for the needs of a scene."""
    return release(laws(has), damping=has.bond_damping)


def _allocate(made: Interfaces, has: Features, body_count: int, device: Any) -> Bonds:
    bonds = Bonds()
    n, m = len(made), len(made.sites)
    owner, partner = made.bodies.T
    kind, (a, b) = made.sites.kind.astype(np.int64), made.sites.features.astype(np.int64).T
    bonds.owned = on(device, np.searchsorted(owner, np.arange(body_count + 1)), wp.int32)
    bonds.owner = on(device, owner, wp.int32)
    bonds.partner = on(device, partner, wp.int32)
    bonds.start = on(device, made.start, wp.int32)
    bonds.state = on(device, np.full(n, INTACT), wp.int32)
    for name in ("mode", "step"):
        setattr(bonds, name, wp.zeros(n, dtype=wp.int32, device=device))
    for name in ("force", "torque", "torque_partner"):
        setattr(bonds, name, wp.zeros(n, dtype=wide3, device=device))
    bonds.energy = wp.zeros(n, dtype=wide4, device=device)
    bonds.power = wp.zeros(n, dtype=wide, device=device)
    bonds.code = on(device, kind << 58 | a << 29 | b, wp.int64)
    bonds.rest = on(device, _rest(made, has), wide)
    bonds.held = wp.zeros(m, dtype=wide4, device=device)
    bonds.viscous = wp.zeros(m if has.bond_damping else 1, dtype=wide3, device=device)
    bonds.bent = wp.zeros(m if has.bond_moments else 1, dtype=wide4, device=device)
    bonds.normal = on(device, made.sites.normal, wide3)
    bonds.point = wp.zeros(m, dtype=wide3, device=device)
    bonds.gap = on(device, made.sites.gap, wide)
    return bonds


def _rest(made: Interfaces, has: Features) -> FloatArray:
    """Gaps without force: those at the start; Rockable's inner bonds pull open gaps shut."""
    rest = made.sites.gap.copy()
    if has.bond_creep:
        inner = np.array([bond.rule == "vertices" for bond in made.entries])[made.entry]
        rest[np.repeat(inner, made.counts)] = 0.0
    return rest


def _laws(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    made: Interfaces,
    decay: Callable[[FloatArray], FloatArray],
    device: Any,
) -> wp.array:
    rows: Any = np.zeros(len(made), dtype=BondLaw.numpy_dtype())
    for key in ("kn", "kt", "kr"):
        rows[key] = made.stiffness(key)
    for key in ("fn0", "ft0", "m0"):
        rows[key] = made.of(key, np.inf) * made.factor
    rows["power"] = made.of("power")
    for key, source in (("both", "gc"), ("stretching", "gc_normal"), ("shearing", "gc_tangential")):
        limit = made.of(source, np.inf)
        area = np.where(np.isfinite(limit), made.area, 1.0)
        rows[key] = 2.0 * area * limit * made.factor
    how = scene.run.resolved()
    zeta = np.array([_damping_ratio(bond) for bond in made.entries])[made.entry]
    mass = _masses(scene, placement, polyhedra, made)
    together = made.counts * rows["kn"] * np.sum(1.0 / mass, axis=1)
    alone = rows["kn"] * np.sum(1.0 / mass, axis=1)
    rows["tau"] = 2.0 * zeta / np.sqrt(together if how.damping == "pair" else alone)
    if how.contact_update == "predicted":
        rows["rate"] = 0.5 * rows["tau"] * together
        rows["decay"] = decay(rows["kn"] * rows["tau"])
    return wp.array(rows, dtype=BondLaw, device=device)


def _decay(
    made: Interfaces, placement: Placement, movable: tuple[FloatArray, FloatArray]
) -> Callable[[FloatArray], FloatArray]:
    """Fastest decay that dashpots cn on either body of an interface could cause [1/s]."""

    def decay(cn: FloatArray) -> FloatArray:
        rates = highest(made, placement, *movable, (cn, cn, 0.0 * cn))
        return rates[made.bodies].max(axis=1)

    return decay


def _damping_ratio(bond: Any) -> float:
    """A bond pulls as it pushes: the textbook's relation of restitution and damping is exact."""
    if bond.damping_ratio is not None:
        return float(bond.damping_ratio)
    return 0.0 if bond.en2 == 1.0 else zeta_bilateral(bond.en2**0.5)


def _masses(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    made: Interfaces,
) -> FloatArray:
    """Masses of the two bodies of each interface [kg], shape [interface_count, 2].

    Those of fixed bodies are infinite; Rockable takes the mass they would have for inner bonds.
    """
    mass = masses(placement, polyhedra)[0][made.bodies]
    if scene.run.compat == "rockable":
        shapes = list(polyhedra.values())
        volume = np.array([shape.volume for shape in shapes])[placement.shape] * placement.scale**3
        own = (volume * placement.density)[made.bodies]
        inner = np.array([bond.rule == "vertices" for bond in made.entries])[made.entry]
        mass = np.where(inner[:, None] & (own > 0.0), own, mass)
    return mass


def _joined(made: Interfaces, body_count: int, device: Any) -> Joints:
    """Interfaces of each body: 2 k + (1 where it is the partner), ascending."""
    ends = made.bodies.ravel()
    order = np.argsort(ends, kind="stable")
    joined = Joints()
    joined.start = on(device, np.searchsorted(ends[order], np.arange(body_count + 1)), wp.int32)
    joined.interface = on(device, order, wp.int32)
    return joined
