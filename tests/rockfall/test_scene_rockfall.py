import json

import numpy as np
import pytest

from warpdem.errors import SceneError
from warpdem.input.consistency import consistency
from warpdem.input.decode import loads, schema_text
from warpdem.input.scene import Scene

RUN = {"duration": 10.0, "method": "nonsmooth"}
TERRAIN = {"file": "t.asc", "class": "hard"}
BLOCK = {"kind": "box", "name": "block", "size": [1, 1, 0.5]}
HILL = {"kind": "terrain", "name": "hill", "file": "t.asc"}
FREE = {"shape": "block", "position": [0, 0, 9], "density": 2700.0}
FIXED = {"shape": "hill", "position": [0, 0, 0], "fixed": True, "group": "ground"}
SQUARE = [[0, 0], [1, 0], [1, 1]]
LAW = {"groups": ["default", "ground"], "kn": 1e6, "kt": 1e6, "en2": 0.25, "mu": 0.5}


def tables(**other):
    basis = {"run": RUN, "terrain": TERRAIN, "shape": [BLOCK], "body": [FREE], **other}
    return {key: value for key, value in basis.items() if value is not None}


def rules(**other):
    """Faults of a scene's raw tables as key path: rule."""
    return {".".join(map(str, f.path)): f.rule for f in consistency(tables(**other))}


def test_a_rockfall_scene_needs_a_ground_and_something_that_falls():
    assert rules() == {}
    assert "[[body]]" in rules(terrain=None)["terrain"]
    assert "where rocks start" in rules(body=None)["release"]


def test_the_key_class_is_read_from_tables_and_from_models():
    scene = Scene(**tables())
    assert scene.terrain.class_ == "hard"
    assert not consistency(scene)
    assert Scene.model_validate_json(scene.model_dump_json()) == scene
    assert "class" in json.loads(schema_text())["$defs"]["Terrain"]["properties"]


def test_an_unknown_key_beside_class_lists_the_legal_ones():
    text = 'run = {duration = 1, method = "nonsmooth"}\nterrain = {file = "t.asc", clas = "hard"}'
    with pytest.raises(SceneError) as caught:
        loads(text)
    messages = str(caught.value)
    assert 'terrain.clas: unknown key; did you mean "class"?' in messages
    assert "terrain.class: missing: class of the ground" in messages
    assert "there is no such file" in messages


def test_class_can_be_set_on_the_command_line(tmp_path):
    (tmp_path / "t.asc").touch()
    scene = Scene(**tables())
    assert scene.terrain.nodes == "centre"
    with pytest.raises(SceneError, match=r'did you mean "medium soft"\?'):
        loads('run = {duration = 1, method = "nonsmooth"}', overrides=["terrain.class=medum soft"])


@pytest.mark.parametrize(
    ("section", "value"),
    [
        ("terrain", TERRAIN),
        ("terrain_class", [{"name": "a", "like": "soft"}]),
        ("ground", [{"class": "soft", "polygon": SQUARE}]),
        ("forest", [{"density": "open", "height": 9, "polygon": SQUARE}]),
        ("tree", [{"position": [0, 0], "diameter": 1, "height": 9, "mu": 0.4}]),
        ("barrier", [{"name": "a", "line": [[0, 0], [1, 1]]}]),
        ("rock", [{"name": "a"}]),
        ("release", [{}]),
        ("ensemble", {"count": 5}),
    ],
)
def test_sections_of_rockfall_name_their_method(section, value):
    found = rules(**{"run": {"duration": 1}, "terrain": None, section: value})
    path = section if isinstance(value, dict) else f"{section}.0"
    assert found[path] == 'only with run.method = "nonsmooth"'


def test_keys_of_rockfall_name_their_method():
    run = {"duration": 1, "stride": 0.1, "lift": 0.2, "skip": "jump"}
    output = {"formats": ["tif"], "map": True, "cellsize": 2.0}
    found = rules(run=run, terrain=None, output=output)
    assert found == dict.fromkeys(
        ["run.stride", "run.lift", "output.formats", "output.cellsize"],
        'only with run.method = "nonsmooth"',
    )


def test_what_only_the_smooth_method_knows_is_refused_piece_by_piece():
    run = {**RUN, "compat": "rockable", "partnership": "pnorm", "skin": 0.1, "rotation": "euler"}
    found = rules(
        run=run,
        cell={"periodic": [True, True, True], "size": [9, 9, 9]},
        force=[{"kind": "drag"}],
        driver=[{"kind": "constant", "bodies": ["a"], "velocity": [1, 0, 0]}],
        bond=[{"groups": ["default", "default"]}],
    )
    for path in (
        *("run.compat", "run.partnership", "run.skin", "run.rotation"),
        *("cell", "force.0", "driver.0", "bond.0"),
    ):
        assert found[path].startswith('only with run.method = "smooth"'), path


def test_a_mistyped_method_does_not_accuse_the_sections():
    assert "terrain" not in rules(run={"duration": 1, "method": "nonsmoth"})


def test_bodies_of_rockfall_need_no_contacts_among_themselves():
    assert rules(body=[FREE, FREE]) == {}
    both = {"run": {"duration": 1}, "terrain": None, "body": [FREE, FREE]}
    assert "contact" in rules(**both)


def test_a_terrain_body_is_a_ground_and_excludes_another():
    ground = {"shape": [BLOCK, HILL], "body": [FREE, FIXED], "contact": [LAW]}
    assert rules(terrain=None, **ground) == {}
    assert "[terrain]" in rules(**ground)["body.1.shape"]
    twice = {**ground, "body": [FREE, FIXED, FIXED]}
    assert "body[1]" in rules(terrain=None, **twice)["body.2.shape"]


def test_a_terrain_body_lies_as_its_file_says():
    moved = {**FIXED, "scale": 2.0, "orientation": [0, 1, 0, 0], "velocity": [1, 0, 0]}
    shapes = [BLOCK, {**HILL, "rounding": 0.1}]
    found = rules(terrain=None, shape=shapes, body=[FREE, moved], contact=[LAW])
    assert sorted(found) == sorted(
        ["body.1.scale", "body.1.orientation", "body.1.velocity", "shape.1.rounding"]
    )


def test_ground_areas_need_a_terrain_section():
    area = [{"class": "soft", "polygon": SQUARE}]
    found = rules(terrain=None, shape=[BLOCK, HILL], body=[FREE, FIXED], ground=area)
    assert found["ground.0"].startswith("needs [terrain]")


def test_rocks_meet_no_other_fixed_bodies():
    wall = {"shape": "block", "position": [0, 0, 0], "fixed": True}
    assert "meet no bodies" in rules(body=[FREE, wall])["body.1.fixed"]


def test_releases_and_free_bodies_exclude_each_other():
    rock = [{"name": "a"}]
    assert "beside [[release]]" in rules(rock=rock, release=[{"rocks": ["a"]}])["body.0"]
    found = rules(body=None, terrain=None, rock=rock, release=[{"rocks": ["a"]}])
    assert found["release.0"].startswith("needs [terrain]")


def test_free_bodies_are_counted_by_themselves():
    assert "every free body" in rules(ensemble={"count": 7})["ensemble.count"]


def test_unknown_classes_are_named_with_the_nearest():
    found = rules(
        terrain={**TERRAIN, "class": "hrad"},
        ground=[
            {"class": "sooft", "polygon": SQUARE},
            {"file": "c.asc", "classes": {"1": "sand", "2": "soft"}},
        ],
    )
    assert found["terrain.class"] == 'no class has this name; did you mean "hard"?'
    assert found["ground.0.class"] == 'no class has this name; did you mean "soft"?'
    assert "there are: extra soft" in found["ground.1.classes.1"]
    own = [{"name": "sand", "like": "soft"}]
    assert rules(terrain={**TERRAIN, "class": "sand"}, terrain_class=own) == {}


def test_an_own_class_is_complete_or_like_another():
    found = rules(terrain_class=[{"name": "sand", "mu_min": 0.3}])
    assert sorted(found) == [
        f"terrain_class.0.{key}" for key in ("beta", "drag", "kappa", "mu_max")
    ]
    assert rules(terrain_class=[{"name": "soft", "mu_min": 0.3}]) == {}
    found = rules(terrain_class=[{"name": "a", "like": "b"}, {"name": "b", "like": "soft"}])
    assert list(found) == ["terrain_class.0.like"]


def test_slip_cannot_lower_friction():
    found = rules(terrain_class=[{"name": "a", "like": "snow", "mu_min": 0.5}])
    assert found["terrain_class.0.mu_max"] == "must be at least mu_min = 0.5: slip raises friction"


def test_an_area_is_given_once_and_encloses_something():
    flat = [[0, 0], [1, 1], [2, 2]]
    found = rules(
        ground=[
            {"class": "soft"},
            {"class": "soft", "polygon": SQUARE, "file": "a.shp"},
            {"class": "soft", "polygon": flat},
            {"class": "soft", "file": "a.gpkg"},
        ]
    )
    assert found["ground.0.polygon"].startswith("missing: where it is")
    assert "leave this" in found["ground.1.file"]
    assert "no area" in found["ground.2.polygon"]
    assert ".shp" in found["ground.3.file"]


def test_a_polygon_has_three_corners():
    with pytest.raises(ValueError, match="at least 3"):
        Scene(**tables(ground=[{"class": "soft", "polygon": [[0, 0], [1, 1]]}]))


def test_classes_by_number_belong_to_rasters_and_fields_to_polygons():
    found = rules(
        ground=[
            {"polygon": SQUARE, "classes": {"1": "soft"}},
            {"file": "c.tif", "class": "soft"},
            {"file": "c.tif", "classes": {"one": "soft"}},
            {"file": "c.asc", "classes": {"1": "soft"}, "field": "KIND"},
            {"file": "c.shp", "field": "KIND", "class": "soft"},
            {"file": "c.shp"},
        ]
    )
    assert "only with a raster" in found["ground.0.classes"]
    assert "missing" in found["ground.1.classes"]
    assert "the file says" in found["ground.1.class"]
    assert "number" in found["ground.2.classes.one"]
    assert ".shp" in found["ground.3.field"]
    assert "the file says" in found["ground.4.class"]
    assert "missing" in found["ground.5.class"]


def test_a_terrain_file_is_a_raster_or_a_mesh():
    assert ".stl" in rules(terrain={**TERRAIN, "file": "t.xyz"})["terrain.file"]
    mesh = {**TERRAIN, "file": "t.stl", "nodes": "corner"}
    assert "raster" in rules(terrain=mesh)["terrain.nodes"]


def test_what_stands_is_complete():
    found = rules(
        forest=[{"height": 9, "polygon": SQUARE}, {"density": "open", "drag": 1, "height": 9}],
        tree=[{"position": [0, 0], "mu": 0.4}, {"file": "t.csv", "height": 3, "mu": 0.4}],
        barrier=[{"name": "a", "line": [[0, 0], [1, 1]], "capacity": 1e5}],
    )
    assert {*found} == {
        *("forest.0.density", "forest.1.drag", "forest.1.polygon", "tree.0.diameter"),
        *("tree.0.height", "tree.1.height", "barrier.0.height"),
    }


def test_every_piece_of_a_barrier_has_a_length():
    line = [[2.5, 1], [2.5, 1.0], [3, 1], [2.5, 1], [2.5, 1]]
    found = rules(barrier=[{"name": "a", "line": line}, {"name": "b", "line": [[0, 0], [1, 0]]}])
    rule = "the same point as the one before: leave it out"
    assert found == {"barrier.0.line.1": rule, "barrier.0.line.4": rule}
    with pytest.raises(ValueError, match=r"barrier\.0\.line\.1\n.*the same point"):
        Scene(**tables(barrier=[{"name": "a", "line": line[:3]}]))


def test_a_rock_is_lifted_against_gravity():
    run = {**RUN, "lift": 0.2}
    assert "needs gravity" in rules(run=run, gravity={"vector": [0, 0, 0]})["run.lift"]
    assert rules(run=run, gravity={"vector": [0, 0, -1]}) == rules(run=run) == {}
    assert rules(gravity={"vector": [0, 0, 0]}) == {}


def test_trajectories_are_a_number_or_a_list():
    assert Scene(**tables()).output.trajectories == 50
    chosen = Scene(**tables(output={"trajectories": np.array([3, 7])}))
    assert chosen.output.trajectories == (3, 7)
    with pytest.raises(ValueError, match="greater than or equal to 0"):
        Scene(**tables(output={"trajectories": -1}))


def test_files_of_rockfall_are_looked_for():
    text = """
run = {duration = 1, method = "nonsmooth"}
terrain = {file = "no.asc", class = "hard"}
ground = [{class = "soft", file = "no.shp"}]
forest = [{density = "open", height = 9, file = "no.tif"}]
tree = [{file = "no.csv", mu = 0.4}]
"""
    with pytest.raises(SceneError) as caught:
        loads(text)
    lacking = [p.key for p in caught.value.problems if "no such file" in p.message]
    assert lacking == [
        'terrain.file = "no.asc"',
        'ground[0].file = "no.shp"',
        'forest[0].file = "no.tif"',
        'tree[0].file = "no.csv"',
    ]
