import numpy as np
import pytest
from grids import write_asc

from warpdem.errors import SceneError
from warpdem.input.decode import load
from warpdem.rockfall.classes import NEEDED, PUBLISHED, UNVERIFIED, classes_of
from warpdem.rockfall.prepare import method_of, results_grid, site_of
from warpdem.rockfall.site import Grid, GroundClass

BODY = """
[[shape]]
kind = "sphere"
name = "ball"
radius = 0.5
[[body]]
shape = "ball"
position = [2790005.0, 1180005.0, 1520.0]
density = 2700.0
"""
EAST, NORTH = 2790000.0, 1180000.0


def scene_of(folder, text="", *, run="", terrain="", overrides=()):
    """A scene on 10 x 8 cells of 1 m that rise to the east from 1500.25 m."""
    x = np.arange(11.0)
    write_asc(folder / "t.asc", np.tile(1500.25 + 0.5 * x, (9, 1)), x=EAST, y=NORTH)
    (folder / "s.toml").write_text(
        f'[run]\nmethod = "nonsmooth"\nduration = 30.0\n{run}\n'
        f'[terrain]\nfile = "t.asc"\nclass = "hard"\nnodes = "corner"\n{terrain}\n{BODY}\n{text}'
    )
    return load(folder / "s.toml", overrides)


def polygon(*corners):
    return str([[EAST + x, NORTH + y] for x, y in corners])


def problems(scene):
    with pytest.raises(SceneError) as caught:
        site_of(scene)
    return [str(problem) for problem in caught.value.problems]


def test_the_published_table_says_where_its_numbers_are_from():
    assert {one.source for one in PUBLISHED.values()} > {UNVERIFIED}
    assert PUBLISHED["hard"] == GroundClass(
        "hard", 0.55, 2.0, 3.0, 185.0, 0.4, source=PUBLISHED["hard"].source
    )
    assert "10.1007/s10346-019-01238-z" in PUBLISHED["hard"].source
    unverified = {name for name, one in PUBLISHED.items() if one.source == UNVERIFIED}
    assert unverified == {"soft", "medium soft", "medium", "medium hard", "snow"}


def test_an_own_class_starts_from_another(tmp_path):
    text = """
[[terrain_class]]
name = "meadow"
like = "soft"
mu_min = 0.3
scar_modulus = 5e3
[[terrain_class]]
name = "hard"
drag = 0.45
"""
    own = classes_of(scene_of(tmp_path, text).terrain_class)
    assert own["meadow"] == GroundClass(
        "meadow", 0.3, 2.0, 1.25, 100.0, 0.8, scar_modulus=5e3, source="scene"
    )
    assert (own["hard"].drag, own["hard"].mu_min, own["hard"].source) == (0.45, 0.55, "scene")
    assert len(NEEDED) == 5


def test_a_site_has_its_origin_in_whole_metres(tmp_path):
    site = site_of(scene_of(tmp_path))
    assert site.origin.tolist() == [EAST, NORTH, 1500.0]
    assert site.ground.height(np.array([3.0]), np.array([4.0])) == 1.75
    assert site.classes == (PUBLISHED["hard"],)
    assert (site.class_of == 0).all()
    assert (site.stands, site.stand_of, site.trees, site.barriers) == ((), None, None, ())
    assert site.results is site.ground.grid
    assert site.crs == ""


def test_later_areas_win_and_only_classes_that_occur_are_kept(tmp_path):
    text = f"""
[[ground]]
class = "soft"
polygon = {polygon((0, 0), (6, 0), (6, 8), (0, 8))}
[[ground]]
class = "snow"
polygon = {polygon((4, 0), (8, 0), (8, 8), (4, 8))}
[[ground]]
class = "medium"
polygon = {polygon((0, 0), (1, 0), (1, 1), (0, 1))}
[[ground]]
class = "hard"
polygon = {polygon((0, 0), (1, 0), (1, 1), (0, 1))}
"""
    site = site_of(scene_of(tmp_path, text))
    names = np.array([one.name for one in site.classes])[site.class_of]
    assert (names[:, 4:8] == "snow").all()
    assert (names[1:, :4] == "soft").all()
    assert (names[:, 8:] == "hard").all()
    assert names[0, 0] == "hard"
    assert {one.name for one in site.classes} == {"hard", "soft", "snow"}


def test_a_raster_of_numbers_names_classes_and_leaves_others(tmp_path):
    numbers = np.full((8, 10), 7.0)
    numbers[:, :3], numbers[:2, 5:] = 1.0, np.nan  # the first rows lie in the north
    numbers[7, 9] = 2.0
    write_asc(tmp_path / "c.asc", numbers, x=EAST, y=NORTH)
    text = '[[ground]]\nfile = "c.asc"\nclasses = {"1" = "soft", "7" = "snow"}'
    site = site_of(scene_of(tmp_path, text))
    names = np.array([one.name for one in site.classes])[site.class_of]
    assert (names[:, :3] == "soft").all()
    assert (names[6:, 5:] == "hard").all()
    assert names[0, 9] == "hard"
    assert (names[1:6, 5:] == "snow").all()


def test_polygons_of_a_file_name_their_class(tmp_path):
    shapefile = pytest.importorskip("shapefile")
    with shapefile.Writer(str(tmp_path / "a.shp")) as file:
        file.field("KIND", "C")
        for x, name in ((0.0, "soft"), (5.0, "snow")):
            west = EAST + x
            ring = [[west, NORTH], [west, NORTH + 8], [west + 5, NORTH + 8], [west + 5, NORTH]]
            file.poly([ring])
            file.record(name)
    site = site_of(scene_of(tmp_path, '[[ground]]\nfile = "a.shp"\nfield = "KIND"'))
    names = np.array([one.name for one in site.classes])[site.class_of]
    assert (names[:, :5] == "soft").all()
    assert (names[:, 5:] == "snow").all()
    everywhere = site_of(scene_of(tmp_path, '[[ground]]\nfile = "a.shp"\nclass = "medium"'))
    assert everywhere.classes == (PUBLISHED["medium"],)
    found = problems(scene_of(tmp_path, '[[ground]]\nfile = "a.shp"\nfield = "TYPE"'))
    assert 'no attribute "TYPE"; there are: KIND' in found[0]


def test_an_unknown_class_in_a_file_is_named(tmp_path):
    shapefile = pytest.importorskip("shapefile")
    with shapefile.Writer(str(tmp_path / "a.shp")) as file:
        file.field("KIND", "C")
        file.poly([[[EAST, NORTH], [EAST, NORTH + 8], [EAST + 5, NORTH]]])
        file.record("gravel")
    found = problems(scene_of(tmp_path, '[[ground]]\nfile = "a.shp"\nfield = "KIND"'))
    assert 'class "gravel", which is none of extra soft' in found[0]


def test_forests_of_one_kind_are_one_stand(tmp_path):
    west, east = polygon((0, 0), (2, 0), (2, 8), (0, 8)), polygon((8, 0), (10, 0), (10, 8), (8, 8))
    text = f"""
[[forest]]
density = "dense"
height = 20.0
polygon = {west}
[[forest]]
drag = 750.0
height = 20.0
polygon = {east}
[[forest]]
density = "open"
height = 5.0
polygon = {polygon((1, 0), (9, 0), (9, 8), (1, 8))}
"""
    site = site_of(scene_of(tmp_path, text))
    assert [(one.drag, one.height) for one in site.stands] == [(750.0, 20.0), (250.0, 5.0)]
    assert (site.stand_of == [0, 1, 1, 1, 1, 1, 1, 1, 1, 0]).all()


def test_a_forest_raster_is_forest_where_it_is_not_zero(tmp_path):
    trees = np.zeros((8, 10))
    trees[:, 4], trees[:, 5] = 3.0, np.nan
    write_asc(tmp_path / "f.asc", trees, x=EAST, y=NORTH)
    text = '[[forest]]\ndensity = "medium"\nheight = 9.0\nfile = "f.asc"'
    site = site_of(scene_of(tmp_path, text))
    assert (site.stand_of == [-1, -1, -1, -1, 0, -1, -1, -1, -1, -1]).all()


def test_trees_stand_on_the_ground_at_their_axis(tmp_path):
    (tmp_path / "trees.csv").write_text(
        f"id,x,y,diameter,height\n1,{EAST + 2},{NORTH + 2},0.6,12\n2,{EAST - 5},{NORTH},0.6,12\n"
    )
    text = f"""
[[tree]]
position = [{EAST + 4}, {NORTH + 3}]
diameter = 0.4
height = 15.0
mu = 0.5
[[tree]]
file = "trees.csv"
mu = 0.3
"""
    trees = site_of(scene_of(tmp_path, text)).trees
    assert trees.position.tolist() == [[4.0, 3.0], [2.0, 2.0]]
    assert trees.radius.tolist() == [0.2, 0.3]
    assert trees.top.tolist() == [2.25 + 15.0, 1.25 + 12.0]
    assert trees.friction.tolist() == [0.5, 0.3]
    assert trees.left_out == 1


def test_barriers_are_local_and_endless_without_a_height(tmp_path):
    text = f"""
[[barrier]]
name = "line"
line = {polygon((1, 1), (1, 7))}
[[barrier]]
name = "net"
line = {polygon((2, 1), (2, 7), (3, 7))}
height = 3.0
capacity = 5e5
"""
    line, net = site_of(scene_of(tmp_path, text)).barriers
    assert line.line.tolist() == [[1.0, 1.0], [1.0, 7.0]]
    assert (line.height, line.capacity, net.height, net.capacity) == (np.inf, 0.0, 3.0, 5e5)


def test_results_have_the_terrains_cells_or_their_own_from_the_same_corner(tmp_path):
    site = site_of(scene_of(tmp_path, overrides=["output.cellsize=3.0"]))
    assert vars(site.results) == vars(Grid(0.0, 0.0, 3.0, 3, 4))
    grid = Grid(0.4, 0.2, 0.1, 30, 60)
    assert results_grid(grid, None) is grid
    assert vars(results_grid(grid, 0.3)) == vars(Grid(0.4, 0.2, 0.3, 10, 20))


def test_all_faults_of_files_are_told_at_once_with_their_lines(tmp_path):
    write_asc(tmp_path / "c.asc", np.ones((2, 2)), x=0.0, y=0.0)
    (tmp_path / "trees.csv").write_text("x,y,height\n1,2,3\n")
    far = [[0, 0], [5, 0], [5, 5]]
    text = f"""[[ground]]
file = "c.asc"
classes = {{"1" = "soft"}}
[[ground]]
class = "soft"
polygon = {far}
[[forest]]
density = "open"
height = 9.0
polygon = {far}
[[tree]]
file = "trees.csv"
mu = 0.4
[[tree]]
position = [0.0, 0.0]
diameter = 0.5
height = 5.0
mu = 0.4
"""
    found = problems(scene_of(tmp_path, text))
    assert len(found) == 5
    assert all("covers the centre of no cell" in line for line in found[:3])
    assert "has no column 'diameter'" in found[3]
    assert "tree[1]: stands where the terrain has no height" in found[4]
    assert all("s.toml:" in line for line in found)


def test_a_table_of_trees_is_checked_line_by_line(tmp_path):
    for row, fault in (
        ("1,2,0,3", "diameter = 0: must be positive"),
        ("1,x,1,3", "y = 'x': must be a finite number"),
    ):
        (tmp_path / "trees.csv").write_text(f"x,y,diameter,height\n1,2,1,3\n{row}\n")
        found = problems(scene_of(tmp_path, '[[tree]]\nfile = "trees.csv"\nmu = 0.4'))
        assert f"trees.csv:3: {fault}" in found[0]


def test_a_mesh_is_a_terrain(tmp_path):
    (tmp_path / "t.obj").write_text(
        f"v {EAST} {NORTH} 100\nv {EAST + 10} {NORTH} 105\nv {EAST + 10} {NORTH + 8} 105\n"
        f"v {EAST} {NORTH + 8} 100\nf 1 2 3 4\n"
    )
    scene = scene_of(tmp_path, overrides=["terrain.file=t.obj", "terrain.nodes=centre"])
    site = site_of(scene)
    assert site.origin.tolist() == [EAST, NORTH, 100.0]
    assert site.ground.height(np.array([4.0]), np.array([3.0])) == pytest.approx(2.0, abs=1e-12)
    assert site.class_of.shape == site.ground.known.shape


def test_a_terrain_that_cannot_be_read_is_told_at_its_line(tmp_path):
    scene = scene_of(tmp_path)
    (tmp_path / "t.asc").write_text("nonsense")
    assert "s.toml:6  terrain.file: " in problems(scene)[0]
    assert "the header lacks ncols" in problems(scene)[0]


def test_the_method_is_that_of_the_scene(tmp_path):
    method = method_of(scene_of(tmp_path))
    assert (method.duration, method.dt, method.stride, method.skip) == (30.0, 5e-3, 0.03, "jump")
    run = (
        'dt = 1e-3\nstride = 0.0\ntolerance = 1e-6\ngyroscope = "leine"\nskip = "none"\nlift = 0.2'
    )
    other = method_of(scene_of(tmp_path, run=run))
    assert (other.dt, other.stride, other.tolerance, other.lift) == (1e-3, 0.0, 1e-6, 0.2)
    assert (other.gyroscope, other.skip, other.gravity) == ("leine", "none", (0.0, 0.0, -9.81))
