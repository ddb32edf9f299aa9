"""Geometry that is hard on features: borders, slivers, sizes, concave shapes, deep overlaps."""

import numpy as np
import pytest
from colliding import NO_FRICTION, run
from solids import CUBE_CORNERS, CUBE_FACES, ELL, prism, split
from sweeps import CUBE, Pair, about, balance_error, lowered

from warpdem.geometry.orientation import product, turned

BALL = {"kind": "sphere", "radius": 0.3}
NEEDLE = {"kind": "box", "size": [1.0, 0.01, 0.01], "rounding": 0.002}
PLATE = {"kind": "box", "size": [1.0, 1.0, 0.01], "rounding": 0.002}
TILTED = about([0.3, -0.5, 0.8], 0.6)
WEDGE = {
    "kind": "polyhedron",
    "vertices": [
        [0.5, -0.8, 0.4], [0.5, 0.9, -0.1], [0.7, -0.4, 0.0], [-0.9, 0.0, -0.5], [-0.7, 0.3, 0.3],
    ],
    "faces": [[0, 2, 1], [0, 1, 4], [0, 4, 3], [0, 3, 2], [1, 2, 3], [1, 3, 4]],
    "rounding": 0.05,
    "volume": 1.0,
    "inertia_over_mass": [1.0, 1.0, 1.0],
}  # fmt: skip


def polyhedron(vertices, faces, rounding=0.05):
    size = {"volume": 1.0, "inertia_over_mass": [1.0, 1.0, 1.0]}
    core = {"vertices": np.asarray(vertices, float).tolist(), "faces": faces, "rounding": rounding}
    return {"kind": "polyhedron", **core, **size}


def times(shape, factor):
    lengths = ("size", "rounding", "radius", "vertices", "length")
    return {k: (np.array(v) * factor).tolist() if k in lengths else v for k, v in shape.items()}


def flat_ground(rounding=0.05):
    """The square -2 to 2 at z = -rounding in triangles, some of them slivers of 1:2000."""
    x = [-2.0, -0.7, 0.0, 0.001, 0.5, 0.502, 2.0]
    y = [-2.0, 0.0, 0.0005, 0.9, 2.0]
    vertices = [[a, b, -rounding] for b in y for a in x]
    n = len(x)
    cells = [k + n * m for m in range(len(y) - 1) for k in range(n - 1)]
    faces = split([[k, k + 1, k + n + 1, k + n] for k in cells])
    borders = sorted({tuple(sorted((f[k - 1], f[k]))) for f in faces for k in range(3)})
    return {**polyhedron(vertices, faces, rounding), "edges": borders}


def test_vertex_beyond_one_face_of_a_convex_solid_is_not_behind_another_one():
    vertices = np.array(WEDGE["vertices"])
    a, b, c = vertices[[1, 2, 3]]
    normal = np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a))
    place = [0.17610657, -0.10416501, -0.17912163]
    height = normal @ (place - a)
    assert 0.0 < height < 0.02
    radius = 0.1
    held = Pair({"kind": "sphere", "radius": radius}, WEDGE).at(place)
    # the face on the far side is .4 away, within half the solid's thickness
    assert held.gaps.min() == pytest.approx(height - radius - 0.05, abs=1e-12)


@pytest.mark.parametrize("factor", [1e-3, 1e3])
@pytest.mark.parametrize("shapes", [(CUBE, CUBE), (NEEDLE, PLATE), (BALL, WEDGE), (WEDGE, CUBE)])
def test_contact_is_the_same_at_every_size(shapes, factor):
    small = min(shape.get("rounding", 0.3) for shape in shapes)
    usual = Pair(*shapes, skin=1.0)
    position, turn = lowered(usual, [0.02, 0.1, 0.99], small, TILTED, step=min(0.1, small))
    scaled = Pair(*(times(shape, factor) for shape in shapes), skin=factor)
    one, other = usual.at(position, turn), scaled.at(position * factor, turn)
    assert other.contacts == one.contacts
    assert other.energy == pytest.approx(one.energy * factor**2, rel=1e-9)
    assert other.force == pytest.approx(one.force * factor, rel=1e-9, abs=1e-12 * factor)
    assert other.torque == pytest.approx(one.torque * factor**2, rel=1e-9, abs=1e-12 * factor**2)


def test_ball_over_every_place_of_a_triangulated_plane_has_one_contact():
    ground = flat_ground()
    pair = Pair(BALL, ground)
    corners = np.array(ground["vertices"])
    middles = [corners[face].mean(axis=0) for face in ground["faces"]]
    halfway = [corners[list(ends)].mean(axis=0) for ends in ground["edges"]]
    inner = [p for p in [*corners, *middles, *halfway] if np.abs(p[:2]).max() < 1.9]
    assert len(inner) > 60
    for place in inner:  # over vertices, edges and faces
        held = pair.at([place[0], place[1], 0.28])
        assert len(held.contacts) == 1
        assert held.force == pytest.approx([0.0, 0.0, 0.02], abs=1e-15)


@pytest.mark.parametrize("shape", ["ball", "brick"])
def test_body_slides_over_slivers_of_a_triangulated_plane_at_its_speed(shape):
    height = {"ball": 0.5, "brick": 0.25}[shape]
    slider = {"shape": shape, "position": [-1.2, -0.3, height], "velocity": [3.0, 0.5, 0.0]}
    plane = {"shape": "slivers", "position": [0.0, 0.0, 0.0], "fixed": True}
    ground = {**flat_ground(), "name": "slivers"}
    end = run([slider, plane], 0.8, law=NO_FRICTION, shapes=[ground]).snapshot()
    assert end.position[0, 0] == pytest.approx(1.2, abs=1e-6)
    assert np.linalg.norm(end.velocity[0] - [3.0, 0.5, 0.0]) <= 1e-9 * np.hypot(3.0, 0.5)
    assert np.linalg.norm(end.spin[0]) <= 1e-9


def test_coplanar_triangles_are_the_faces_they_make_up():
    core = (np.array(CUBE_CORNERS) - 0.5) * 0.8
    whole = Pair(BALL, polyhedron(core, CUBE_FACES, 0.1))
    cut = Pair(BALL, polyhedron(core, split(CUBE_FACES), 0.1))
    for place in ([0.0, 0.0, 0.78], [0.1, 0.1, 0.78], [0.41, 0.1, 0.75], [0.45, 0.45, 0.7]):
        assert cut.at(place).energy == pytest.approx(whole.at(place).energy, rel=1e-12)
        assert cut.at(place).energy > 0.0


def test_ball_in_the_inner_corner_of_an_l_touches_both_faces():
    vertices, faces = prism(ELL, 1.0)
    rounding, radius, deep = 0.05, 0.3, 0.01
    pair = Pair({"kind": "sphere", "radius": radius}, polyhedron(vertices, faces, rounding))
    away = 1.0 + rounding + radius - deep
    held = pair.at([away, away, 0.5])
    assert held.energy == pytest.approx(2.0 * 0.5 * deep**2, rel=1e-9)
    assert held.force == pytest.approx([deep, deep, 0.0], abs=1e-12)


def test_ball_over_an_inner_edge_of_an_l_touches_no_ghost():
    vertices, faces = prism(ELL, 1.0)
    pair = Pair(BALL, polyhedron(vertices, faces))
    # over the top, above the edge in which the two arms would meet
    held = pair.at([0.5, 0.999, 1.34])
    assert len(held.contacts) == 1
    assert held.force == pytest.approx([0.0, 0.0, 0.01], abs=1e-12)


@pytest.mark.parametrize("share", [0.1, 0.3, 0.45])
def test_vertices_deep_in_a_slab_are_pushed_out_of_its_nearest_face(share):
    slab = {"kind": "box", "size": [4.0, 4.0, 1.0], "rounding": 0.01}
    pair = Pair({"kind": "box", "size": [0.5, 0.5, 2.0], "rounding": 0.01}, slab)
    deep = share * 0.98 + 0.02
    held = pair.at([0.0, 0.0, 1.5 - deep])
    assert held.force == pytest.approx([0.0, 0.0, 4.0 * deep], rel=1e-12)
    assert max(balance_error(held)) <= 1e-12


@pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6])
def test_edges_that_are_nearly_parallel_bear_by_their_ends(angle):
    stood = about([1.0, 0.0, 0.0], 0.25 * np.pi)
    core = turned(stood, (np.array(CUBE_CORNERS) - 0.5) * 0.8)
    # both stand on an edge along x; that of the first one is shorter
    pair = Pair({**CUBE, "size": [0.7, 1.0, 1.0]}, polyhedron(core, CUBE_FACES, 0.1))
    deep, high = 0.01, 0.8 * np.sqrt(2.0) + 0.2
    held = pair.at([0.0, 0.0, high - deep], product(about([0.0, 0.0, 1.0], angle), stood))
    assert len(held.contacts) == 2
    assert held.force == pytest.approx([0.0, 0.0, 2.0 * deep], rel=1e-9, abs=1e-7)
    # the ends lie beside the other edge by half of .7 times the angle: they turn it a little
    assert np.abs(held.torque).max() <= 1e-9 + 1e-2 * angle
