"""What the program must refuse, or stop with a name: bullets, overlaps, broken meshes, nonsense."""

from __future__ import annotations

import tempfile
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rig import HERE, Figure, Way, refusal, unclean

from warpdem.checks.check import check
from warpdem.errors import UnstableError, WarpdemError
from warpdem.input.decode import load

if TYPE_CHECKING:
    from collections.abc import Iterator

CHECK = 64
"""Steps within which a number that is none must be noticed."""


def bullet(way: Way) -> Iterator[Figure]:
    """A ball against a wall as thick as itself: back, or stopped by name; never through."""
    for speed in (1e2, 1e3, 1e4):
        for step in ("auto", 1e-6, 1e-5):
            dt = f'run.dt="{step}"' if isinstance(step, str) else f"run.dt={step!r}"
            end = 0.4 / speed + 2e-4
            changes = (dt, f"body.0.velocity={[0.0, 0.0, -speed]}", f"run.duration={end!r}")
            through, how = _shot(way, changes, end)
            yield Figure(f"{speed:g} m/s, dt {step}: through the wall", through, 0.0, how)


def _shot(way: Way, changes: tuple[str, ...], end: float) -> tuple[float, str]:
    """1.0 where the bullet got through or was stopped without its name; and what became of it."""
    try:
        simulation = way.simulation("bullet", *changes)
        simulation.advance(end)
    except WarpdemError as error:
        return float("bullet" not in str(error)), f"stopped: {str(error)[:70]}"
    shot = simulation.snapshot()
    back = shot.position[0, 2] > 0.0 and shot.velocity[0, 2] > 0.0
    return float(not back), f"leaves at {shot.velocity[0, 2]:.4g} m/s"


def overlaps(way: Way) -> Iterator[Figure]:
    """Two hundred balls that overlap by up to 2 R: an error that lists them; `relax` parts them."""
    tables = _thrown(way.pick(200, 40))
    message = refusal(lambda: way.simulation("overlaps", body=tables))
    yield Figure(
        "without relax: pairs not named", float(message.count("ball ") < 2), 0.0, message[:90]
    )
    simulation = way.simulation("overlaps", "run.relax={}", body=tables)
    fastest = 0.0
    for _ in range(20):
        simulation.advance(simulation.time + 0.05 / 20)
        fastest = max(fastest, float(np.abs(simulation.snapshot().velocity).max()))
    yield Figure("with relax: greatest speed [m/s]", fastest, 1.0)


def _thrown(count: int) -> list[dict[str, Any]]:
    """Balls at random places, so dense that many overlap, some nearly wholly."""
    random = np.random.default_rng(6)
    side = 0.1 * (count / 2.0) ** (1.0 / 3.0)
    places = random.uniform(0.0, side, (count, 3))
    return [
        {"name": f"ball {k}", "shape": "ball", "group": "ball", "position": place.tolist()}
        for k, place in enumerate(places)
    ]


def meshes(way: Way) -> Iterator[Figure]:
    """Shapes that are no solids: a named error or a documented repair, and then a clean run."""
    with tempfile.TemporaryDirectory() as folder:
        for what, shape in _broken_shapes(Path(folder)).items():
            yield Figure(f"{what}: neither refused by name nor repaired", *_told(way, shape))


def _told(way: Way, shape: dict[str, Any]) -> tuple[float, float, str]:
    """1.0, the gate 0.0, and what was said; 0.0 where it was said."""
    named = {"name": "thing", **shape}
    rest = way.scene("one").shape[1].model_dump(exclude_unset=True)

    def run() -> Any:
        simulation = way.simulation("one", "shape=[]", shape=[named, rest])
        simulation.advance(0.3)
        return simulation

    message = refusal(run)
    if message:
        return float("thing" not in message and "shape" not in message), 0.0, message[-100:]
    simulation = run()
    notes = [*simulation.polyhedra["thing"].notes, *check(simulation.scene).warnings]
    clean = unclean(simulation.snapshot()) == 0
    return float(not (notes and clean)), 0.0, f"runs; {'; '.join(notes)[:90] or 'no note'}"


def _broken_shapes(folder: Path) -> dict[str, dict[str, Any]]:
    """Wrong shapes by what is wrong with them."""
    flat = [[x, y, 0.0] for x in (0.0, 0.1) for y in (0.0, 0.1)]
    corners = [[x, y, z] for x in (0.0, 0.1) for y in (0.0, 0.1) for z in (0.0, 0.1)]
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    turned = [list(reversed(side)) for side in sides]
    fin = [*sides, [0, 1, 8]]
    twice = [*corners, corners[0]]
    doubled = [[8, 1, 3, 2], *sides[1:]]
    return {
        "zero volume": _polyhedron(flat, [[0, 2, 3, 1], [0, 1, 3, 2]]),
        "duplicate vertices": _polyhedron(twice, doubled),
        "all faces flipped": _polyhedron(corners, turned),
        "one face flipped": _polyhedron(corners, [turned[0], *sides[1:]]),
        "open": _polyhedron(corners, sides[1:]),
        "non-manifold": _polyhedron([*corners, [-0.1, -0.1, 0.05]], fin),
        "face out of plane": _polyhedron([*corners[:-1], [0.1, 0.1, 0.13]], sides),
        "no rounding": _polyhedron(corners, sides, rounding=0.0),
        "mesh, zero volume": _mesh(folder / "flat.obj", flat, [[0, 2, 3, 1], [0, 1, 3, 2]]),
        "mesh, duplicate vertices": _mesh(folder / "twice.obj", twice, doubled),
        "mesh, all faces flipped": _mesh(folder / "turned.obj", corners, turned),
        "mesh, one face flipped": _mesh(folder / "one.obj", corners, [turned[0], *sides[1:]]),
        "mesh, open": _mesh(folder / "open.obj", corners, sides[1:]),
        "mesh, non-manifold": _mesh(folder / "fin.obj", [*corners, [-0.1, -0.1, 0.05]], fin),
        "mesh, no rounding": _mesh(folder / "sharp.obj", corners, sides, rounding=0.0),
        "mesh, NaN": _mesh(folder / "nan.obj", [*corners[:-1], [float("nan")] * 3], sides),
        "mesh, empty": _mesh(folder / "empty.obj", [], []),
    }


def _polyhedron(
    vertices: list[list[float]], faces: list[list[int]], rounding: float = 0.01
) -> dict[str, Any]:
    return {"kind": "polyhedron", "vertices": vertices, "faces": faces, "rounding": rounding}


def _mesh(
    path: Path, vertices: list[list[float]], faces: list[list[int]], rounding: float = 0.01
) -> dict[str, Any]:
    lines = ["v " + " ".join(map(repr, vertex)) for vertex in vertices]
    triangles = [[face[0], *pair] for face in faces for pair in pairwise(face[1:])]
    lines += ["f " + " ".join(str(k + 1) for k in corner) for corner in triangles]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return {"kind": "mesh", "file": str(path), "rounding": rounding}


NONSENSE = {
    "position NaN": "body.0.position=[nan, 0.0, 0.2]",
    "velocity inf": "body.0.velocity=[inf, 0.0, 0.0]",
    "gravity NaN": "gravity.vector=[0.0, 0.0, nan]",
    "kn NaN": "contact.0.kn=nan",
    "kn 0": "contact.0.kn=0.0",
    "kt below 0": "contact.0.kt=-1.0",
    "mu below 0": "contact.0.mu=-0.1",
    "en2 above 1": "contact.0.en2=1.5",
    "density 0": "group.0.density=0.0",
    "density below 0": "group.0.density=-1.0",
    "quaternion not of unit length": "body.0.orientation=[1.0, 0.1, 0.0, 0.0]",
    "quaternion 0": "body.0.orientation=[0.0, 0.0, 0.0, 0.0]",
    "size 0": "shape.0.size=[0.1, 0.0, 0.1]",
    "dt 0": "run.dt=0.0",
    "dt NaN": "run.dt=nan",
    "duration below 0": "run.duration=-1.0",
}


def nonsense(way: Way) -> Iterator[Figure]:
    """Numbers that make no sense are refused when read; a NaN born later stops the run by name."""
    path = HERE / "scenes" / "one.toml"
    for what, change in NONSENSE.items():
        message = refusal(lambda change=change: load(path, [change]))
        key = change.partition("=")[0].rpartition(".")[2]
        yield Figure(f"{what}: not refused by its key", float(key not in message), 0.0)
    yield from _born(way)


def _born(way: Way) -> Iterator[Figure]:
    """A law that gives NaN from an overlap of .1 mm on."""
    law = [
        'contact.0.law="custom"',
        f'contact.0.file="{HERE / "nan_law.py"}"',
        'contact.0.normal="broken"',
        "contact.0.parameters=[1e-4]",
    ]
    simulation = way.simulation("one", "run.dt=1e-5", *law, drop="en2")
    name, late = "", np.inf
    try:
        while simulation.time < 0.5:
            # so that the step before is known
            before = simulation.step_count
            simulation.advance(simulation.time + simulation.dt * CHECK)
    except UnstableError as error:
        name, late = error.body, simulation.step_count - before
    yield Figure("NaN born in a run: body not named", float(name != "thing"), 0.0, f"names {name}")
    yield Figure("NaN born in a run: steps until it is noticed", float(late), CHECK)
