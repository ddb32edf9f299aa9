import numpy as np
import pytest
from releasing import BALL, BLOCK, PLATE, scene

from warpdem.errors import SceneError
from warpdem.geometry.hull import convex_hull
from warpdem.geometry.orientation import matrix
from warpdem.rockfall.builder import FORMS, built
from warpdem.rockfall.rocks import rocks_of

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
LIBRARY = """<
name cube
radius 0.1
preCompDone n
nv 8
0 0 0
1 0 0
1 2 0
0 2 0
0 0 3
1 0 3
1 2 3
0 2 3
ne 12
0 1
1 2
2 3
3 0
4 5
5 6
6 7
7 4
0 4
1 5
2 6
3 7
nf 6
4 0 1 2 3
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
>
"""
NOTCHED = {  # a box whose upper face is pushed in
    "kind": "polyhedron",
    "name": "notched",
    "vertices": [*CUBE[[0, 2, 6, 4]].tolist(), *CUBE[[1, 3, 7, 5]].tolist(), [0.5, 1.0, 2.0]],
    "faces": [
        [0, 1, 2, 3],
        [0, 4, 5, 1],
        [1, 5, 6, 2],
        [2, 6, 7, 3],
        [3, 7, 4, 0],
        [4, 8, 5],
        [5, 8, 6],
        [6, 8, 7],
        [7, 8, 4],
    ],
    "rounding": 0.1,
}


def rock(directory=".", shape=(), **section):
    return rocks_of(scene(rock=[section], directory=directory, shape=shape))[0]


def own(rock):
    """Vertices along the axes of the file, about the centre of mass."""
    return rock.vertices @ matrix(rock.frame_rotation).T


def sphere_volume(radius):
    return 4.0 / 3.0 * np.pi * radius**3


def skin_volume(rock):
    a, b, c = (rock.skin_points[rock.skin_triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("vertices", [4, 24, 120])
@pytest.mark.parametrize("rounding", [0.0, 0.03, 0.2])
def test_a_built_rock_has_its_volume_and_number_of_corners(form, vertices, rounding):
    solid = built(form, 0.2, name="x", vertices=vertices, rounding=rounding, seed=5)
    assert solid.volume == pytest.approx(0.2, rel=1e-14)
    assert len(solid.vertices) == vertices
    assert solid.convex


@pytest.mark.parametrize("form", FORMS)
def test_a_built_rock_has_the_axes_of_its_form(form):
    solid = built(form, 1.0, name="x", vertices=30)
    extent = np.ptp(solid.vertices @ matrix(solid.frame_rotation).T, axis=0)
    assert extent / extent[0] == pytest.approx(np.array(FORMS[form]), rel=1e-12)


def test_forms_lie_in_zinggs_classes():
    ratios = {form: (b > 2 / 3, c / b > 2 / 3) for form, (_, b, c) in FORMS.items()}
    assert ratios == {"equant": (True, True), "flat": (True, False), "long": (False, True)}


def test_another_seed_is_another_rock_and_the_same_seed_the_same():
    first, again, other = (rock(**BLOCK, seed=seed) for seed in (1, 1, 2))
    assert np.array_equal(first.vertices, again.vertices)
    assert not np.allclose(first.vertices, other.vertices)


@pytest.mark.parametrize(
    "two",
    [{"volume": 0.5, "density": 2000.0}, {"volume": 0.5, "mass": 1000.0},
     {"mass": 1000.0, "density": 2000.0}],
)  # fmt: skip
def test_two_of_volume_mass_and_density_say_all(two):
    plain = {"name": "x", "kind": "builder", "form": "equant"}
    found = rock(**plain, **two)
    wanted = rock(**plain, volume=0.5, density=2000.0)
    assert found.mass == pytest.approx(1000.0, rel=1e-15)
    assert found.vertices == pytest.approx(wanted.vertices, rel=1e-12, abs=1e-14)
    assert found.inertia == pytest.approx(wanted.inertia, rel=1e-12)


def test_a_rock_lies_about_its_centre_of_mass_along_its_principal_axes():
    found = rock(**BLOCK)
    facets = convex_hull(found.vertices)
    a, b, c = (found.vertices[facets[:, k]] for k in range(3))
    weight = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0
    assert weight @ (a + b + c) / 4.0 == pytest.approx(np.zeros(3), abs=1e-14)
    square = sum(
        np.einsum("i,ij,ik->jk", weight, x, y) * (2.0 if x is y else 1.0)
        for x in (a, b, c)
        for y in (a, b, c)
    )
    spread = 2700.0 / 20.0 * square
    assert np.trace(spread) * np.eye(3) - spread == pytest.approx(np.diag(found.inertia), abs=1e-11)


def test_a_cloud_with_sharp_corners_is_its_hull():
    inner = np.random.default_rng(1).uniform(0.1, 0.9, (50, 3)) * [1.0, 2.0, 3.0]
    cloud = np.concatenate([inner, CUBE])
    found = rock(name="x", kind="points", points=cloud.tolist(), density=100.0)
    assert found.rounding == 0.0
    assert found.mass == pytest.approx(600.0)
    assert found.inertia == pytest.approx([650.0, 500.0, 250.0])
    assert (len(found.vertices), len(found.edges)) == (8, 12)
    assert skin_volume(found) == pytest.approx(6.0)
    assert found.bound == pytest.approx(np.sqrt(14.0) / 2.0)
    assert found.notes == ()


def test_rounding_is_laid_around_the_hull():
    found = rock(name="x", kind="points", points=CUBE.tolist(), density=1.0, rounding=0.1)
    assert found.mass == pytest.approx(6.0 + 2.2 + np.pi * 0.01 * 6.0 + sphere_volume(0.1))
    reach = found.skin_points.max(axis=0)
    assert reach == pytest.approx([0.6, 1.1, 1.6])
    assert skin_volume(found) == pytest.approx(found.mass, rel=2e-3)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.xyz", "# cloud\n0 0 0\n1,0,0\n1 2 0 7 7\n0\t2 0\n\n0 0 3\n1 0 3\n1 2 3 # top\n0 2 3\n"),
        ("a.csv", "x;y;z\n0;0;0\n1;0;0\n1;2;0\n0;2;0\n0;0;3\n1;0;3\n1;2;3\n0;2;3\n"),
        ("a.pts", "8\n0 0 0\n1 0 0\n1 2 0\n0 2 0\n0 0 3\n1 0 3\n1 2 3\n0 2 3\n"),
    ],
)
def test_points_come_from_texts_of_many_kinds(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    found = rock(tmp_path, name="x", kind="points", file=name, scale=0.5, mass=3.0)
    assert np.ptp(own(found), axis=0) == pytest.approx([0.5, 1.0, 1.5])
    assert found.mass == 3.0


def test_a_mesh_is_read_in_its_unit(tmp_path):
    meshio = pytest.importorskip("meshio")
    mesh = meshio.Mesh(CUBE * 1000.0, [("triangle", convex_hull(CUBE))])
    mesh.write(tmp_path / "a.stl", binary=True)
    found = rock(tmp_path, name="x", kind="mesh", file="a.stl", scale=1e-3, mass=6.0)
    assert found.inertia == pytest.approx([6.5, 5.0, 2.5])
    assert len(found.vertices) == 8


def test_a_library_shape_keeps_its_rounding(tmp_path):
    (tmp_path / "a.shp").write_text(LIBRARY)
    found = rock(tmp_path, name="x", kind="shp", file="a.shp", item="cube", density=1.0)
    assert found.rounding == 0.1
    assert found.mass == pytest.approx(6.0 + 2.2 + np.pi * 0.01 * 6.0 + sphere_volume(0.1))


def test_a_sphere_is_one_vertex_with_exact_moments():
    found = rocks_of(scene(rock=[BALL]))[0]
    assert found.vertices.tolist() == [[0.0, 0.0, 0.0]]
    assert found.edges.tolist() == [[0, 0]]
    assert (found.rounding, found.mass, found.bound) == (0.25, 10.0, 0.25)
    assert found.inertia == pytest.approx(np.full(3, 0.4 * 10.0 * 0.25**2), rel=1e-14)


@pytest.mark.parametrize(
    ("shape", "vertices", "edges"),
    [
        ({"kind": "box", "size": [1.0, 2.0, 3.0], "rounding": 0.1}, 8, 12),
        ({"kind": "capsule", "radius": 0.2, "length": 1.0}, 2, 1),
        ({"kind": "box", "size": [1.0, 1.0, 0.2], "rounding": 0.1}, 4, 4),
    ],
)
def test_convex_shapes_of_the_scene_are_rocks(shape, vertices, edges):
    section = {"name": "x", "kind": "shape", "shape": "s", "density": 2000.0}
    found = rocks_of(scene(rock=[section], shape=[{"name": "s", **shape}]))[0]
    assert (len(found.vertices), len(found.edges)) == (vertices, edges)
    assert skin_volume(found) * 2000.0 == pytest.approx(found.mass, rel=0.1)


def test_of_a_hollow_shape_the_hull_is_taken_and_noted():
    section = {"name": "x", "kind": "shape", "shape": "notched", "density": 1.0}
    found = rocks_of(scene(rock=[section], shape=[NOTCHED]))[0]
    box = rock(name="x", kind="points", points=CUBE.tolist(), density=1.0, rounding=0.1)
    assert found.mass == pytest.approx(box.mass, rel=1e-12)
    assert found.notes == (
        "is not convex: 1 of its 9 vertices lie inside the hull that it is",
    )  # fmt: skip


def test_declared_mass_properties_of_a_shape_stay():
    shape = {**NOTCHED, "faces": [*NOTCHED["faces"][:5], [4, 7, 6, 5]], "volume": 4.0}
    shape |= {"vertices": NOTCHED["vertices"][:8], "inertia_over_mass": [1.0, 1.1, 1.2]}
    section = {"name": "x", "kind": "shape", "shape": "notched", "density": 2.0}
    found = rocks_of(scene(rock=[section], shape=[shape]))[0]
    assert found.mass == 8.0
    assert found.inertia == pytest.approx([8.0, 8.8, 9.6])


def test_all_faulty_rocks_are_told_at_once(tmp_path):
    (tmp_path / "flat.xyz").write_text("0 0 0\n1 0 0\n0 1 0\n1 1 0\n")
    (tmp_path / "bad.xyz").write_text("0 0 0\n1 0\n")
    sections = [
        {"name": "a", "kind": "points", "file": "flat.xyz", "mass": 1.0},
        PLATE,
        {"name": "b", "kind": "points", "file": "bad.xyz", "mass": 1.0},
        {"name": "c", "kind": "mesh", "file": "none.stl", "mass": 1.0},
        {**BLOCK, "rounding": 1.0},
        {"name": "d", "kind": "shp", "file": "none.shp", "mass": 1.0},
    ]
    with pytest.raises(SceneError) as caught:
        rocks_of(scene(rock=sections, directory=tmp_path))
    told = [(problem.key.partition(" ")[0], problem.message) for problem in caught.value.problems]
    assert [key for key, _ in told] == [
        "rock[0].file",
        "rock[2].file",
        "rock[3].file",
        "rock[4]",
        "rock[5].file",
    ]
    words = ["lie on one plane", "bad.xyz:2: should begin", "none.stl", "less than 0.363", "none."]
    assert all(word in message for word, (_, message) in zip(words, told, strict=True))
