"""Cores as given become cores that can be simulated, or are refused with a reason."""

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
    rotation,
    soup,
    split,
)

from warpdem.errors import GeometryError
from warpdem.geometry.orientation import matrix
from warpdem.geometry.polyhedron import build


def cube(faces=CUBE_FACES, corners=CUBE_CORNERS, **options):
    return build(corners, faces, name="cube", radius=0.1, **options)


def test_sides_run_counter_clockwise_about_outward_normals():
    solid = cube()

    for face in solid.faces:
        a, b, c = solid.vertices[face.loops[0][:3]]
        assert np.cross(b - a, c - b) @ face.normal > 0.0
        assert face.normal @ a > 0.0


def test_neighbours_share_the_side_the_other_way_round():
    solid = cube()
    owner = np.repeat(np.arange(6), np.diff(solid.side_start))

    for side, (a, b) in enumerate(solid.side_vertices):
        other = solid.side_neighbour[side]
        rows = range(solid.side_start[other], solid.side_start[other + 1])
        (back,) = [row for row in rows if tuple(solid.side_vertices[row]) == (b, a)]
        assert solid.side_neighbour[back] == owner[side]


def test_facets_of_any_orientation_are_turned_outward():
    turned = [face[::-1] if k % 2 else face for k, face in enumerate(CUBE_FACES)]
    solid = cube(turned)

    assert np.all(solid.face_offsets > 0.0)
    assert solid.notes == ("turned 3 facets outward",)


def test_a_cavity_keeps_its_faces_toward_the_void():
    outer, inner = 2.0 * np.array(CUBE_CORNERS) - 1.0, np.array(CUBE_CORNERS) - 0.5
    faces = [*CUBE_FACES, *([corner + 8 for corner in face] for face in CUBE_FACES)]
    solid = build(np.concatenate([outer, inner]), faces, name="hollow", radius=1e-3)

    assert solid.face_offsets == pytest.approx([1.0] * 6 + [-0.5] * 6)
    assert solid.closed
    assert not solid.convex


def test_a_triangle_soup_of_a_cube_becomes_six_faces():
    corners, triangles = soup(CUBE_CORNERS, split(CUBE_FACES))
    solid = cube(triangles, corners)

    assert (len(solid.vertices), len(solid.edges), len(solid.face_normals)) == (8, 12, 6)
    assert solid.convex
    assert solid.edge_active.all()
    assert "welded 28 duplicate vertices" in solid.notes
    assert "merged 12 coplanar facets into 6 faces" in solid.notes


def test_single_precision_does_not_split_faces():
    corners, triangles = soup(
        np.array(CUBE_CORNERS) @ rotation(3).T + [7.0, -3.0, 1.0], split(CUBE_FACES)
    )
    solid = cube(triangles, corners.astype(np.float32))

    assert len(solid.face_normals) == 6


def test_a_finely_divided_cube_loses_the_vertices_on_its_edges():
    ticks = np.linspace(0.0, 1.0, 5)
    u, v = (grid.ravel() for grid in np.meshgrid(ticks, ticks, indexing="ij"))
    number = np.arange(25).reshape(5, 5)
    quads = np.stack(
        [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1
    ).reshape(-1, 4)
    one, zero = np.ones(25), np.zeros(25)
    sides = [(one, u, v), (v, one, u), (u, v, one), (zero, v, u), (u, zero, v), (v, u, zero)]
    vertices = np.concatenate([np.column_stack(side) for side in sides])
    solid = cube(np.concatenate([quads + 25 * k for k in range(6)]), vertices)

    assert (len(solid.vertices), len(solid.edges), len(solid.face_normals)) == (8, 12, 6)


def test_a_hole_becomes_a_second_loop_of_its_face():
    solid = build(*frame(), name="frame", radius=0.05)
    top = int(np.argmax(solid.face_normals[:, 2]))

    assert [len(loop) for loop in solid.faces[top].loops] == [4, 4]
    assert not solid.face_convex[top]
    assert len(solid.face_normals) == 10
    triangles, face = solid.triangles
    a, b, c = solid.vertices[triangles[face == top]].transpose(1, 0, 2)
    area = 0.5 * np.cross(b - a, c - a)
    assert np.all(area[:, 2] > 0.0)
    assert area.sum(axis=0) == pytest.approx([0.0, 0.0, 8.0])


def test_a_face_that_touches_itself_in_a_vertex_keeps_its_area():
    number = np.arange(16).reshape(4, 4)
    cells = [(x, y) for x in range(3) for y in range(3) if (x, y) not in {(0, 0), (1, 1)}]
    quads = [
        [number[x, y], number[x + 1, y], number[x + 1, y + 1], number[x, y + 1]] for x, y in cells
    ]
    plan = [[x, y, 0] for x in range(4) for y in range(4)]
    plate = build(plan, split(quads), name="plate", radius=0.1)
    triangles, _ = plate.triangles
    a, b, c = plate.vertices[triangles].transpose(1, 0, 2)

    assert len(plate.face_normals) == 1
    assert np.sum(plate.side_vertices[:, 0] == plate.side_vertices[:, 1]) == 0
    assert 0.5 * np.abs(np.cross(b - a, c - a)[:, 2]).sum() == pytest.approx(7.0)
    assert plate.mass_known


def test_a_facet_without_area_joins_its_neighbour():
    corners = [*CUBE_CORNERS, [0.5, 0.0, 0.0]]
    faces = [[0, 3, 2, 1], [0, 1, 8], [8, 1, 5, 4, 0], *CUBE_FACES[1:2], *CUBE_FACES[3:]]
    solid = cube(faces, corners)

    assert (len(solid.vertices), len(solid.face_normals)) == (8, 6)
    assert solid.volume == pytest.approx(cube().volume, rel=1e-12)


def test_duplicate_facets_are_dropped():
    solid = cube([*CUBE_FACES, CUBE_FACES[0]])

    assert len(solid.face_normals) == 6
    assert "dropped 1 duplicate facet" in solid.notes


def test_concave_edges_and_vertices_touch_nothing():
    solid = build(*prism(ELL, 1.0), name="ell", radius=0.05)
    concave = solid.edges[~solid.edge_active]

    assert len(solid.edges) == 18
    assert len(concave) == 1
    ends = solid.frame_origin + solid.vertices[concave[0]] @ matrix(solid.frame_rotation).T
    assert sorted(ends.tolist()) == [pytest.approx([1.0, 1.0, z]) for z in (0.0, 1.0)]
    assert solid.vertex_active.all()  # their other edges are convex


def test_all_features_of_an_open_surface_touch():
    cup = build(CUBE_CORNERS, CUP_FACES, name="cup", radius=0.05)

    assert cup.two_sided
    assert not cup.closed
    assert cup.edge_active.all()
    assert cup.vertex_active.all()
    assert np.sum(cup.side_neighbour < 0) == 4


def test_declared_mass_leaves_everything_as_it_is():
    corners = np.add(CUBE_CORNERS, [3.0, 0.0, 0.0])
    solid = build(
        corners,
        split(CUBE_FACES),
        name="cube",
        radius=0.1,
        edges=[[6, 7], [0, 1]],
        declared=(2.0, (0.1, 0.2, 0.3)),
        keep_features=True,
    )

    assert np.array_equal(solid.vertices, corners)
    assert solid.edges.tolist() == [[6, 7], [0, 1]]
    assert len(solid.face_normals) == 12
    assert (solid.volume, solid.inertia_over_mass.tolist()) == (2.0, [0.1, 0.2, 0.3])
    assert solid.frame_origin.tolist() == [0.0, 0.0, 0.0]
    assert solid.edge_active.all()


def test_the_principal_frame_leads_back_to_the_file():
    corners = np.array(CUBE_CORNERS) * [1.0, 2.0, 3.0] @ rotation(5).T + [10.0, 20.0, 30.0]
    solid = cube(corners=corners)
    back = solid.frame_origin + solid.vertices @ matrix(solid.frame_rotation).T

    assert back == pytest.approx(corners, abs=1e-12)
    assert sorted(solid.inertia_over_mass) == pytest.approx(
        sorted(cube(corners=np.array(CUBE_CORNERS) * [1.0, 2.0, 3.0]).inertia_over_mass), rel=1e-12
    )


def test_the_bounding_sphere_holds_the_rounded_solid():
    solid = cube()

    assert solid.bound == pytest.approx(np.sqrt(0.75) + 0.1)
    assert solid.core_min == pytest.approx([-0.5] * 3)
    assert solid.core_max == pytest.approx([0.5] * 3)


def test_points_and_segments_are_solids():
    ball = build([[1.0, 2.0, 3.0]], [], name="ball", radius=0.5)
    rod = build([[0, 0, 0], [2, 0, 0]], [], name="rod", radius=0.5, edges=[[0, 1]])

    assert ball.vertices.tolist() == [[0.0, 0.0, 0.0]]
    assert ball.frame_origin.tolist() == [1.0, 2.0, 3.0]
    assert (len(rod.vertices), len(rod.edges), len(rod.face_normals)) == (2, 1, 0)
    assert rod.convex
    assert ball.convex


def test_a_core_has_no_mass_without_thickness():
    plate = build(CUBE_CORNERS[:4], [[0, 1, 2, 3]], name="plate", radius=0.0)

    assert not plate.mass_known


@pytest.mark.parametrize(
    ("vertices", "faces", "reason"),
    [
        ([[0, 0, np.nan]], [], "vertex 0 is not finite"),
        (CUBE_CORNERS, [[0, 1]], "fewer than three corners"),
        (CUBE_CORNERS, [[0, 1, 9]], "not among 0 to 7"),
        (CUBE_CORNERS, [[0, 1, 2, 1]], "visits vertex 1 twice"),
        (CUBE_CORNERS, [*CUBE_FACES, [0, 1, 6, 7]], "more than two facets share the edge"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "no area"),
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, 0]], [[0, 1, 2, 3]], "not planar"),
        (
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.4, 0.6, 0]],
            [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [3, 2, 1, 0]],
            "encloses no volume",
        ),
    ],
)
def test_what_is_no_solid_is_refused_by_name(vertices, faces, reason):
    with pytest.raises(GeometryError, match=f'shape "x": .*{reason}'):
        build(vertices, faces, name="x", radius=0.1)


def test_a_moebius_strip_is_refused():
    turn = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    radial = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    width = 0.3 * (np.cos(turn / 2)[:, None] * radial + np.sin(turn / 2)[:, None] * [0, 0, 1])
    vertices = np.concatenate([radial - width, radial + width])
    quads = [[k, k + 1, 8 + k + 1, 8 + k] for k in range(7)] + [[7, 8, 0, 15]]

    with pytest.raises(GeometryError, match="one side only"):
        build(vertices, split(quads), name="strip", radius=0.01)


def test_a_surface_that_crosses_itself_is_refused_unless_its_mass_is_declared():
    other = np.array(CUBE_CORNERS) * [0.3, 0.3, 3.0] + [0.3, 0.3, -1.0]
    vertices = np.concatenate([CUBE_CORNERS, other])
    faces = [*CUBE_FACES, *([corner + 8 for corner in face] for face in CUBE_FACES)]

    with pytest.raises(GeometryError, match="crosses itself"):
        build(vertices, faces, name="cross", radius=0.01)
    assert build(vertices, faces, name="c", radius=0.01, declared=(1.0, (1.0, 1.0, 1.0))).closed


def test_a_large_mesh_is_built_in_seconds():
    count = 100
    turn, height = np.meshgrid(np.arange(2 * count) * np.pi / count, np.arange(1, count) / count)
    ring = np.sqrt(1.0 - (2.0 * height - 1.0) ** 2)
    body = np.stack([ring * np.cos(turn), ring * np.sin(turn), 2.0 * height - 1.0], axis=-1)
    vertices = np.concatenate([body.reshape(-1, 3), [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])
    number = np.arange(2 * count * (count - 1)).reshape(count - 1, -1)
    after = np.roll(number, -1, axis=1)
    south, north = np.full(2 * count, len(vertices) - 2), np.full(2 * count, len(vertices) - 1)
    low = [number[:-1], after[:-1], after[1:]]
    high = [number[:-1], after[1:], number[1:]]
    triangles = np.concatenate(
        [np.stack(part, axis=-1).reshape(-1, 3) for part in (low, high)]
        + [np.stack([after[0], number[0], south], axis=-1)]
        + [np.stack([number[-1], after[-1], north], axis=-1)]
    )
    ball = build(vertices, triangles, name="ball", radius=0.1)

    assert ball.convex
    assert ball.volume == pytest.approx(4.0 / 3.0 * np.pi * 1.1**3, rel=1e-3)


def test_the_same_input_gives_the_same_bits():
    first, second = (build(*frame(), name="frame", radius=0.05) for _ in range(2))

    assert np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(first.side_vertices, second.side_vertices)
    assert first.volume == second.volume


def test_a_tetrahedron_is_regular_in_any_pose():
    corners = TETRA_CORNERS @ rotation(1).T + 5.0
    solid = build(corners, TETRA_FACES, name="tetra", radius=0.1)

    assert np.ptp(solid.inertia_over_mass) < 1e-12
    assert solid.frame_origin == pytest.approx([5.0] * 3)
