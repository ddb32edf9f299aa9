"""The bonds of a placed scene: which bodies are glued, where, and how strongly."""

from __future__ import annotations

from dataclasses import dataclass
from math import gamma
from typing import TYPE_CHECKING

import numpy as np

from warpdem.bonds.rules import joint
from warpdem.bonds.sites import Sites, Solid, joined, near
from warpdem.checks.overlap import overlaps
from warpdem.errors import Problem, SceneError
from warpdem.features import ranks, surface_bodies
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray, IntArray
    from warpdem.bonds.rules import Joint
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene
    from warpdem.input.scene_bond import Bond

NAMED = 3
"""Pairs of bodies that a message names; the others are counted."""


@dataclass(frozen=True, eq=False)
class Interfaces:
    """All interfaces, sorted by owner and partner, and their bonds, one after the other.

    Attributes:
        bodies: Owner (of lower rank) and partner, shape [interface_count, 2].
        start: First bond of each interface, shape [interface_count + 1].
        sites: The bonds, from the owner's side, [bond_count].
        area: Of each interface [m^2], shape [interface_count].
        entry: Number of the [[bond]] it comes from, shape [interface_count].
        factor: Of its strengths, shape [interface_count].
        entries: The [[bond]] sections.
    """

    bodies: IntArray
    start: IntArray
    sites: Sites
    area: FloatArray
    entry: IntArray
    factor: FloatArray
    entries: tuple[Bond, ...]

    def __len__(self) -> int:
        return len(self.bodies)

    @property
    def counts(self) -> IntArray:
        """Number of bonds of each interface, shape [interface_count]."""
        return np.diff(self.start)

    def of(self, key: str, absent: float = 0.0) -> FloatArray:
        """A number of each interface's [[bond]], shape [interface_count]."""
        values = [getattr(bond, key) for bond in self.entries]
        known = [absent if value is None else value for value in values]
        return np.array(known, dtype=float)[self.entry]

    def stiffness(self, key: str) -> FloatArray:
        """kn, kt or kr of each single bond, shape [interface_count]."""
        shared = np.array([bond.share and key != "kr" for bond in self.entries])[self.entry]
        return self.of(key) / np.where(shared, self.counts, 1)


def bonds_of(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> Interfaces | None:
    """The bonds of a placed scene; None where it asks for none.

    Raises:
        SceneError: A [[bond]] joins nothing, two of them join the same bodies, or bonded vertices
            lie on top of one another; carries all.
    """
    if not scene.bond:
        return None
    shapes = list(polyhedra.values())
    solids: dict[int, Solid] = {}
    found: list[tuple[int, int, int, Joint]] = []
    for number, bond in enumerate(scene.bond):
        for i, j in _near_pairs(bond, placement, shapes):
            for body in (i, j):
                if body not in solids:
                    solids[body] = Solid(placement, shapes, body)
            if near(solids[i], solids[j], bond.tolerance):
                made = joint(bond, solids[i], solids[j])
                if len(made.sites):
                    found.append((i, j, number, made))
    problems = [
        *_barren(scene, placement, shapes, found),
        *_contested(scene, placement, found),
        *_flat(scene, placement, found),
    ]
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    return _sorted(scene, placement, shapes, found)


def _near_pairs(
    bond: Bond, placement: Placement, shapes: list[Polyhedron]
) -> Iterator[tuple[int, int]]:
    """Pairs of bodies that a [[bond]] is for and that may be near enough; sorted."""
    chosen = np.ones(len(placement.shape), dtype=bool)
    if bond.groups is not None:
        wanted = [placement.groups.index(g) for g in bond.groups if g in placement.groups]
        chosen = np.isin(placement.group, wanted)
    if not bond.walls:
        chosen &= ~placement.fixed
    members = np.flatnonzero(chosen)
    radius = np.array([shape.bound for shape in shapes])[placement.shape] * placement.scale
    reach = radius[members] + 0.5 * bond.tolerance
    pairs = overlaps(placement.position[members], reach, placement.fixed[members]).pairs
    pairs = np.sort(members[pairs], axis=1)
    same = placement.cluster[pairs[:, 0]] == placement.cluster[pairs[:, 1]]
    pairs = pairs[same == (bond.between == "inner")]
    for i, j in pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]:
        if bond.groups is None or _is_for(bond.groups, placement, i, j):
            yield int(i), int(j)


def _is_for(groups: tuple[str, ...], placement: Placement, i: int, j: int) -> bool:
    names = [placement.groups[placement.group[body]] for body in (i, j)]
    return sorted(names) == sorted(groups)


def _named(scene: Scene, number: int) -> str:
    return f'bond "{scene.bond[number].name}"' if scene.bond[number].name else f"bond[{number}]"


def _barren(
    scene: Scene,
    placement: Placement,
    shapes: list[Polyhedron],
    found: list[tuple[int, int, int, Joint]],
) -> Iterator[Problem]:
    made = {number for _, _, number, _ in found}
    surfaces = np.flatnonzero(surface_bodies(placement, shapes))
    for number, bond in enumerate(scene.bond):
        if number not in made:
            rule = (
                f"joins nothing: no two bodies for it come within {bond.tolerance:g} m by rule "
                f'"{bond.rule}"; raise tolerance, or look at cluster, groups, between and walls'
            )
            if scene.cell and any(scene.cell.periodic):
                rule += (
                    "; in a periodic cell bodies are bonded as they lie, not across its boundary"
                )
            own = [k for k in map(int, surfaces) if _concerns(bond, placement, k)]
            if own:
                rule += (
                    f'; "{placement.names[own[0]]}" is a surface given by a formula: planes, '
                    f"cylinders and balls have no features to bond to, use a box or a polyhedron"
                )
            yield problem_at(scene, ("bond", number), rule)


def _concerns(bond: Bond, placement: Placement, body: int) -> bool:
    """Whether a [[bond]] may be for a fixed body."""
    group = placement.groups[placement.group[body]]
    return bond.walls and (bond.groups is None or group in bond.groups)


def _contested(
    scene: Scene, placement: Placement, found: list[tuple[int, int, int, Joint]]
) -> Iterator[Problem]:
    first: dict[tuple[int, int], int] = {}
    contests: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for i, j, number, _ in found:
        holder = first.setdefault((i, j), number)
        if holder != number:
            contests.setdefault((holder, number), []).append((i, j))
    for (holder, number), pairs in contests.items():
        rule = (
            f"joins {_listed(placement, pairs)}, as {_named(scene, holder)} does: "
            f"tell them apart by groups or between"
        )
        yield problem_at(scene, ("bond", number), rule)


def _listed(placement: Placement, pairs: list[tuple[int, int]]) -> str:
    names = [f'"{placement.names[i]}" and "{placement.names[j]}"' for i, j in pairs[:NAMED]]
    more = f" and {len(pairs) - NAMED} more pairs" if len(pairs) > NAMED else ""
    return ", ".join(names) + more


def _flat(
    scene: Scene, placement: Placement, found: list[tuple[int, int, int, Joint]]
) -> Iterator[Problem]:
    """Bonds without direction, and interfaces whose fracture energy has no area to act on."""
    for number, bond in enumerate(scene.bond):
        own = [(i, j, made) for i, j, of, made in found if of == number]
        lost = [(i, j) for i, j, made in own if not np.all(made.sites.normal.any(axis=1))]
        if lost:
            rule = (
                f"vertices of {_listed(placement, lost)} lie on top of one another: the bond has "
                f'no direction; give the shapes a rounding, or use rule = "faces"'
            )
            yield problem_at(scene, ("bond", number), rule)
        bare = [(i, j) for i, j, made in own if made.area == 0.0]
        if bare and (bond.gc or bond.gc_normal or bond.gc_tangential):
            rule = (
                f"{_listed(placement, bare)} have no area in common (fewer than three bonds): a "
                f'fracture energy needs one; use rule = "faces", or fn0 and ft0'
            )
            yield problem_at(scene, ("bond", number), rule)


def _sorted(
    scene: Scene,
    placement: Placement,
    shapes: list[Polyhedron],
    found: list[tuple[int, int, int, Joint]],
) -> Interfaces:
    rank = ranks(placement, shapes)
    oriented = sorted(
        (i, j, number, made.sites, made.area)
        if rank[i] < rank[j]
        else (j, i, number, made.sites.swapped(), made.area)
        for i, j, number, made in found
    )
    counts = [len(sites) for _, _, _, sites, _ in oriented]
    entry = np.array([number for _, _, number, _, _ in oriented])
    return Interfaces(
        bodies=np.array([(i, j) for i, j, *_ in oriented], dtype=np.int32),
        start=np.concatenate([[0], np.cumsum(counts)]).astype(np.int32),
        sites=joined([_by_code(sites) for _, _, _, sites, _ in oriented]),
        area=np.array([area for *_, area in oriented]),
        entry=entry,
        factor=_factors(scene, entry),
        entries=scene.bond,
    )


def _by_code(sites: Sites) -> Sites:
    return sites[np.lexsort((sites.features[:, 1], sites.features[:, 0], sites.kind))]


def _factors(scene: Scene, entry: IntArray) -> FloatArray:
    """Weibull factors of mean 1; each interface's own, whatever the other entries are."""
    factor = np.ones(len(entry))
    for number, bond in enumerate(scene.bond):
        if bond.weibull is not None:
            own = np.flatnonzero(entry == number)
            draw = np.random.default_rng([scene.run.seed, number]).weibull(
                bond.weibull.modulus, len(own)
            )
            factor[own] = draw / gamma(1.0 + 1.0 / bond.weibull.modulus)
    return factor
