"""What a scene allows but probably does not mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.checks.cell import cell_frequency
from warpdem.checks.timestep import masses
from warpdem.filling.placement import first_flow
from warpdem.input.rules_bond import STRENGTHS
from warpdem.input.scene_references import meeting_groups

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from warpdem.arrays import FloatArray
    from warpdem.checks.timestep import TimeStep
    from warpdem.filling.placement import Placement
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene

SOFT = 0.05
"""Overlap under a body's own weight, or at impact, worth a warning, in bounding radii."""

LIGHT = 0.1
"""Part of a radian of the cell's own swing in one step worth a warning."""

LONG = 1e9
"""Number of steps worth a warning."""


def all_of(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    step: TimeStep | None,
) -> tuple[str, ...]:
    """The doubts about a placed scene, in words."""
    bound = np.array([shape.bound for shape in polyhedra.values()])[placement.shape]
    radii = bound * placement.scale
    return (
        *_idle(scene, placement, polyhedra),
        *_shells(placement, polyhedra),
        *_slippery(scene),
        *_stiff_contacts(scene, placement),
        *_steps(scene, step),
        *_soft(scene, placement, polyhedra, radii),
        *_light_cell(scene, placement, polyhedra, step),
    )


def _idle(scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> Iterator[str]:
    if len(placement.fixed) == 0:
        yield "there are no bodies"
    elif placement.fixed.all():
        yield "no body is free: nothing can change"
    used = {list(polyhedra)[k] for k in np.unique(placement.shape)}
    yield from (f'no body has the shape "{name}"' for name in polyhedra if name not in used)
    present = {placement.groups[k] for k in np.unique(placement.group)}
    for group in scene.group:
        if group.name not in present:
            yield f'no body is in the group "{group.name}"'


def _shells(placement: Placement, polyhedra: Mapping[str, Polyhedron]) -> Iterator[str]:
    """Free bodies whose faces enclose nothing, though there are several."""
    free = {list(polyhedra)[k] for k in np.unique(placement.shape[~placement.fixed])}
    for name, shape in polyhedra.items():
        if name in free and not shape.closed and len(shape.face_offsets) > 1:
            yield (
                f'shape "{name}" is open: its free bodies are shells of {shape.volume:.4g} m^3, as '
                "thick as twice its rounding; close its surface if a solid is meant"
            )


def _slippery(scene: Scene) -> Iterator[str]:
    for index, law in enumerate(scene.contact):
        if law.mu > 0.0 and law.kt == 0.0:
            yield f"contact[{index}]: kt = 0 leaves no friction in spite of mu = {law.mu:g}"


def _stiff_contacts(scene: Scene, placement: Placement) -> Iterator[str]:
    """Contacts stiffer than the breakable bonds they take over from."""
    table = scene.contact_table(placement.groups)
    springs = {pair for pair, law in table.items() if law.law != "custom"}
    meeting = [pair for pair in meeting_groups(scene) if pair in springs]
    free = {placement.groups[k] for k in np.unique(placement.group[~placement.fixed])}
    for index, bond in enumerate(scene.bond):
        if not any(getattr(bond, key) for key in STRENGTHS):
            continue
        for pair in meeting:
            kn = table[pair].kn
            if not bond.walls and not free.issuperset(pair):
                continue
            if bond.groups in (None, pair, pair[::-1]) and kn > bond.kn:
                yield (
                    f"bond[{index}]: kn = {bond.kn:g} N/m is less than that of the contacts of "
                    f'"{pair[0]}" and "{pair[1]}", {kn:g} N/m: a bond that breaks under '
                    "compression leaves more energy in the contact than it held"
                )


def _steps(scene: Scene, step: TimeStep | None) -> Iterator[str]:
    if step and step.message:
        yield step.message
    if step and scene.run.duration / step.dt > LONG:
        count = scene.run.duration / step.dt
        yield f"{count:.2g} steps: lower kn or run.duration, or take larger bodies"
    if scene.frame_interval > scene.run.duration:
        yield "output.every is longer than run.duration: only the start and the end are written"


def _soft(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    radii: FloatArray,
) -> Iterator[str]:
    """Contacts that weight or impact would press in deeply, each law by its worst body."""
    mass = masses(placement, polyhedra)[0]
    gravity = float(np.linalg.norm(scene.gravity.vector))
    speed = np.linalg.norm(placement.velocity - first_flow(scene, placement), axis=1)
    table = scene.contact_table(placement.groups)
    for pair in meeting_groups(scene):
        groups = [placement.groups.index(name) for name in pair if name in placement.groups]
        bodies = np.flatnonzero(~placement.fixed & np.isin(placement.group, groups))
        if pair not in table or len(bodies) == 0:
            continue
        kn = table[pair].kn
        rest = mass[bodies] * gravity / kn
        impact = speed[bodies] * np.sqrt(mass[bodies] / kn)
        for depth, cause in ((rest, "under its weight"), (impact, "at its initial velocity")):
            share = depth / radii[bodies]
            worst = int(np.argmax(share))
            if share[worst] > SOFT:
                name = placement.names[bodies[worst]]
                yield (
                    f'contacts of "{pair[0]}" and "{pair[1]}": kn = {kn:g} N/m lets "{name}" sink '
                    f"in by {share[worst]:.2g} times its radius {cause}"
                )


def _light_cell(
    scene: Scene,
    placement: Placement,
    polyhedra: Mapping[str, Polyhedron],
    step: TimeStep | None,
) -> Iterator[str]:
    """A cell whose own swing on a dense packing the step does not resolve."""
    if step and scene.cell and scene.cell.stress.components():
        turn = step.dt * cell_frequency(scene, placement, polyhedra)
        if turn > LIGHT:
            yield (
                f"cell.inertia: the cell swings on a dense packing by {turn:.2g} rad in one step; "
                f"raise it {(turn / LIGHT) ** 2:.2g} times, or lower run.dt"
            )
