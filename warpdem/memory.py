"""What a simulation holds on its device: each array, of what, its bytes, and when it is needed.

The allocation goes by this table (see warpdem.allocation), and so does the figure of ``check``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from warpdem.features import Features

SIZES = {
    "int": 4,
    "vec2i": 8,
    "vec3i": 12,
    "int64": 8,
    "uint64": 8,
    "real": 8,
    "vec3": 24,
    "vec4": 32,
    "quat": 32,
    "mat33": 72,
    "wide": 8,
    "wide3": 24,
    "wide4": 32,
    "wide33": 72,
    "Near": 32,
    "box": 24,
    "Material": 160,
    "BondLaw": 104,
}
"""Bytes of the types of the arrays' entries."""

NARROWED = SIZES | {"real": 4, "vec3": 12, "vec4": 16, "mat33": 36, "Material": 84}
"""The same in mixed precision."""

HEAD_ROOM, SPARE = 1.3, 64
"""A list that has to grow is made so many times as long as it must be, and so much longer."""


def grown(count: int) -> int:
    """Length of a list that has to grow to ``count``."""
    return int(count * HEAD_ROOM) + SPARE


def grid_side(free_count: int) -> int:
    """Cells of the search grid along each axis, for so many free bodies."""
    return int(np.clip(2 ** np.ceil(np.log2(max(free_count, 1) ** (1 / 3)) + 1), 8, 128))


@dataclass(frozen=True)
class Array:
    """An array of the device.

    Attributes:
        view: Whose it is: of kernels.views, or of a class of the host.
        per: Of what it has an entry each.
        kind: Type of its entries, of ``SIZES``.
        name: Within the view.
        when: Feature of the scenes that need it, or "not" and one; all where empty.
        times, more: It has so many entries each, and so many more.
        copied: It is there twice while the lists are renewed.
    """

    view: str
    per: str
    kind: str
    name: str
    when: str = ""
    times: int = 1
    more: int = 0
    copied: bool = False

    def needed(self, has: Features) -> bool:
        """Whether a scene needs it."""
        absent, name = self.when.startswith("not "), self.when.removeprefix("not ")
        return not name or bool(getattr(has, name)) != absent

    def length(self, count: int, has: Features) -> int:
        """Entries for ``count`` of what ``per`` says; one where the scene does not need it."""
        return self.times * count + self.more if self.needed(has) else 1

    def bytes_each(self, has: Features) -> int:
        """Bytes of each of what ``per`` says."""
        sizes = NARROWED if has.mixed else SIZES
        return self.times * sizes[self.kind] if self.needed(has) else 0


def _each(
    view: str,
    per: str,
    kind: str,
    names: str,
    when: str = "",
    **more: Any,
) -> Iterator[Array]:
    return (Array(view, per, kind, name, when, **more) for name in names.split())


ARRAYS = (
    # what moves
    *_each("bodies", "body", "wide3", "position momentum angular_momentum force torque velocity"),
    *_each("bodies", "body", "wide3", "spin velocity_end spin_end listed_position"),
    *_each("bodies", "body", "quat", "orientation listed_orientation"),
    *_each("bodies", "body", "mat33", "rotation"),
    *_each("bodies", "body", "wide", "reach"),
    *_each("bodies", "body", "int", "braked", "braking"),
    *_each("bodies", "body", "wide", "path", "hot_lists"),
    *_each("bodies", "vertex", "vec3", "arm"),
    *_each("sleep", "body", "int", "asleep woken deep", "sleeps"),
    *_each("sleep", "body", "wide", "slow taken allowed", "sleeps"),
    *_each("sleep", "body", "wide3", "force torque", "sleeps"),
    *_each("account", "body", "wide", "body_power work", "works"),
    *_each("account", "pair", "wide4", "pair power", "account"),
    # what does not
    *_each("geometry", "body", "int", "shape arm_start group rank large"),
    *_each("geometry", "body", "real", "scale radius"),
    *_each("geometry", "body", "wide", "bound"),
    *_each("inertia", "body", "wide", "mass inverse_mass"),
    *_each("inertia", "body", "wide3", "moment inverse_moment"),
    *_each("inertia", "body", "int", "driven"),
    *_each("external", "body", "wide", "drag", "drag"),
    *_each("external", "body", "wide", "fluid", "fluid"),
    *_each("model", "law", "Material", "materials"),
    *_each("room", "body", "wide", "half lever critical narrow", "contacts"),
    # the lists
    *_each("lists", "body", "int", "ends"),
    *_each("lists", "body", "int", "few", "not periodic", times=16),
    *_each("incidence", "body", "int", "start", more=1),
    *_each("incidence", "body", "wide3", "own_force own_torque", "single"),
    *_each("incidence", "pair", "int", "pair", times=2),
    *_each("lists", "pair", "int", "keys", times=2),
    *_each("pairs", "pair", "int", "partner", copied=True),
    *_each("pairs", "pair", "int", "owner material touching"),
    *_each("pairs", "pair", "int", "start", more=1, copied=True),
    *_each("pairs", "pair", "vec3i", "image", "periodic", copied=True),
    *_each("pairs", "pair", "int", "hot_end", "hot_lists"),
    *_each("pairs", "pair", "wide", "cold", "hot_lists"),
    *_each("pairs", "pair", "int", "looked", "braking", copied=True),
    *_each("pairs", "pair", "real", "fastest", "braking", copied=True),
    *_each("pairs", "pair", "vec3", "force torque_partner"),
    *_each("pairs", "pair", "vec3", "torque", "not single"),
    *_each("search", "pair", "Near", "near", "polyhedra"),
    *_each("search", "pair", "int", "rows", "polyhedra"),
    *_each("search", "row", "uint64", "hits", "polyhedra"),
    *_each("candidates", "candidate", "int64", "code", copied=True),
    *_each("candidates", "candidate", "wide4", "past", copied=True),
    *_each("candidates", "candidate", "wide4", "rolled", "rolling", copied=True),
    *_each("candidates", "candidate", "real", "share", "shares", copied=True),
    *_each("candidates", "candidate", "real", "last", "avalanche", copied=True),
    *_each("candidates", "candidate", "wide", "clear", "hot_lists"),
    *_each("candidates", "candidate", "int", "hot", "hot_lists"),
    *_each("candidates", "candidate", "int", "which"),
    *_each("candidates", "candidate", "vec3", "normal point"),
    *_each("candidates", "candidate", "real", "gap"),
    # a periodic cell
    *_each("images", "body", "vec3i", "home", "periodic"),
    *_each("images", "body", "wide3", "wrapped", "periodic"),
    *_each("cell", "body", "vec3i", "spanning", "periodic"),
    *_each("cell", "chunk", "wide33", "sums", "cell_sums"),
    # bonds
    *_each("bonds", "body", "int", "owned", "bonds", more=1),
    *_each("joined", "body", "int", "start", "bonds", more=1),
    *_each("joined", "interface", "int", "interface", "bonds", times=2),
    *_each("bonds", "interface", "int", "owner partner state mode step", "bonds"),
    *_each("bonds", "interface", "int", "start", "bonds", more=1),
    *_each("bonds", "interface", "BondLaw", "law", "bonds"),
    *_each("bonds", "interface", "wide3", "force torque torque_partner", "bonds"),
    *_each("bonds", "interface", "wide4", "energy", "bonds"),
    *_each("bonds", "interface", "wide", "power", "bonds"),
    *_each("bonds", "bond", "int64", "code", "bonds"),
    *_each("bonds", "bond", "wide", "rest gap", "bonds"),
    *_each("bonds", "bond", "wide4", "held", "bonds"),
    *_each("bonds", "bond", "wide3", "viscous", "bond_damping"),
    *_each("bonds", "bond", "wide4", "bent", "bond_moments"),
    *_each("bonds", "bond", "wide3", "normal point", "bonds"),
    # imposed motion: a row for each driven body and step of a block
    *_each("drives", "row of motion", "quat", "orientation", "driven"),
    *_each(
        "drives",
        "row of motion",
        "wide3",
        "position velocity spin velocity_end spin_end",
        "driven",
    ),
    *_each(
        "drives",
        "row of motion",
        "wide3",
        "force moment pressure loose loose_spin",
        "controlled",
    ),
    *_each(
        "drives",
        "driven body",
        "wide3",
        "inverse_mass inverse_inertia damping spin_damping offset",
        "controlled",
    ),
    *_each("drives", "driven body", "wide33", "now now_loose now_end", "controlled"),
    *_each("drives", "driven body", "wide", "area", "controlled", times=3),
    *_each("drives", "driven body", "quat", "turn", "controlled"),
    # shapes
    *_each("geometry", "shape", "int", "vertex_start edge_start face_start", more=1),
    *_each("geometry", "shape", "int", "two_sided surface"),
    *_each("geometry", "shape", "vec3", "core_middle core_half"),
    *_each("geometry", "shape", "real", "surface_radius"),
    *_each("geometry", "shape", "uint64", "tree"),
    *_each("geometry", "vertex of a shape", "vec3", "vertex"),
    *_each("geometry", "vertex of a shape", "int", "vertex_active"),
    *_each("geometry", "edge of a shape", "vec2i", "edge"),
    *_each("geometry", "edge of a shape", "int", "edge_active"),
    *_each("geometry", "edge of a shape", "real", "edge_half"),
    *_each("geometry", "face of a shape", "vec3", "normal"),
    *_each("geometry", "face of a shape", "real", "offset depth"),
    *_each("geometry", "face of a shape", "int", "face_convex"),
    *_each("geometry", "face of a shape", "int", "side_start", more=1),
    *_each("geometry", "side of a shape", "vec4", "side_above side_below"),
    *_each("geometry", "side of a shape", "int", "side_open"),
    *_each("geometry", "side of a shape", "vec2i", "side_vertex"),
    *_each("geometry", "vertex of a shape", "int", "spoke_start corner_start", "once", more=1),
    *_each("geometry", "edge of a shape", "int", "spoke", "once", times=2),
    *_each("geometry", "edge of a shape", "vec2i", "edge_sides", "once"),
    *_each("geometry", "side of a shape", "vec2i", "corner", "once"),
    *_each("geometry", "vertex or edge", "int", "cone_start", more=1),
    *_each("geometry", "half-space", "vec3", "cone"),
    # of a tree over the features of a shape
    *_each("tree", "leaf", "box", "box"),
)


def arrays_of(view: str, per: str) -> Iterator[Array]:
    """The arrays of a view that have an entry for each of what ``per`` says."""
    return (array for array in ARRAYS if (array.view, array.per) == (view, per))


def bytes_per(has: Features, arrays: Iterable[Array] = ARRAYS) -> dict[str, int]:
    """Bytes of a body, a pair and so on, of all that a scene needs."""
    found: dict[str, int] = {}
    for array in arrays:
        found[array.per] = found.get(array.per, 0) + array.bytes_each(has)
    return {per: size for per, size in found.items() if size}


def bytes_of(has: Features, counts: Mapping[str, int]) -> int:
    """Bytes of all arrays; ``counts`` are of bodies, pairs and so on, with their head room."""
    return sum(size * counts.get(per, 0) for per, size in bytes_per(has).items())


def copied_per(has: Features) -> dict[str, int]:
    """Bytes of a pair and a candidate of which copies are made while the lists are renewed."""
    return bytes_per(has, (array for array in ARRAYS if array.copied))


def bytes_of_search(free_count: int, leaf_count: int) -> int:
    """Bytes of Warp's hash grid (ends of cells, points with head room), and of its trees' nodes."""
    return 8 * grid_side(free_count) ** 3 + 24 * free_count + 80 * leaf_count
