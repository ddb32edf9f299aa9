"""What a scene needs: the answers decide what is compiled, allocated and launched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from warpdem.input.scene_force import Drag, Fluid, NumericalDamping, VelocityBarrier

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Contact, Scene
    from warpdem.input.scene_run import Numerics

# a shape with more features than this, or more of one kind than the second number, is searched
# through a tree instead of one by one
TREE_FEATURES, TREE_KIND = 128, 64
# a body larger than this times the median free body is found through a tree, not the grid
LARGE_BODY = 4.0
# ratios of principal moments closer than this to 1 count as spherical inertia
SPHERICAL = 1e-12
# drifts of orientations at constant angular momentum, which torques kick
KICKED = ("no_squish", "rkmk4")
# laws of a spring and a dashpot
HOOKE = ("default", "sticked_links")


@dataclass(frozen=True)
class Features:
    """What must be compiled and allocated; a field that is False costs nothing."""

    contacts: bool
    polyhedra: bool
    convex: bool
    two_sided: bool
    cones: bool
    surfaces: bool
    trees: bool
    large: bool
    spherical: bool
    driven: bool
    controlled: bool
    stepwise: bool
    work: bool
    predicted: bool
    rotation: str
    fused: bool
    mixed: bool
    turns: bool
    first_step: str
    hooke: bool
    avalanche: bool
    custom: tuple[tuple[str, str], ...]
    damped: bool
    pair_damping: bool
    friction: bool
    elastic_cap: bool
    total_cap: bool
    objective: bool
    keep: bool
    partnership: str
    passive: bool
    rolling: bool
    branch_arm: bool
    cohesion: bool
    adhesion: bool
    sticky: bool
    reaching: bool
    documented: bool
    drag: bool
    fluid: bool
    trilinear: bool
    numerical_damping: bool
    velocity_barrier: bool
    spin_barrier: bool
    periodic: bool
    deforming: bool
    cell_sums: bool
    account: bool
    bonds: bool
    bond_damping: bool
    bond_moments: bool
    bond_creep: bool
    sleeps: bool

    @property
    def braking(self) -> bool:
        """Dashpots ask how many pairs act on a body."""
        return self.contacts and self.damped and self.predicted and not self.single

    @property
    def hot_lists(self) -> bool:
        """Pairs have more than one candidate."""
        return self.contacts and self.polyhedra

    @property
    def single(self) -> bool:
        """Every pair has one candidate, and a kernel of its own: see kernels.sphere_forces.

        Walls that follow a force ask for what touches them as a whole.
        """
        return self.contacts and not self.polyhedra and not self.controlled

    @property
    def central(self) -> bool:
        """Normals go through the centres of all bodies that turn."""
        return self.single and not self.driven

    @property
    def ending_spins(self) -> bool:
        """Spins are predicted for the end of a step: between spheres few laws ask for them."""
        on_bodies = self.numerical_damping or self.velocity_barrier or self.spin_barrier
        asked = self.account or self.turns or bool(self.custom) or on_bodies
        return self.predicted and (asked or not self.central)

    @property
    def once(self) -> bool:
        """Each vertex counts once: see kernels.regions and kernels.excess."""
        return self.contacts and self.partnership == "once"

    @property
    def shares(self) -> bool:
        """Contacts have a share of a pair's stiffness."""
        return self.partnership != "sum"

    @property
    def works(self) -> bool:
        """Account is kept of what drivers or forces on single bodies do."""
        return self.work or self.acted

    @property
    def acted(self) -> bool:
        """Account is kept of forces on single bodies."""
        barriers = self.velocity_barrier or self.spin_barrier
        return self.account and (self.drag or self.fluid or self.numerical_damping or barriers)


def features_of(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> Features:
    """The needs of a scene whose bodies have been placed."""
    shapes = list(polyhedra.values())
    used = [shapes[k] for k in np.unique(placement.shape)]
    free = ~placement.fixed
    table = scene.contact_table(placement.groups)
    laws = list(table.values())
    moving = placement.fixed & (placement.velocity.any(axis=1) | placement.spin.any(axis=1))
    how = scene.run.resolved()
    crowd = len(placement.shape) > 1 or scene.cell is not None
    polyhedral = any(len(shape.vertices) > 1 for shape in used)
    contacts = bool(laws) and bool(free.any()) and crowd
    return Features(
        contacts=contacts,
        polyhedra=polyhedral,
        convex=all(bool(np.all(shape.face_convex)) for shape in used),
        two_sided=any(shape.two_sided and len(shape.face_offsets) > 0 for shape in used),
        cones=any(len(shape.cone_planes) > 0 for shape in used),
        surfaces=any(shape.analytic is not None for shape in used),
        trees=bool(tree_shapes(placement, shapes).any()),
        large=bool((large_bodies(placement, shapes) & ~surface_bodies(placement, shapes)).any()),
        spherical=all(_is_spherical(shapes[k]) for k in np.unique(placement.shape[free])),
        fused=scene.run.arithmetic == "fused",
        mixed=scene.run.precision == "mixed",
        turns=_turns(scene, [shapes[k] for k in np.unique(placement.shape[free])]),
        account=scene.output.energy,
        sleeps=contacts and scene.run.sleep is not None,
        **_drivers(scene, moving=bool(moving.any())),
        **_cell(scene),
        **_bonds(scene),
        **_numerics(how, laws, free=not (contacts or scene.bond)),
        **_laws(scene, laws, polyhedra=polyhedral),
        **_forces(scene),
    )


def _turns(scene: Scene, moving: list[Polyhedron]) -> bool:
    """Whether orientations are followed: those of spheres only for who asks."""
    asked = scene.output.orientation
    if asked == "auto":
        asked = scene.output.table
    kicked = scene.run.resolved().rotation in {"auto", *KICKED}
    spheres = all(len(shape.vertices) == 1 and _is_spherical(shape) for shape in moving)
    return asked or bool(scene.bond) or not (spheres and kicked)


def _drivers(scene: Scene, *, moving: bool) -> dict[str, Any]:
    """What moves fixed bodies; ``moving``: some have a velocity or spin of their own."""
    driven = moving or bool(scene.driver)
    wanted = scene.output.energy or (bool(scene.driver) and scene.output.drivers)
    return {
        "driven": driven,
        "controlled": any(driver.kind in {"control", "pressure"} for driver in scene.driver),
        "stepwise": driven and scene.run.compat == "rockable",
        "work": driven and wanted,
    }


def _cell(scene: Scene) -> dict[str, Any]:
    """How space repeats itself."""
    cell = scene.cell
    deforming = cell is not None and cell.deforms
    held = cell is not None and bool(cell.stress.components())
    return {
        "periodic": cell is not None,
        "deforming": deforming,
        "cell_sums": deforming and (scene.output.energy or held),
    }


def _bonds(scene: Scene) -> dict[str, Any]:
    """What bonds need."""
    return {
        "bonds": bool(scene.bond),
        "bond_damping": any(bond.damping_ratio or bond.en2 < 1.0 for bond in scene.bond),
        "bond_moments": any(bond.kr > 0.0 for bond in scene.bond),
        "bond_creep": bool(scene.bond) and scene.run.compat == "rockable",
    }


def _numerics(how: Numerics, laws: list[Contact], *, free: bool) -> dict[str, Any]:
    """How the laws are stepped; ``free``: no body acts on another."""
    drift = "rkmk4" if free else "no_squish"
    damped = any(law.damped for law in laws)
    friction = any(law.mu > 0 and law.kt > 0 for law in laws)
    rolling = any(law.kr > 0 and law.mur > 0 for law in laws)
    capped = [how.friction_cap == "elastic" and elastic_cap(law) for law in laws]
    return {
        "predicted": how.contact_update == "predicted",
        "rotation": drift if how.rotation == "auto" else how.rotation,
        "first_step": how.first_step,
        "damped": damped,
        "pair_damping": damped and how.damping == "pair",
        "friction": friction,
        "elastic_cap": friction and any(capped),
        "total_cap": friction and not all(capped),
        "objective": how.friction_frame == "objective",
        "keep": how.opening == "keep",
        "passive": how.moving_shares == "passive",
        "rolling": rolling,
        "branch_arm": rolling and how.rolling_arm == "branch",
    }


def _laws(scene: Scene, laws: list[Contact], *, polyhedra: bool) -> dict[str, Any]:
    """Which laws there are; two spheres share nothing among several contacts."""
    own = {
        (str(scene.directory / (law.file or "")), law.normal or "") for law in laws if law.normal
    }
    reaching = any(law.dncut for law in laws)
    return {
        "hooke": any(law.law in HOOKE for law in laws),
        "avalanche": any(law.law == "avalanche" for law in laws),
        "custom": tuple(sorted(own)),
        "partnership": scene.partnership if polyhedra else "sum",
        "cohesion": any(law.attracts for law in laws),
        "adhesion": any(law.gamma > 0 for law in laws),
        "sticky": any(law.gamma > 0 or (law.fc > 0 and not law.dncut) for law in laws),
        "reaching": reaching,
        "documented": reaching and scene.run.cohesion == "documented",
    }


def elastic_cap(law: Contact) -> bool:
    """Whether ``friction_cap = "elastic"`` concerns a law.

    The programs that have that cap cut the friction of broken bonds and of cohesive contacts by
    the whole normal force.
    """
    return law.law == "default" and not law.attracts


def _forces(scene: Scene) -> dict[str, Any]:
    """What acts on single bodies."""
    barriers = [force for force in scene.force if isinstance(force, VelocityBarrier)]
    fluids = [force for force in scene.force if isinstance(force, Fluid)]
    return {
        "drag": any(isinstance(force, Drag) for force in scene.force),
        "fluid": bool(fluids),
        "trilinear": any(fluid.interpolation == "trilinear" for fluid in fluids),
        "numerical_damping": any(isinstance(force, NumericalDamping) for force in scene.force),
        "velocity_barrier": any(barrier.velocity is not None for barrier in barriers),
        "spin_barrier": any(barrier.spin is not None for barrier in barriers),
    }


def _many_features(shape: Polyhedron) -> bool:
    counts = len(shape.vertices), len(shape.edges), len(shape.face_offsets)
    return sum(counts) > TREE_FEATURES or max(counts) > TREE_KIND


def tree_shapes(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Which shapes are searched through a tree over their features, shape [shape_count] bool.

    Where some are, those of all large bodies too: a large body is the partner of any other, and the
    other may have too many features to be searched one by one.
    """
    used = np.zeros(len(shapes), dtype=bool)
    used[placement.shape] = True
    tree = used & np.array([_many_features(shape) for shape in shapes], dtype=bool)
    if tree.any():
        large = large_bodies(placement, shapes) & ~surface_bodies(placement, shapes)
        tree[placement.shape[large]] = True
    return tree


def surface_bodies(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Which bodies are analytic surfaces, shape [body_count] bool."""
    return np.array([shape.analytic is not None for shape in shapes], dtype=bool)[placement.shape]


def large_bodies(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Which bodies are too large for the grid, or analytic surfaces, shape [body_count] bool."""
    bound = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    free = ~placement.fixed
    surface = surface_bodies(placement, shapes)
    if not free.any():
        return surface
    return surface | (bound > LARGE_BODY * float(np.median(bound[free])))


def ranks(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Rank of each body, shape [body_count]; of two bodies the lower one owns the pair."""
    tree = tree_shapes(placement, shapes)[placement.shape]
    # surfaces are the partner of all others
    surface = surface_bodies(placement, shapes)
    order = np.lexsort((np.arange(len(tree)), tree, large_bodies(placement, shapes), surface))
    rank = np.empty(len(tree), dtype=np.int32)
    rank[order] = np.arange(len(tree))
    return rank


def _is_spherical(shape: Polyhedron) -> bool:
    moment = shape.inertia_over_mass
    return bool(np.ptp(moment) <= SPHERICAL * np.max(moment))


def stage_names(features: Features) -> tuple[str, ...]:
    """The stages of one step, in order."""
    cell = (*(["stress"] if features.cell_sums else []), *(["cell"] if features.deforming else []))
    if not features.contacts:
        return ("kick and drift", *cell)
    hot = ("hot lists",) if features.hot_lists else ()
    bonds = ("bond forces",) if features.bonds else ()
    forces = ("rebuild if moved", *hot, "pair forces", *bonds)
    return (*forces, *cell, "gather, kick and drift")
