"""How much memory the arrays of a run take, before they are allocated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from warpdem.driving.plan import block_steps, plan_of
from warpdem.errors import SceneError
from warpdem.features import tree_shapes
from warpdem.memory import bytes_of, bytes_of_search, bytes_per, copied_per, grown

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.bonds.creation import Interfaces
    from warpdem.features import Features
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene

PAIRS, CANDIDATES = 5, 12
"""Most pairs of each free body, and candidates of each of its vertices, while a heap of it settles.

By measurement: balls 4.7; cubes 3.9, 12; octahedra 5.6, 18; mixed blocks in a hopper 8, 50; with
slow bodies half as many.
"""

ROWS_OF_PAIRS = 3
"""Rows of near features of each pair, besides one of each candidate, by measurement."""

LISTED = ("pair", "candidate", "row")


@dataclass(frozen=True)
class Memory:
    """What the arrays of a run take on its device.

    Attributes:
        sizes: Bytes of a body, a pair and so on.
        copied: Those that are there twice while lists are renewed.
        counts: How many there are; of pairs and candidates, how many are expected in a heap
            that settles. The lists have head room beyond them.
        total: Bytes of all.
    """

    sizes: dict[str, int]
    copied: dict[str, int]
    counts: dict[str, int]
    total: int

    def __str__(self) -> str:
        units = ("body", "vertex", "pair", "candidate", "interface", "bond")
        each = [f"{self.sizes[per]} B a {per}" for per in units if self.counts.get(per)]
        return ", ".join(each).replace("a interface", "an interface")

    @property
    def renewing(self) -> int:
        """Bytes more while lists are renewed."""
        return sum(size * self.counts.get(per, 0) for per, size in self.copied.items())


def memory_of(has: Features, counts: dict[str, int]) -> Memory:
    """Memory of a scene with so many bodies, pairs and so on; the lists get their head room."""
    lists = {per: grown(count) for per, count in counts.items() if per in LISTED}
    return Memory(
        sizes=bytes_per(has),
        copied=copied_per(has),
        counts=counts,
        total=bytes_of(has, counts | lists) + bytes_of_search(counts["body"], counts["leaf"]),
    )


def expected_counts(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    has: Features,
    interfaces: Interfaces | None,
) -> dict[str, int]:
    """How many bodies, pairs and so on a scene has; pairs and candidates of a heap."""
    vertices = np.array([len(shape.vertices) for shape in polyhedra.values()], dtype=int)
    own = vertices[placement.shape]
    free = own[~placement.fixed]
    pairs = PAIRS * len(free) if has.contacts else 0
    candidates = pairs
    if has.polyhedra and has.contacts:
        candidates = int(np.maximum(CANDIDATES * free, PAIRS).sum())
    return {
        "body": len(own),
        "vertex": int(own.sum()),
        "pair": pairs,
        "candidate": candidates,
        "row": candidates + ROWS_OF_PAIRS * pairs if has.polyhedra else 0,
        "interface": len(interfaces) if interfaces else 0,
        "bond": len(interfaces.sites) if interfaces else 0,
        "law": len(placement.groups) ** 2,
        **_motion_counts(scene, placement, polyhedra),
        **_shape_counts(placement, list(polyhedra.values())),
    }


def _motion_counts(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> dict[str, int]:
    try:
        plan = plan_of(scene, placement, polyhedra)
    except SceneError:  # told as a problem of the step
        return {}
    driven = len(plan.bodies)
    return {"driven body": driven, "row of motion": driven * block_steps(driven)}


def _shape_counts(placement: Placement, shapes: list[Polyhedron]) -> dict[str, int]:
    vertices = sum(len(shape.vertices) for shape in shapes)
    edges = sum(len(shape.edges) for shape in shapes)
    trees = [shapes[k] for k in np.flatnonzero(tree_shapes(placement, shapes))]
    return {
        "shape": len(shapes),
        "vertex of a shape": vertices,
        "edge of a shape": edges,
        "face of a shape": sum(len(shape.face_offsets) for shape in shapes),
        "side of a shape": sum(len(shape.side_vertices) for shape in shapes),
        "vertex or edge": vertices + edges,
        "half-space": sum(len(shape.cone_planes) for shape in shapes),
        "leaf": sum(len(s.vertices) + len(s.edges) + len(s.face_offsets) for s in trees),
    }
