"""The same ground in several shapes: sliding over it, rebounding from it."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rig import Figure, Way

if TYPE_CHECKING:
    from collections.abc import Iterator

    from warpdem.simulation import Simulation
    from warpdem.snapshot import Snapshot

G, MU, WAY = 9.81, 0.3, 10.0
OVERLAP = G / 4e6
ROUNDING = 0.01
LOW, HIGH, ASIDE = -1.5, 13.5, 1.05
"""Ends of the ground along x, half of its width [m]."""
CELL = 0.15


def plane(way: Way) -> Iterator[Figure]:
    """10 m over one face, over a mesh and a raster of triangles; rebounds from four walls."""
    with tempfile.TemporaryDirectory() as folder:
        grounds = _grounds(Path(folder))
        one = grounds.pop("face")
        yield from _sliding(way, one, grounds)
        yield from _rebounds(way, {"face": one, **grounds})


def _sliding(way: Way, one: Any, others: dict[str, Any]) -> Iterator[Figure]:
    far = way.pick(WAY, 0.5)
    fast = 5.0
    for name, ground in {"face": one, **others}.items():
        simulation = _block(way, ground, [fast, 0.0, 0.0], "contact.0.mu=0.0")
        simulation.advance(far / fast)
        shot = simulation.snapshot()
        off = float(np.linalg.norm(shot.velocity[0] - [fast, 0.0, 0.0])) / fast
        spin = float(np.abs(shot.spin[0]).max())
        yield Figure(f"mu 0, {name}: |dv|/v over {far:g} m", off, 1e-9, f"spin {spin:.1e} rad/s")
    # so fast that friction stops it after that way
    fast = (2.0 * MU * G * far) ** 0.5
    stops = {}
    for name, ground in {"face": one, **others}.items():
        simulation = _block(way, ground, [fast, 0.0, 0.0])
        simulation.advance(1.2 * fast / (MU * G))
        stops[name] = simulation.snapshot().position[0]
    for name in others:
        off = float(np.linalg.norm(stops[name] - stops["face"]))
        yield Figure(f"mu .3, {name}: stop against that on one face [m]", off, 1e-6)
    off = abs(float(stops["face"][0]) / far - 1.0)
    yield Figure("mu .3: distance to the stop, relative", off, 1e-3)


def _rebounds(way: Way, grounds: dict[str, Any]) -> Iterator[Figure]:
    """A block falls askew on each: velocities and spins after the hit."""
    after: dict[str, Snapshot] = {}
    for name, ground in grounds.items():
        turned = "body.0.orientation=[0.9238795325112867, 0.3826834323650898, 0.0, 0.0]"
        place = "body.0.position=[0.031, 0.017, 0.085]"
        motion = [0.5, 0.2, -3.0]
        simulation = _block(way, ground, motion, turned, place, "gravity.vector=[0.0, 0.0, 0.0]")
        simulation.advance(0.03)
        after[name] = simulation.snapshot()
    for name, shot in after.items():
        if name == "face":
            continue
        off = float(np.linalg.norm(shot.velocity[0] - after["face"].velocity[0]) / 3.0)
        off += float(np.linalg.norm(shot.spin[0] - after["face"].spin[0])) * 0.05 / 3.0
        note = f"leaves at {shot.velocity[0, 2]:.3f} m/s"
        yield Figure(f"rebound from {name} against that from one face, relative", off, 1e-9, note)


def _block(way: Way, ground: Any, velocity: list[float], *changes: str) -> Simulation:
    """The block on a ground, as deep as its corners carry it unless it is placed elsewhere."""
    place = [f"body.0.position={[0.0, 0.0, 0.05 - OVERLAP]}"]
    shape, body = ground
    return way.simulation(
        "plane", *place, f"body.0.velocity={velocity}", *changes, shape=[shape], body=[body]
    )


def _grounds(folder: Path) -> dict[str, tuple[dict[str, Any], dict[str, Any]]]:
    """The same ground, its top at z = 0, in five shapes."""
    corners = [[LOW, -ASIDE], [HIGH, -ASIDE], [HIGH, ASIDE], [LOW, ASIDE]]
    face = {
        "kind": "polyhedron",
        "vertices": [[*corner, 0.0] for corner in corners],
        "faces": [[0, 1, 2, 3]],
        "rounding": ROUNDING,
    }
    mesh, raster = folder / "ground.obj", folder / "ground.asc"
    mesh.write_text(_mesh(), encoding="ascii")
    raster.write_text(_raster(), encoding="ascii")
    box = {"kind": "box", "size": [HIGH - LOW, 2.0 * ASIDE, 1.0], "rounding": ROUNDING}
    shapes = {
        "face": (face, [0.0, 0.0, -ROUNDING]),
        "mesh": ({"kind": "mesh", "file": str(mesh), "rounding": ROUNDING}, [0.0, 0.0, -ROUNDING]),
        "raster": ({"kind": "terrain", "file": str(raster)}, [0.0, 0.0, 0.0]),
        "plane": ({"kind": "plane"}, [0.0, 0.0, 0.0]),
        "box": (box, [0.5 * (LOW + HIGH), 0.0, -0.5]),
    }
    return {
        name: (
            {"name": "ground", **shape},
            {"shape": "ground", "group": "ground", "position": place, "fixed": True},
        )
        for name, (shape, place) in shapes.items()
    }


def _mesh() -> str:
    """Triangles of uneven sizes, their diagonals either way."""
    random = np.random.default_rng(5)
    x = np.arange(LOW, HIGH + 0.5 * CELL, CELL)
    y = np.arange(-ASIDE, ASIDE + 0.5 * CELL, CELL)
    nodes = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    nodes[1:-1, 1:-1] += random.uniform(-0.3, 0.3, nodes[1:-1, 1:-1].shape) * CELL
    lines = [f"v {a!r} {b!r} 0" for a, b in nodes.reshape(-1, 2).tolist()]
    for i in range(len(x) - 1):
        for j in range(len(y) - 1):
            a = i * len(y) + j + 1
            quad = (a, a + len(y), a + len(y) + 1, a + 1)
            cut = ((0, 1, 2), (0, 2, 3)) if random.random() < 0.5 else ((0, 1, 3), (1, 2, 3))
            lines += ["f " + " ".join(str(quad[k]) for k in corner) for corner in cut]
    return "\n".join(lines) + "\n"


def _raster() -> str:
    """Flat ground as an ESRI ASCII grid."""
    columns, rows = round((HIGH - LOW) / CELL) + 1, round(2.0 * ASIDE / CELL) + 1
    head = f"ncols {columns}\nnrows {rows}\nxllcorner {LOW}\nyllcorner {-ASIDE}\ncellsize {CELL}\n"
    return head + "\n".join(" ".join(["0"] * columns) for _ in range(rows)) + "\n"
