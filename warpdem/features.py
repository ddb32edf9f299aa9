"""What a scene needs: the answers decide what is compiled, allocated and launched."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Contact, Scene
    from warpdem.input.scene_run import Numerics

# a shape with more features than this is searched through a tree instead of one by one
TREE_FEATURES = 128
# a body larger than this times the median free body is found through a tree, not the grid
LARGE_BODY = 4.0
# ratios of principal moments closer than this to 1 count as spherical inertia
SPHERICAL = 1e-12


@dataclass(frozen=True)
class Features:
    """What must be compiled and allocated; a field that is False costs nothing."""

    contacts: bool
    polyhedra: bool
    convex: bool
    two_sided: bool
    cones: bool
    trees: bool
    large: bool
    spherical: bool
    driven: bool
    predicted: bool
    taylor: bool
    damped: bool
    pair_damping: bool
    friction: bool
    elastic_cap: bool
    objective: bool
    keep: bool
    gravity_first: bool
    rolling: bool
    branch_arm: bool
    cohesion: bool
    account: bool
    bonds: bool
    bond_damping: bool
    bond_moments: bool
    bond_creep: bool


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
    contacts = bool(laws) and bool(free.any()) and len(placement.shape) > 1
    friction = any(law.mu > 0 and law.kt > 0 for law in laws)
    return Features(
        contacts=contacts,
        polyhedra=any(len(shape.vertices) > 1 for shape in used),
        convex=all(bool(np.all(shape.face_convex)) for shape in used),
        two_sided=any(shape.two_sided and len(shape.face_offsets) > 0 for shape in used),
        cones=any(len(shape.cone_planes) > 0 for shape in used),
        trees=any(has_tree(shape) for shape in used),
        large=bool(large_bodies(placement, shapes).any()),
        spherical=all(_is_spherical(shapes[k]) for k in np.unique(placement.shape[free])),
        driven=bool(moving.any()),
        account=scene.output.energy,
        bonds=bool(scene.bond),
        bond_damping=any(bond.damping_ratio or bond.en2 < 1.0 for bond in scene.bond),
        bond_moments=any(bond.kr > 0.0 for bond in scene.bond),
        bond_creep=bool(scene.bond) and scene.run.compat == "rockable",
        **_numerics(how, laws, friction=friction),
    )


def _numerics(how: Numerics, laws: list[Contact], *, friction: bool) -> dict[str, bool]:
    damped = any(law.en2 < 1 for law in laws)
    rolling = any(law.kr > 0 and law.mur > 0 for law in laws)
    return {
        "predicted": how.contact_update == "predicted",
        "taylor": how.rotation == "taylor",
        "damped": damped,
        "pair_damping": damped and how.damping == "pair",
        "friction": friction,
        "elastic_cap": friction and how.friction_cap == "elastic",
        "objective": how.friction_frame == "objective",
        "keep": how.opening == "keep",
        "gravity_first": how.first_step == "gravity",
        "rolling": rolling,
        "branch_arm": rolling and how.rolling_arm == "branch",
        "cohesion": any(law.fc > 0 for law in laws),
    }


def has_tree(shape: Polyhedron) -> bool:
    """Whether a shape is searched through a tree over its features."""
    return len(shape.vertices) + len(shape.edges) + len(shape.face_offsets) > TREE_FEATURES


def large_bodies(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Which bodies are too large for the grid, shape [body_count] bool."""
    bound = np.array([shapes[k].bound for k in placement.shape]) * placement.scale
    free = ~placement.fixed
    if not free.any():
        return np.zeros(len(bound), dtype=bool)
    return bound > LARGE_BODY * float(np.median(bound[free]))


def ranks(placement: Placement, shapes: list[Polyhedron]) -> np.ndarray:
    """Rank of each body, shape [body_count]; of two bodies the lower one owns the pair."""
    tree = np.array([has_tree(shape) for shape in shapes])[placement.shape]
    order = np.lexsort((np.arange(len(tree)), tree, large_bodies(placement, shapes)))
    rank = np.empty(len(tree), dtype=np.int32)
    rank[order] = np.arange(len(tree))
    return rank


def _is_spherical(shape: Polyhedron) -> bool:
    moment = shape.inertia_over_mass
    return bool(np.ptp(moment) <= SPHERICAL * np.max(moment))


def stage_names(features: Features) -> tuple[str, ...]:
    """The stages of one step, in order."""
    if not features.contacts:
        return ("drift", "kick")
    bonds = ("bond forces",) if features.bonds else ()
    return ("drift", "rebuild if moved", "pair forces", *bonds, "gather and kick")
