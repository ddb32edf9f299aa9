import numpy as np
import pytest
from pydantic import ValidationError

from warpdem.errors import SceneError
from warpdem.input.consistency import consistency
from warpdem.input.decode import loads
from warpdem.input.scene import Contact, Scene
from warpdem.input.scene_run import ROCKABLE, Numerics, Run

BALL = {"kind": "sphere", "name": "ball", "radius": 0.1}
BOX = {"kind": "box", "name": "box", "size": [1, 1, 2]}
LAW = {"kn": 1e6, "kt": 1e6, "en2": 0.5, "mu": 0.3}


def tables(**other):
    return {
        "run": {"duration": 1.0},
        "shape": [BALL, BOX],
        "body": [{"shape": "ball", "position": [0, 0, 0], "density": 1e3}],
        **other,
    }


def rules(**other):
    """Faults of a scene's raw tables as key path: rule."""
    return {".".join(map(str, f.path)): f.rule for f in consistency(tables(**other))}


def body(group, *, fixed=False, shape="ball"):
    return {"shape": shape, "group": group, "position": [0, 0, 0], "density": 1.0, "fixed": fixed}


def fill(**other):
    return {
        "name": "f",
        "shapes": ["ball"],
        "kind": "lattice",
        "density": 1.0,
        "region": {"min": [0, 0, 0], "max": [1, 1, 1]},
        **other,
    }


def test_python_builds_scenes_from_tables_models_and_arrays():
    scene = Scene(
        run=Run(duration=np.float64(2.0)),
        shape=[BALL],
        body=[{"shape": "ball", "position": np.array([0, 0, 1.0]), "density": 1e3}],
    )
    assert scene.body[0].position == (0.0, 0.0, 1.0)
    assert scene.gravity.vector == (0.0, 0.0, -9.81)
    assert scene.frame_interval == 2.0 / 50


def test_python_gets_faults_between_keys_too():
    with pytest.raises(ValidationError, match="no shape has this name"):
        Scene(**tables(body=[body("a", shape="bll")]))


def test_a_scene_does_not_change():
    scene = Scene(**tables())
    with pytest.raises(ValidationError, match="frozen"):
        scene.run = Run(duration=3.0)


def test_a_scene_survives_its_own_dump():
    scene = Scene(**tables(fill=[fill()], contact=[{"groups": ["default", "default"], **LAW}]))
    assert Scene.model_validate(scene.model_dump(exclude_unset=True)) == scene
    assert Scene.model_validate_json(scene.model_dump_json()) == scene


def test_orientation_is_normalised_within_rounding():
    turned = {**body("a"), "orientation": [0.7071068, 0.7071068, 0, 0]}
    q = Scene(**tables(body=[turned])).body[0].orientation
    assert sum(part * part for part in q) == pytest.approx(1.0, abs=1e-15)


def test_compat_sets_all_numerics():
    assert Run(duration=1.0).resolved() == Numerics()
    assert Run(duration=1.0, compat="rockable").resolved() == ROCKABLE
    assert Run(duration=1.0, rotation="taylor").resolved() == Numerics(rotation="taylor")


def test_compat_refuses_another_choice_beside_it():
    found = rules(run={"duration": 1, "compat": "rockable", "rotation": "no_squish"})
    assert found == {"run.rotation": 'compat = "rockable" sets "taylor": leave one of the two out'}
    assert not rules(run={"duration": 1, "compat": "rockable", "rotation": "taylor"})


def test_list_distance_is_rockables_alone():
    assert "run.list_distance" in rules(run={"duration": 1, "list_distance": 0.1})
    assert not rules(run={"duration": 1, "list_distance": 0.1, "compat": "rockable"})


@pytest.mark.parametrize("clock", [{"run": {"duration": 1, "dt": 2}}, {"output": {"every": 1e-3}}])
def test_a_step_is_no_longer_than_the_run_or_a_frame(clock):
    found = rules(**{"run": {"duration": 1, "dt": 0.01}, **clock})
    assert list(found) == ["run.dt"]


def test_names_are_unique_within_their_kind():
    found = rules(shape=[BALL, BALL, {**BOX, "name": "ball"}])
    assert found == dict.fromkeys(["shape.1.name", "shape.2.name"], "already the name of shape[0]")
    named = {**body("a", fixed=True), "name": "x"}
    assert "body.1.name" in rules(body=[named, named])
    assert not rules(body=[{**body("a", fixed=True), "name": ""}] * 2)


def test_unknown_shapes_are_reported_once_each_with_the_nearest_name():
    found = rules(body=[body("a", shape="bal", fixed=True)] * 3)
    assert found == {
        "body.0.shape": 'no shape has this name; did you mean "ball"? (and 2 more alike)'
    }
    found = rules(body=[body("a", shape="cone", fixed=True)])
    assert found == {"body.0.shape": "no shape has this name; there are: ball, box"}


def test_what_moves_has_a_density():
    bare = {"shape": "ball", "position": [0, 0, 0], "group": "rok"}
    found = rules(body=[bare], group=[{"name": "rock", "density": 1e3}])
    assert found["body.0.density"] == (
        "missing: what moves needs a density [kg/m^3] here or in a [[group]] named "
        '"rok"; did you mean "rock"?'
    )
    assert not rules(body=[bare], group=[{"name": "rok", "density": 1e3}])
    assert not rules(body=[{**bare, "fixed": True}])


def test_terrain_is_fixed():
    ground = {"kind": "terrain", "name": "ground", "file": "x.asc"}
    assert "body.0.shape" in rules(shape=[ground], body=[body("a", shape="ground")])
    assert not rules(shape=[ground], body=[body("a", shape="ground", fixed=True)])
    assert "fill.0.shapes.0" in rules(shape=[BALL, ground], fill=[fill(shapes=["ground"])])


def test_groups_that_can_meet_need_a_contact():
    bodies = [body("a"), body("a"), body("b"), body("w", fixed=True), body("v", fixed=True)]
    assert rules(body=bodies)["contact"] == (
        'groups that can meet lack a [[contact]]: ["a", "a"], ["a", "b"], ["a", "v"], ["a", "w"], '
        '["b", "v"], ["b", "w"]'
    )
    pairs = [("a", "a"), ("b", "a"), ("v", "a"), ("a", "w"), ("b", "v"), ("w", "b")]
    assert not rules(body=bodies, contact=[{"groups": pair, **LAW} for pair in pairs])


def test_a_fill_meets_itself_unless_it_is_one_body():
    assert "contact" in rules(body=[], fill=[fill()])
    assert not rules(body=[], fill=[fill(count=1)])


def test_fixed_bodies_need_no_contact_and_no_body_is_a_scene():
    assert not rules(body=[body("a", fixed=True), body("b", fixed=True)])
    assert not rules(body=[], shape=[])


def test_a_pair_of_groups_has_one_contact_in_either_order():
    contacts = [{"groups": ["a", "b"], **LAW}, {"groups": ["b", "a"], **LAW}]
    found = rules(body=[body("a"), body("b", fixed=True)], contact=contacts)
    assert found == {"contact.1.groups": "contact[0] is for these groups already"}


def test_a_contact_names_groups_there_are():
    contacts = [{"groups": ["rock", "wal"], **LAW}]
    found = rules(body=[body("rock"), body("wall", fixed=True)], contact=contacts)
    assert found["contact.0.groups.1"] == (
        'no group, body or fill uses this name; did you mean "wall"?'
    )
    assert '["rock", "wall"]' in found["contact"]


def test_rolling_has_a_stiffness_and_a_cap():
    pair = {"groups": ["default", "default"], **LAW}
    assert list(rules(contact=[{**pair, "kr": 1.0}])) == ["contact.0.kr"]
    assert list(rules(contact=[{**pair, "mur": 1.0}])) == ["contact.0.mur"]
    assert not rules(contact=[{**pair, "kr": 1.0, "mur": 0.1}])


def test_a_box_holds_its_rounding():
    assert list(rules(shape=[BALL, {**BOX, "rounding": 0.51}])) == ["shape.1.rounding"]
    assert not rules(shape=[BALL, {**BOX, "rounding": 0.5}])


def test_declared_mass_is_complete_and_possible():
    assert list(rules(shape=[BALL, {**BOX, "volume": 1.0}])) == ["shape.1.volume"]
    wrong = {**BOX, "volume": 1.0, "inertia_over_mass": [1, 1, 2.1]}
    assert list(rules(shape=[BALL, wrong])) == ["shape.1.inertia_over_mass"]
    assert not rules(shape=[BALL, {**wrong, "inertia_over_mass": [1, 1, 2]}])


def test_faces_and_edges_join_different_vertices_that_exist():
    frame = {
        "kind": "polyhedron",
        "name": "p",
        "vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        "faces": [[0, 1, 2], [0, 1, 3], [0, 1, 1]],
        "edges": [[0, 0], [0, 1]],
        "rounding": 0.1,
    }
    assert rules(shape=[BALL, frame]) == {
        "shape.1.faces.1": "names a vertex beyond the last, number 2",
        "shape.1.faces.2": "names a vertex twice",
        "shape.1.edges.0": "names a vertex twice",
    }


def test_a_fill_says_how_many_of_what_and_where():
    law = {"contact": [{"groups": ["default", "default"], **LAW}]}
    region = {"min": [0, 0, 0], "max": [1, 0, 1]}
    cut = {"kind": "normal", "min": 1.0, "mean": 3.0, "sd": 1.0, "max": 2.0}
    assert list(rules(fill=[fill(weights=[1, 2])], **law)) == ["fill.0.weights"]
    assert list(rules(fill=[fill(kind="random")], **law)) == ["fill.0.count"]
    assert list(rules(fill=[fill(must_fit=True)], **law)) == ["fill.0.must_fit"]
    assert list(rules(fill=[fill(region=region)], **law)) == ["fill.0.region.max"]
    assert list(rules(fill=[fill(size=cut)], **law)) == ["fill.0.size.mean"]
    assert list(rules(fill=[fill(size={**cut, "max": 0.5})], **law)) == ["fill.0.size.max"]
    assert list(rules(fill=[fill(kind="random", count=3, spacing=0.1)], **law)) == [
        "fill.0.spacing"
    ]


def test_the_contact_table_is_symmetric_and_of_the_groups_asked_for():
    bodies = [body("a"), body("b", fixed=True), body("c", fixed=True)]
    contacts = [{"groups": ["b", "a"], **LAW}, {"groups": ["a", "c"], **LAW, "mu": 0.7}]
    table = Scene(**tables(body=bodies, contact=contacts)).contact_table(["a", "c"])
    assert table.keys() == {("a", "c"), ("c", "a")}
    assert table["a", "c"] is table["c", "a"]
    assert table["a", "c"].mu == 0.7


def test_physical_parameters_have_no_default():
    with pytest.raises(ValidationError) as caught:
        Contact.model_validate({"groups": ["a", "b"]})
    assert {error["loc"][0] for error in caught.value.errors()} == {"kn", "kt", "mu"}


def test_a_contact_says_how_it_damps():
    law = {**LAW}
    law.pop("en2")
    with pytest.raises(ValidationError, match="damping_ratio"):
        Scene(**tables(contact=[{"groups": ["default", "default"], **law}]))


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("", "lack a [[contact]]"),
        (
            """[[contact]]
groups = ["a", "a"]
law = "custom"
file = "laws.py"
kn = 1.0
kt = 0.0
mu = 0.0""",
            "missing: law",
        ),
    ],
)
def test_a_rule_about_a_key_that_is_not_there_is_told_once(text, rule):
    balls = "".join(
        f'[[body]]\nshape = "ball"\ngroup = "a"\ndensity = 1.0\nposition = [{x}, 0, 0]\n'
        for x in (0, 3)
    )
    shape = '[run]\nduration = 1.0\n[[shape]]\nname = "ball"\nkind = "sphere"\nradius = 1.0\n'
    with pytest.raises(SceneError) as error:
        loads(shape + balls + text)
    assert str(error.value).count(rule) == 1
