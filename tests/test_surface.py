"""The drawn surface is closed, lies on the rounded solid, and has few polygons."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from solids import (
    CUBE_CORNERS,
    CUBE_FACES,
    CUP_FACES,
    ELL,
    TETRA_CORNERS,
    TETRA_FACES,
    frame,
    prism,
    split,
)

from warpdem.filling.clearance import distances
from warpdem.geometry.polyhedron import build
from warpdem.geometry.shapes import box
from warpdem.geometry.terrain import Raster, terrain

TWO_CUBES_IN_ONE_VERTEX = (
    [*CUBE_CORNERS, *(np.array(CUBE_CORNERS[:6] + CUBE_CORNERS[7:]) - 1.0).tolist()],
    [*CUBE_FACES, *([(8 + c - (c > 6)) if c != 6 else 0 for c in face] for face in CUBE_FACES)],
)
SOLIDS = {
    "cube": box("cube", (1.0, 1.0, 1.0), 0.1),
    "plate": box("plate", (1.0, 1.0, 0.2), 0.1),
    "capsule": box("capsule", (1.0, 0.2, 0.2), 0.1),
    "sphere": box("sphere", (0.2, 0.2, 0.2), 0.1),
    "tetra": build(TETRA_CORNERS, TETRA_FACES, name="tetra", radius=0.1),
    "ell": build(*prism(ELL, 1.0), name="ell", radius=0.1),
    "frame": build(*frame(), name="frame", radius=0.1),
    "cup": build(CUBE_CORNERS, CUP_FACES, name="cup", radius=0.1),
    "flat edges": build(
        CUBE_CORNERS, split(CUBE_FACES), name="flat", radius=0.1, repair=False, keep_features=True
    ),
    "pair": build(*TWO_CUBES_IN_ONE_VERTEX, name="pair", radius=0.1),
}


def polygons(surface):
    return np.split(surface.connectivity, surface.offsets[1:-1])


def side_count(surface):
    sides = Counter()
    for polygon in polygons(surface):
        sides.update(zip(polygon.tolist(), np.roll(polygon, -1).tolist(), strict=True))
    return sides


def enclosed(surface):
    """Volume inside a surface, by tetrahedra to the origin."""
    total = 0.0
    for polygon in polygons(surface):
        a, *others = surface.points[polygon]
        total += sum(a @ np.cross(b, c) for b, c in pairwise(others)) / 6.0
    return total


@pytest.mark.parametrize("name", SOLIDS)
def test_the_surface_is_closed_and_oriented(name):
    sides = side_count(SOLIDS[name].surface)

    assert all(sides[b, a] == count == 1 for (a, b), count in sides.items())


@pytest.mark.parametrize("name", SOLIDS)
def test_every_point_lies_at_the_rounding_from_the_core_or_inside(name):
    solid = SOLIDS[name]
    triangles = solid.vertices[solid.triangles[0]]
    if not len(triangles):  # a segment or a point
        triangles = solid.vertices[[[0, -1, -1]]]
    points = solid.surface.points
    pairs = np.repeat(points, len(triangles), axis=0)
    gap = distances(pairs, np.tile(triangles, (len(points), 1, 1)))
    gap = gap.reshape(len(points), -1).min(axis=1)

    assert gap.max() == pytest.approx(solid.radius, rel=1e-9)
    if solid.convex:
        assert gap.min() == pytest.approx(solid.radius, rel=1e-9)


@pytest.mark.parametrize("name", ["cube", "plate", "tetra", "sphere", "flat edges"])
def test_the_surface_encloses_nearly_the_volume(name):
    solid = SOLIDS[name]

    assert 0.95 * solid.volume < enclosed(solid.surface) < solid.volume


@pytest.mark.parametrize(
    ("name", "most"), [("cube", 150), ("sphere", 150), ("capsule", 100), ("plate", 150)]
)
def test_common_shapes_have_few_polygons(name, most):
    assert len(SOLIDS[name].surface.offsets) - 1 <= most


def test_a_sharp_solid_is_drawn_as_it_is():
    cube = box("cube", (1.0, 1.0, 1.0), 0.0)

    assert enclosed(cube.surface) == pytest.approx(1.0)


def test_wires_and_points_are_tubes_and_balls():
    wires = build(CUBE_CORNERS, [], name="wires", radius=0.1, edges=[[0, 1], [1, 2]])
    balls = build(CUBE_CORNERS[:2], [], name="balls", radius=0.1)

    assert len(wires.surface.offsets) - 1 == 2 * 84 + 5 * 150
    assert len(balls.surface.offsets) - 1 == 2 * 150


def test_sheets_that_meet_three_to_an_edge_are_drawn_as_pillows():
    corners = [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1], [-1, 1, 0], [-1, 1, 1]]
    corners += [[-1, -1, 0], [-1, -1, 1]]
    faces = [[0, 2, 3, 1], [0, 4, 5, 1], [0, 6, 7, 1]]
    mill = build(corners, faces, name="mill", radius=0.1, repair=False)
    sides = side_count(mill.surface)

    assert not mill.mass_known
    assert all(sides[b, a] == count == 1 for (a, b), count in sides.items())


def test_ground_is_drawn_by_its_triangles_at_the_rounding():
    heights = np.zeros((3, 4))
    ground = terrain(
        Raster(np.arange(4.0), np.arange(3.0)[::-1], heights, 1.0), name="g", radius=0.5
    )

    assert len(ground.surface.offsets) - 1 == 12
    assert ground.surface.points[:, 2] == pytest.approx(np.full(12, 0.5))
