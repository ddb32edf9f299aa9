"""What of a conf file goes where in a scene."""

import pytest
from conffiles import CONTACT, SHAPES, TWO, brought, conf, problems, row, tables, write

from warpdem.converting.convert import converted, scene_text
from warpdem.errors import SceneError
from warpdem.input import decode
from warpdem.input.scene import Scene


def test_scene_of_a_plain_file(tmp_path):
    scene = tables(tmp_path, head="tmax 0.1\ndt 1e-4\ninterConf 0.01\ndVerlet 0.03")

    assert scene["run"] == {
        "duration": 0.1,
        "dt": 1e-4,
        "compat": "rockable",
        "list_distance": 0.03,
    }
    assert scene["gravity"] == {"vector": [0.0, 0.0, -9.81]}
    assert scene["group"] == [{"name": "g0", "density": 2500.0}]
    assert scene["contact"] == [
        {"groups": ["g0", "g0"], "kn": 1e6, "kt": 8e5, "en2": 0.25, "mu": 0.5}
    ]
    assert scene["output"] == {"every": 0.01}
    assert scene["shape"] == [
        {"kind": "shp", "name": "plate", "file": "shapes.shp"},
        {"kind": "shp", "name": "ball", "file": "shapes.shp"},
    ]
    assert scene["body"] == [
        {"name": "body0", "shape": "plate", "group": "g0", "fixed": True, "position": [0.0] * 3},
        {"name": "body1", "shape": "ball", "group": "g0", "position": [0.0, 0.0, 0.2]},
    ]
    assert {"bond", "force", "driver", "cell"}.isdisjoint(scene)
    Scene.model_validate(scene)


def test_accurate_leaves_the_program_out(tmp_path):
    scene = tables(tmp_path, accurate=True, head="tmax 0.1\ndt 1e-4\ndVerlet 0.03")

    assert scene["run"] == {"duration": 0.1, "dt": 1e-4}


def test_run_ends_with_the_step_that_passes_tmax(tmp_path):
    scene = tables(tmp_path, head="tmax 0.099996\ndt 2e-5")

    assert scene["run"]["duration"] == 5000 * 2e-5


def test_time_that_does_not_begin_at_zero(tmp_path):
    result = brought(tmp_path, head="t 0.3\ntmax 0.4\ndt 1e-4")

    assert result.tables["run"]["duration"] == pytest.approx(0.1, abs=1e-15)
    assert any("time begins at 0" in note for note in result.notes)


def test_values_not_given_are_the_programs(tmp_path):
    scene = tables(tmp_path, head="")

    assert scene["run"]["duration"] == 1.0
    assert scene["run"]["dt"] == 1e-6
    assert scene["output"]["every"] == 0.25


def test_state_of_a_body_comes_to_the_last_digit(tmp_path):
    turn = [0.5, -0.1, 0.7, 0.5]
    there = row("ball", "0.1 1e-17 -3.3333333333333335", velocity="1e29 -0.1 2", size=0.3,
                cluster=4, turn=" ".join(map(repr, turn)))  # fmt: skip
    result = brought(tmp_path, rows=[row("plate"), there])
    scene = decode.loads(
        scene_text(result, tmp_path).replace('"shapes.shp"', f'"{tmp_path}/shapes.shp"')
    )
    body = scene.body[1]

    assert body.position == (0.1, 1e-17, -3.3333333333333335)
    assert body.velocity == (1e29, -0.1, 2.0)
    assert body.scale == 0.3
    assert body.cluster == 4
    assert body.orientation == pytest.approx(turn, abs=1e-15)


def test_remarks_and_disabled_bodies(tmp_path):
    rows = ["#name group ...", TWO[0], "! " + TWO[1], TWO[1]]
    text = conf(rows=rows).replace("Particles 4", "Particles 3")
    text = text.replace("density", "# density 0 1\n/ a remark\ndensity", 1)
    scene = converted(write(tmp_path, text), tmp_path).tables

    assert [body["shape"] for body in scene["body"]] == ["plate", "ball"]
    assert scene["group"][0]["density"] == 2500.0


def test_scene_text_reads_back_as_the_tables(tmp_path):
    result = brought(tmp_path)
    text = scene_text(result, tmp_path / "input.txt")
    text = text.replace('"shapes.shp"', f'"{tmp_path / "shapes.shp"}"')

    given = decode.loads(text)
    meant = Scene.model_validate(result.tables)

    assert given.body == meant.body
    assert given.contact == meant.contact
    assert given.run == meant.run


def test_commands_on_bodies_are_carried_out(tmp_path):
    scene = tables(
        tmp_path,
        "setAllVelocities 1 2 3",
        "particlesClonage 1 1 0.5 0 0",
        rows=[TWO[0], row("ball", "0 0 0.2", cluster=3)],
    )
    plate, ball, clone = scene["body"]

    assert "velocity" not in plate
    assert ball["velocity"] == clone["velocity"] == [1.0, 2.0, 3.0]
    assert clone["position"] == [0.5, 0.0, 0.2]
    assert clone["cluster"] == 3 - 1 + 3 + 1


def test_sizes_are_drawn_as_by_libstdcpp(tmp_path):
    # std::default_random_engine e; std::uniform_real_distribution<>(0, 1)(e), three times
    scene = tables(
        tmp_path, "homothetyRange 0 2 1 2 0", rows=[row("ball", f"{x} 0 0") for x in range(3)],
        driven=0,
    )  # fmt: skip

    assert [body["scale"] - 1.0 for body in scene["body"]] == pytest.approx(
        [0.13153778773876065, 0.4586501320232198, 0.21895918621247895], abs=4e-16
    )


def test_what_has_no_counterpart_is_listed(tmp_path):
    lines = {
        "Integrator Beeman": "velocity Verlet",
        "BodyForce AttractingPoint 0 0 0 9.81": "not brought",
        "DataExtractor TrackBody 1 track.txt 10": "not brought",
        "Tempo NDCoeff Ramp 0 1 0 0.7": "do not change during a run",
        "initSpringJoint 0 0 0 0 1 0 0 0 1e5": "a spring",
        "useSoftParticles 1e9 0.3": "rigid",
        "ContactPartnership SurfaceWeight": "does nothing",
        "preventCrossingLength 0.1": "not brought",
        "randomlyOrientedVelocities 2": "drawn at random",
        "copyParamsToInterfaces inner": "changes nothing",
        "viscTContact 0 0 3": "geoVisc alone",
        "h 1 0 0 0 1 0 0 0 1": "usePeriodicCell is not 1",
        "DVerlet 0.1\nUpdateNL linkCells\ncellMinSizes 1 1 1": (
            "DVerlet 0.1; UpdateNL linkCells; cellMinSizes 1 1 1"
        ),
    }
    (tmp_path / "dataExtractors.txt").write_text("dnStat dn.txt 10\n")
    result = brought(tmp_path, *lines)
    text = scene_text(result, tmp_path / "input.txt")

    for said in [*lines.values(), "dataExtractors.txt"]:
        assert any(said in note for note in result.notes), said
    for note in result.notes:
        assert f"#   {note}" in text


def test_stored_history_is_listed(tmp_path):
    contact = "0 1 2 0 0 " + "0 " * 18
    result = brought(tmp_path, f"Interactions 1\n{contact}", "Interfaces 1\n0 1 1 0.0 0 0 0")

    assert any("1 Interactions" in note for note in result.notes)
    assert any("1 Interfaces" in note for note in result.notes)


def test_shape_without_mass_and_driven_velocity_are_listed(tmp_path):
    result = brought(tmp_path, rows=[row("plate", velocity="0 0 1"), TWO[1]])

    assert any('shape "plate": its mass' in note for note in result.notes)
    assert any("body0: its velocity is left out" in note for note in result.notes)
    assert "velocity" not in result.tables["body"][0]


def test_library_beside_the_file_goes_before_one_elsewhere(tmp_path):
    text = conf().replace("shapeFile shapes.shp", "shapeFile /nowhere/lib/shapes.shp")
    scene = converted(write(tmp_path, text), tmp_path / "scenes").tables

    assert {shape["file"] for shape in scene["shape"]} == {"../shapes.shp"}


def test_all_problems_come_at_once_with_their_lines(tmp_path):
    found = problems(
        tmp_path,
        "knContat 0 0 1",
        "ktContact 0 zero 1",
        "forceLaw Defualt",
        "particlesClonage 5 6 0 0 0",
        rows=[TWO[0], row("ball", turn="1 0 0 x")],
    )

    assert [problem.split()[0].rstrip(":") for problem in found] == [
        f"input.txt:{line}" for line in (19, 20, 21, 22, 23)
    ]
    assert "should be a number, not 'x'" in found[0]
    assert 'no keyword of Rockable; did you mean "knContact"?' in found[1]
    assert "there is no law named 'Defualt'" in found[3]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("density 0 2500", ""), "density 0 is missing"),
        (("knContact 0 0 1e6", ""), "lack a positive knContact"),
        (("shapeFile shapes.shp", ""), "names no shapeFile"),
        (("shapeFile shapes.shp", "shapeFile other.shp"), "other.shp"),
        (("ball 0", "bal 0"), 'did you mean "ball"?'),
        (("dt 1e-4", "dt 0"), "dt should be positive"),
        (("dt 1e-4", "dt 1e-308"), "dt should be positive"),
        (("tmax 0.1", "tmax 1e308"), "too large to compute with"),
        (("tmax 0.1", "tmax 0"), "tmax should lie after"),
        (("1 0 0 0 0 0 0", "0 0 0 0 0 0 0"), "quaternion of length 0"),
        (("Rockable", "Rock"), "begins with the word Rockable"),
    ],
)
def test_what_is_wrong(tmp_path, change, said):
    old, new = change
    text = conf()
    assert old in text
    with pytest.raises(SceneError, match=said.replace("?", r"\?")):
        converted(write(tmp_path, text.replace(old, new)), tmp_path)


def test_unreadable_file(tmp_path):
    with pytest.raises(SceneError, match="cannot be read"):
        converted(tmp_path / "none.txt", tmp_path)


def test_empty_file_has_no_traceback(tmp_path):
    for text in ("", "Rockable", "Rockable 21-08-2022\nParticles", SHAPES, CONTACT):
        with pytest.raises(SceneError):
            converted(write(tmp_path, text), tmp_path)
