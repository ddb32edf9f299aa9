import numpy as np
import pytest
from grids import write_asc

from warpdem.checks.check import check
from warpdem.errors import SceneError
from warpdem.geometry.orientation import matrix
from warpdem.input.decode import load
from warpdem.rockfall.bodies import Bodies
from warpdem.rockfall.prepare import site_of

EAST, NORTH = 2790000.0, 1180000.0
LAW = 'kn = 1e7\nkt = 1e7\nen2 = 0.25\nmu = 0.5\n[[contact]]\ngroups = ["rock", "rock"]\n'
TEXT = f"""
[run]
duration = 30.0
[[shape]]
kind = "terrain"
name = "hill"
file = "t.asc"
[[shape]]
kind = "box"
name = "slab"
size = [2.0, 1.0, 0.5]
rounding = 0.05
[[shape]]
kind = "sphere"
name = "ball"
radius = 0.5
[[group]]
name = "rock"
density = 2700.0
[[body]]
shape = "hill"
group = "ground"
position = [{EAST}, {NORTH}, 1500.0]
fixed = true
[[body]]
shape = "slab"
group = "rock"
position = [{EAST + 2}, {NORTH + 3}, 1510.5]
orientation = [0.6, 0.8, 0.0, 0.0]
velocity = [1.0, 2.0, 3.0]
spin = [0.1, 0.2, 0.3]
[[body]]
shape = "ball"
group = "rock"
position = [{EAST + 5}, {NORTH + 3}, 1512.0]
scale = 2.0
[[body]]
shape = "slab"
group = "rock"
position = [{EAST + 7}, {NORTH + 3}, 1512.0]
[[contact]]
groups = ["rock", "ground"]
kn = 1e7
kt = 1e7
en2 = 0.25
mu = 0.5
[[contact]]
groups = ["rock", "rock"]
kn = 1e7
kt = 1e7
en2 = 0.25
mu = 0.9
"""
NONSMOOTH = 'run.method="nonsmooth"'


def scene_of(folder, text=TEXT, *overrides):
    write_asc(folder / "t.asc", np.tile(0.25 + 0.5 * np.arange(11.0), (9, 1)))
    (folder / "s.toml").write_text(text)
    return load(folder / "s.toml", [NONSMOOTH, *overrides])


def changed(old, new):
    assert old in TEXT
    return TEXT.replace(old, new)


def problems(scene):
    with pytest.raises(SceneError) as caught:
        Bodies(scene, site_of(scene))
    return [str(problem) for problem in caught.value.problems]


def test_the_smooth_scene_is_a_site_whose_class_is_its_contact(tmp_path):
    site = site_of(scene_of(tmp_path))
    assert site.origin.tolist() == [EAST, NORTH, 1500.0]
    assert site.ground.height(np.array([4.0]), np.array([2.0])) == 2.25
    (one,) = site.classes
    assert (one.mu_min, one.mu_max, one.restitution) == (0.5, 0.5, 0.5)
    assert (one.kappa, one.beta, one.drag, one.scar_modulus) == (0.0, 0.0, 0.0, 0.0)
    assert (site.class_of == 0).all()


def test_free_bodies_become_rocks_and_starts(tmp_path):
    scene = scene_of(tmp_path)
    bodies = Bodies(scene, site_of(scene))
    slab, ball = bodies.rocks
    assert (slab.name, ball.name, bodies.count) == ("slab", "ball", 3)
    starts = bodies.starts(np.array([2, 0]))
    assert starts.id.tolist() == [2, 0]
    assert bodies.starts(np.arange(3)).rock.tolist() == [0, 1, 0]
    assert starts.position == pytest.approx(np.array([[7.0, 3.0, 12.0], [2.0, 3.0, 10.5]]))
    assert starts.velocity[1].tolist() == [1.0, 2.0, 3.0]
    assert starts.spin[1].tolist() == [0.1, 0.2, 0.3]


def test_a_rock_has_the_shapes_corners_mass_and_inertia(tmp_path):
    scene = scene_of(tmp_path)
    bodies = Bodies(scene, site_of(scene))
    slab, ball = bodies.rocks
    assert slab.rounding == 0.05
    turn = matrix(bodies.starts(np.array([2])).orientation[0])
    corners = np.abs(slab.vertices @ turn.T)
    assert corners == pytest.approx(np.tile([0.95, 0.45, 0.2], (8, 1)))
    assert slab.edges.shape == (12, 2)
    # a sphere of radius 1 from a shape of radius 0.5
    mass = 2700.0 * 4.0 / 3.0 * np.pi
    assert (ball.rounding, ball.bound, ball.edges.tolist()) == (1.0, 1.0, [[0, 0]])
    assert ball.mass == pytest.approx(mass, rel=1e-12)
    assert ball.inertia == pytest.approx(np.full(3, 0.4 * mass), rel=1e-12)


def test_the_skin_of_a_rock_is_closed_and_outward(tmp_path):
    scene = scene_of(tmp_path)
    for rock in Bodies(scene, site_of(scene)).rocks:
        a, b, c = rock.skin_points[rock.skin_triangles].swapaxes(0, 1)
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
        assert volume == pytest.approx(rock.mass / 2700.0, rel=0.1)


def test_a_fills_bodies_start_too(tmp_path):
    fill = f"""
[[fill]]
name = "more"
shapes = ["ball"]
group = "rock"
kind = "lattice"
count = 4
region = {{min = [{EAST}, {NORTH}, 1520], max = [{EAST + 10}, {NORTH + 8}, 1530]}}
"""
    scene = scene_of(tmp_path, TEXT + fill)
    bodies = Bodies(scene, site_of(scene))
    assert bodies.count == 7
    assert [rock.bound for rock in bodies.rocks[1:]] == [1.0, 0.5]


def test_a_scene_without_the_grounds_contact_is_refused(tmp_path):
    text = changed('groups = ["rock", "ground"]', 'groups = ["ground", "ground"]')
    assert (
        'between the groups "ground" of the ground and "rock"'
        in problems(scene_of(tmp_path, text))[0]
    )


def test_impacts_need_the_energy_they_keep(tmp_path):
    text = changed("en2 = 0.25\nmu = 0.5", "damping_ratio = 0.2\nmu = 0.5")
    assert "contact[0].en2: missing" in problems(scene_of(tmp_path, text))[0]


def test_a_ground_is_the_same_for_all_groups(tmp_path):
    other = """
[[body]]
shape = "ball"
group = "other"
density = 2000.0
position = [2790009.0, 1180003.0, 1512.0]
[[contact]]
groups = ["other", "ground"]
kn = 1e7
kt = 1e7
en2 = 0.25
mu = 0.6
"""
    assert (
        "contact[2]: another mu or en2 than contact[0]"
        in problems(scene_of(tmp_path, TEXT + other))[0]
    )


def test_bodies_lie_above_the_ground(tmp_path):
    text = changed(f"position = [{EAST + 7}, {NORTH + 3}", f"position = [{EAST + 70}, {NORTH + 3}")
    scene = scene_of(tmp_path, text)
    words = "body: 1 of 3 free bodies lie outside the terrain or where it has no data: (2790070, "
    with pytest.raises(SceneError) as caught:
        Bodies(scene, site_of(scene))
    assert words in str(caught.value)
    with pytest.raises(SceneError) as caught:
        check(scene)
    assert words in str(caught.value)


def test_rocks_are_convex(tmp_path):
    bent = """
[[shape]]
kind = "polyhedron"
name = "bent"
rounding = 0.1
vertices = [[0, 0, 0], [1, 0, 0], [1, 0, 1]]
edges = [[0, 1], [1, 2]]
[[body]]
shape = "bent"
group = "rock"
position = [2790009.0, 1180003.0, 1512.0]
"""
    assert "shape[3]: is not convex" in problems(scene_of(tmp_path, TEXT + bent))[0]
