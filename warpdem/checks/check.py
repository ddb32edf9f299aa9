"""What a scene would build and what is doubtful about it, without building it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpdem.bonds.creation import bonds_of
from warpdem.checks import doubts
from warpdem.checks.cell import spanning_axes
from warpdem.checks.custom_laws import check_custom_laws
from warpdem.checks.memory import expected_counts, memory_of
from warpdem.checks.overlap import overlaps_at_start
from warpdem.checks.report import Report, ShapeLine
from warpdem.checks.timestep import TimeStep, automatic_step, masses
from warpdem.errors import GeometryError, Problem, SceneError
from warpdem.features import features_of, stage_names
from warpdem.filling.placement import Placement, place
from warpdem.flow import flow_of
from warpdem.geometry.shapes import polyhedron_of
from warpdem.input.decode import problem_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from warpdem.bonds.creation import Interfaces
    from warpdem.checks.rockfall_report import RockfallReport
    from warpdem.geometry.polyhedron import Polyhedron
    from warpdem.input.scene import Scene


def check(scene: Scene) -> Report | RockfallReport:
    """What a scene would build: bodies, features, time step, memory, stages; and its doubts.

    Of a scene with run.method = "nonsmooth", what it would compute.

    Raises:
        SceneError: Shapes cannot be built from what the scene says, or bodies not be placed;
            carries all problems.
    """
    if scene.run.method == "nonsmooth":
        from warpdem.checks.rockfall import check_rockfall  # noqa: PLC0415 - it uses build_shapes

        return check_rockfall(scene)
    return check_smooth(scene)


def check_smooth(scene: Scene) -> Report:
    """What a scene with run.method = "smooth" would build; raises as ``check`` does."""
    check_custom_laws(scene)
    polyhedra = build_shapes(scene)
    flow_of(scene)
    placement = place(scene, polyhedra)
    step, interfaces, problems = _step(scene, placement, polyhedra)
    features = features_of(scene, placement, polyhedra)
    counts = expected_counts(scene, placement, polyhedra, features, interfaces)
    problems = [*problems, *_wall_problems(scene, placement, polyhedra)]
    mass = masses(placement, polyhedra)[0]
    start = overlaps_at_start(placement, polyhedra, scene.cell)
    near = f"bounding spheres that overlap at the start: {start.near} (pairs of bodies)"
    return Report(
        file=str(scene.source or "scene"),
        title=scene.title,
        shapes=_shape_lines(scene, placement, polyhedra),
        groups=_group_lines(placement),
        mass=float(mass[~placement.fixed].sum()),
        step=step,
        duration=scene.run.duration,
        frames=_frame_count(scene),
        memory=memory_of(features, counts),
        stages=stage_names(features),
        notes=(
            *(f'shape "{s.name}": {note}' for s in polyhedra.values() for note in s.notes),
            *placement.notes,
            *([near] if start.near else []),
        ),
        warnings=(*doubts.all_of(scene, placement, polyhedra, step), *start.warnings),
        problems=tuple(problems),
    )


def _wall_problems(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> list[Problem]:
    try:
        spanning_axes(scene, placement, polyhedra)
    except SceneError as error:
        return error.problems
    return []


def build_shapes(scene: Scene) -> dict[str, Polyhedron]:
    """The polyhedron of each shape by name, in the order of the scene.

    Raises:
        SceneError: Some shapes are no solids; carries a problem for each.
    """
    built: dict[str, Polyhedron] = {}
    problems: list[Problem] = []
    for index, shape in enumerate(scene.shape):
        try:
            built[shape.name] = polyhedron_of(shape, scene.directory)
        except GeometryError as error:
            problems.append(problem_at(scene, ("shape", index), str(error)))
    if problems:
        raise SceneError(str(scene.source or "scene"), problems)
    return built


def _step(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> tuple[TimeStep | None, Interfaces | None, list[Problem]]:
    bonds = None
    try:
        bonds = bonds_of(scene, placement, polyhedra)
        return automatic_step(scene, placement, polyhedra, bonds), bonds, []
    except SceneError as error:
        return None, bonds, error.problems


def _shape_lines(
    scene: Scene, placement: Placement, polyhedra: Mapping[str, Polyhedron]
) -> tuple[ShapeLine, ...]:
    lines = []
    for index, (name, shape) in enumerate(polyhedra.items()):
        fixed = placement.fixed[placement.shape == index]
        lines.append(
            ShapeLine(
                name,
                scene.shape[index].kind,
                int((~fixed).sum()),
                int(fixed.sum()),
                len(shape.vertices),
                len(shape.edges),
                len(shape.face_normals),
                shape.volume,
            )
        )
    return tuple(lines)


def _group_lines(placement: Placement) -> tuple[tuple[str, int, int], ...]:
    fixed = [placement.fixed[placement.group == k] for k in range(len(placement.groups))]
    counts = zip(placement.groups, fixed, strict=True)
    return tuple((name, int((~of).sum()), int(of.sum())) for name, of in counts if len(of))


def _frame_count(scene: Scene) -> int:
    # The last frame is at the end; a multiple within a billionth of it is the same one.
    return 1 + int(np.ceil(scene.run.duration / scene.frame_interval * (1.0 - 1e-9)))
