import pytest
from pydantic import TypeAdapter, ValidationError
from releasing import BLOCK

from warpdem.input.rules_release import RULES
from warpdem.input.scene_release import Release
from warpdem.input.scene_rock import Rock

ROCK = {"name": "a", "kind": "mesh", "file": "a.stl", "mass": 1.0}
AT = {"kind": "points", "points": [[0, 0]]}
AREA = {"kind": "area", "polygon": [[0, 0], [1, 0], [0, 1]]}
TABLE = {"kind": "table", "file": "a.csv"}


def rules(rock=(BLOCK,), release=(), **other):
    """Faults of raw tables as key path: rule."""
    scene = {"rock": [*rock], "release": [*release], **other}
    found = [fault for rule in RULES for fault in rule(scene)]
    return {".".join(map(str, fault.path)): fault.rule for fault in found}


def on_rock(**keys):
    return rules(rock=[{**BLOCK, **keys}])


def on_release(**keys):
    return rules(release=[{**AT, **keys}])


@pytest.mark.parametrize("release", [AT, TABLE, {**AT, "rocks": ["block"], "weights": [2]}])
def test_plain_scenes_break_no_rule(release):
    assert rules(release=[release]) == {}
    assert rules(release=[release, AREA], ensemble={"count": 10}) == {}


def test_a_builder_takes_two_of_volume_mass_and_density():
    plain = {key: BLOCK[key] for key in ("name", "kind", "form")}
    assert rules(rock=[plain]) == {"rock.0": "give two of volume, mass and density"}
    lacking = "give one of volume and density beside mass"
    assert rules(rock=[{**plain, "mass": 1.0}]) == {"rock.0": lacking}
    over = on_rock(mass=1.0)
    assert over == {"rock.0.density": "follows from volume and mass: leave one of them out"}


def test_other_rocks_take_mass_or_density():
    assert rules(rock=[ROCK]) == {}
    bare = {key: ROCK[key] for key in ("name", "kind", "file")}
    assert rules(rock=[bare]) == {"rock.0": "give one of mass and density"}
    assert "rock.0.density" in rules(rock=[{**ROCK, "density": 1.0}])


def test_a_rounding_fits_into_the_volume():
    assert on_rock(rounding=0.36) == {}
    assert "less than 0.363 m" in on_rock(rounding=0.364)["rock.0.rounding"]
    heavy = {**BLOCK, "mass": 540.0, "rounding": 0.364}
    del heavy["volume"]
    assert "less than 0.363 m" in rules(rock=[heavy])["rock.0.rounding"]


def test_points_stand_in_one_place():
    cloud = {"name": "a", "kind": "points", "mass": 1.0}
    assert "rock.0.points" in rules(rock=[cloud])
    both = {**cloud, "points": [[0, 0, 0]] * 4, "file": "a.xyz"}
    assert "rock.0.file" in rules(rock=[both])
    assert rules(rock=[{**cloud, "file": "a.xyz"}]) == {}


def test_names_of_rocks_are_unique():
    assert rules(rock=[BLOCK, BLOCK]) == {"rock.1.name": "already the name of rock[0]"}


def test_a_rock_names_a_solid_shape():
    rock = {"name": "a", "kind": "shape", "shape": "cube", "mass": 1.0}
    shapes = [{"name": "cubes", "kind": "box"}, {"name": "floor", "kind": "plane"}]
    told = rules(rock=[rock], shape=shapes)["rock.0.shape"]
    assert told == 'no [[shape]] has this name; did you mean "cubes"?'
    told = rules(rock=[{**rock, "shape": "floor"}], shape=shapes)["rock.0.shape"]
    assert told == 'is of kind "plane", which is no solid that can fall'
    assert rules(rock=[{**rock, "shape": "cubes"}], shape=shapes) == {}


def test_releases_name_rocks_there_are_and_weigh_each():
    told = on_release(rocks=["blok"])
    assert told == {"release.0.rocks.0": 'no [[rock]] has this name; did you mean "block"?'}
    assert "release.0.rocks.1" in on_release(rocks=["block", "block"])
    told = on_release(rocks=["block"], weights=[1, 2])
    assert told == {"release.0.weights": "must have one weight for each of the 1 rocks"}
    assert "needs rocks" in on_release(weights=[1])["release.0.weights"]
    assert "rock" in rules(rock=[], release=[AT])


def test_a_start_has_one_velocity_and_one_spin():
    assert "release.0.speed" in on_release(velocity=[0, 0, 0], speed=1.0, azimuth=0.0)
    assert "release.0.spin_rate" in on_release(spin=[0, 0, 0], spin_rate=1.0)
    assert "missing: where" in on_release(speed=1.0)["release.0.azimuth"]
    assert on_release(speed=1.0, dip=90.0) == {}
    assert "without speed" in on_release(dip=90.0)["release.0.dip"]


def test_ranges_go_up():
    assert on_release(height=[0.2, 1.0], spin_rate=[1, 1]) == {}
    assert "smaller to its larger" in on_release(height=[1.0, 0.2])["release.0.height"]
    told = on_release(speed=1.0, azimuth=[350, 10])["release.0.azimuth"]
    assert "write [350, 370]" in told


def test_an_area_stands_in_one_place():
    count = {"ensemble": {"count": 1}}
    assert "release.0.polygon" in rules(release=[{"kind": "area"}], **count)
    assert "release.0.file" in rules(release=[{**AREA, "file": "a.shp"}], **count)


def test_a_table_and_the_release_do_not_say_the_same():
    velocity = {"vx": "u", "vy": "v", "vz": "w"}
    section = {**TABLE, "columns": velocity, "speed": 1.0, "azimuth": 0.0}
    assert "release.0.speed" in rules(release=[section])
    lacking = {**TABLE, "columns": {"vx": "u", "vy": "v"}}
    assert "give vx, vy, vz" in rules(release=[lacking])["release.0.columns.vx"]
    named = {**TABLE, "columns": {"rock": "id"}, "rocks": ["block"]}
    assert "release.0.rocks" in rules(release=[named])


def test_lines_and_areas_need_a_number_of_trajectories():
    told = rules(release=[AT, AREA])["ensemble.count"]
    assert told == 'missing: release[1] of kind "area" has no number of its own'


@pytest.mark.parametrize(
    ("model", "table"),
    [
        (Release, {**AT, "height": [1, 2, 3]}),
        (Release, {**AT, "height": -1.0}),
        (Release, {**AT, "dip": [0, 91]}),
        (Release, {**AT, "orientation": "aligned"}),
        (Release, {**AT, "points": [[0, 0, 0, 0]]}),
        (Release, {**AREA, "polygon": [[0, 0], [1, 1]]}),
        (Rock, {**BLOCK, "form": "round"}),
        (Rock, {**BLOCK, "vertices": 3}),
    ],
)
def test_values_out_of_bounds_are_refused(model, table):
    with pytest.raises(ValidationError):
        TypeAdapter(model).validate_python(table)


def test_a_rock_of_no_kind_has_no_other_fault():
    assert rules(rock=[{"name": "a", "kind": "bulder"}]) == {}
