"""Bonds as a scene asks for them: where they are made, what is refused, what is written."""

import csv

import numpy as np
import pytest
from pydantic import ValidationError

from warpdem.__main__ import main
from warpdem.bonds.creation import bonds_of
from warpdem.bonds.fragments import fragments, sizes
from warpdem.checks.check import build_shapes, check
from warpdem.errors import SceneError
from warpdem.filling.placement import place
from warpdem.input.scene import Scene
from warpdem.input.scene_cell import Cell

SIDE, ROUNDING = 0.1, 0.01
GLUE = {"between": "inner", "rule": "faces", "tolerance": 1e-4, "kn": 1e6, "kt": 5e5}


def row(bonds, places, *, clusters=None, **run):
    """Cubes at places, group and density alike."""
    clusters = clusters or [0] * len(places)
    return Scene.model_validate(
        {
            "run": {"duration": 1.0} | run,
            "shape": [{"name": "cube", "kind": "box", "size": [SIDE] * 3, "rounding": ROUNDING}],
            "body": [
                {"shape": "cube", "position": x, "density": 2e3, "cluster": cluster}
                for x, cluster in zip(places, clusters, strict=True)
            ],
            "contact": [{"groups": ["default"] * 2, "kn": 1e6, "kt": 0.0, "en2": 1.0, "mu": 0.0}],
            "bond": bonds,
        }
    )


def made(scene):
    shapes = build_shapes(scene)
    return bonds_of(scene, place(scene, shapes), shapes)


PAIR = [[0.0, 0.0, 0.0], [SIDE, 0.0, 0.0]]


@pytest.mark.parametrize("rule", ["vertices", "faces"])
def test_cubes_face_to_face_get_a_bond_at_each_corner(rule):
    bonds = made(row([GLUE | {"rule": rule}], PAIR))
    corner = SIDE / 2 - ROUNDING

    assert bonds.counts.tolist() == [4]
    assert np.allclose(np.abs(bonds.sites.point - [SIDE / 2, 0.0, 0.0]), [0.0, corner, corner])
    assert np.allclose(bonds.sites.normal, [-1.0, 0.0, 0.0])
    assert bonds.area[0] == pytest.approx((2 * corner) ** 2)


def test_shifted_faces_are_bonded_at_the_corners_of_their_overlap():
    bonds = made(row([GLUE], [[0.0, 0.0, 0.0], [SIDE, 0.03, 0.02]]))
    half = SIDE / 2 - ROUNDING

    assert bonds.area[0] == pytest.approx((2 * half - 0.03) * (2 * half - 0.02))
    places = {(round(y, 9), round(z, 9)) for _, y, z in bonds.sites.point}
    assert places == {(y, z) for y in (-0.01, 0.04) for z in (-0.02, 0.04)}
    # of each cube one corner lies over the other's face, and two pairs of edges cross
    assert sorted(bonds.sites.kind.tolist()) == [3, 4, 5, 5]


def test_clusters_are_joined_by_one_bond_where_they_touch():
    glue = GLUE | {"rule": "clusters", "between": "outer"}
    places = [*PAIR, [2 * SIDE, 0.0, 0.0]]
    bonds = made(row([glue], places, clusters=[0, 1, 1]))

    assert bonds.bodies.tolist() == [[0, 1]]
    assert bonds.counts.tolist() == [1]


def test_faces_beyond_the_tolerance_are_not_bonded():
    with pytest.raises(SceneError, match=r"joins nothing.*raise tolerance"):
        made(row([GLUE], [[0.0, 0.0, 0.0], [SIDE + 2e-4, 0.0, 0.0]]))


def test_bonds_do_not_cross_the_boundary_of_a_cell():
    apart = row([GLUE], [[0.05, 0.2, 0.2], [0.45, 0.2, 0.2]])
    cell = {"size": [0.5, 0.5, 0.5]}
    with pytest.raises(SceneError, match="as they lie, not across its boundary"):
        made(apart.model_copy(update={"cell": Cell.model_validate(cell)}))
    with pytest.raises(SceneError) as open_space:
        made(apart)
    assert "boundary" not in str(open_space.value)


@pytest.mark.parametrize("walls", [True, False])
def test_surfaces_given_by_a_formula_have_nothing_to_bond_to(walls):
    contact = {"groups": ["default"] * 2, "kn": 1e6, "kt": 0.0, "en2": 1.0, "mu": 0.0}
    stood = Scene.model_validate(
        {
            "run": {"duration": 1.0},
            "shape": [
                {"name": "cube", "kind": "box", "size": [SIDE] * 3, "rounding": ROUNDING},
                {"name": "plane", "kind": "plane"},
            ],
            "body": [
                {"shape": "cube", "position": [0.0, 0.0, SIDE / 2], "density": 2e3},
                {"name": "floor", "shape": "plane", "position": [0.0] * 3, "fixed": True},
            ],
            "contact": [contact],
            "bond": [GLUE | {"walls": walls}],
        }
    )
    with pytest.raises(SceneError, match="joins nothing") as error:
        made(stood)
    told = '"floor" is a surface given by a formula' in str(error.value)
    assert told is walls


def test_two_entries_for_the_same_bodies_are_named():
    twice = [GLUE | {"name": "mortar"}, GLUE | {"name": "resin", "rule": "vertices"}]
    with pytest.raises(SceneError, match=r'joins "body\[0\]" and "body\[1\]", as bond "mortar"'):
        made(row(twice, PAIR))


def test_all_that_is_wrong_with_a_bond_is_told_at_once():
    wrong = GLUE | {"rule": "clusters", "m0": 1.0, "gc": 2.0, "en2": 0.5, "damping_ratio": 0.1}
    with pytest.raises(ValidationError) as error:
        row([wrong | {"groups": ["default", "rocks"]}], PAIR)
    told = str(error.value)

    for words in ("without kr", "has no area", "either damping_ratio or en2", "uses this name"):
        assert words in told


def test_check_reports_bonds_that_join_nothing():
    report = check(row([GLUE], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))

    assert any("joins nothing" in problem.message for problem in report.problems)


def test_shared_stiffness_is_that_of_the_interface():
    bonds = made(row([GLUE | {"share": True, "kr": 3.0}], PAIR))

    assert bonds.stiffness("kn").tolist() == [0.25e6]
    assert bonds.stiffness("kt").tolist() == [1.25e5]
    assert bonds.stiffness("kr").tolist() == [3.0]


def test_strengths_spread_after_weibull_with_mean_one():
    places = [[k * SIDE, j * SIDE, 0.0] for k in range(16) for j in range(16)]
    glue = GLUE | {"fn0": 1.0, "weibull": {"modulus": 3.0}}
    factor = made(row([glue], places)).factor
    other = made(row([glue], places, seed=1)).factor

    assert np.mean(factor) == pytest.approx(1.0, abs=0.05)
    # of a Weibull distribution of modulus 3
    assert np.std(factor) == pytest.approx(0.3634, abs=0.04)
    assert np.array_equal(factor, made(row([glue], places)).factor)
    assert not np.array_equal(factor, other)


def test_fragments_are_what_hangs_together():
    free = np.array([True] * 5 + [False])
    found = fragments(np.array([[3, 1], [4, 5], [1, 0]]), free)

    assert found.tolist() == [0, 0, 2, 0, 4, 4]
    size = sizes(found, np.array([1.0, 1.0, 5.0, 1.0, 1.0, 0.0]))
    assert (size.total, size.joined) == (3, 2)
    assert size.largest[:3].tolist() == [5.0, 3.0, 1.0]


SCENE = """
[run]
duration = 0.004
dt = 2e-5
[gravity]
vector = [0, 0, 0]
[output]
every = 0.001
contacts = true
compression = "zlib"
[[shape]]
name = "cube"
kind = "box"
size = [0.1, 0.1, 0.1]
[[body]]
name = "left, below"
shape = "cube"
position = [0, 0, 0]
density = 2500.0
velocity = [-1, 0, 0]
[[body]]
shape = "cube"
position = [0.1, 0, 0]
density = 2500.0
[[body]]
shape = "cube"
position = [0.2, 0, 0]
density = 2500.0
velocity = [3, 0, 0]
[[contact]]
groups = ["default", "default"]
kn = 1e6
kt = 8e5
en2 = 0.5
mu = 0.5
[[bond]]
between = "inner"
rule = "faces"
tolerance = 1e-4
kn = 1e6
kt = 5e5
fn0 = 300.0
"""


def rows(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def written(folder):
    return {name: (folder / name).read_bytes() for name in ("bonds.csv", "fragments.csv")}


def test_a_run_writes_what_broke_and_what_remains_and_resumes_without_doubling(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert main([str(file), "--out", str(whole), "--quiet"]) == 0
    breaks, remains = rows(whole / "bonds.csv"), rows(whole / "fragments.csv")

    assert len(breaks) > 0
    assert {line["mode"] for line in breaks} == {"tension"}
    assert breaks[0]["name_i"] in {"left, below", "body[1]"}
    assert [float(line["t"]) for line in breaks] == sorted(float(line["t"]) for line in breaks)
    assert len(remains) == 5
    assert int(remains[0]["fragments"]) == 1
    assert int(remains[-1]["fragments"]) == 1 + len(breaks)
    assert int(remains[-1]["interfaces"]) == 2 - len(breaks)
    short = ["--set", "run.duration=0.002"]
    assert main([str(file), "--out", str(parts), "--quiet", *short]) == 0
    resume = ["--out", str(parts), "--quiet", "--resume"]
    assert main([str(file), *resume]) == 0
    assert written(parts) == written(whole)


def test_frames_show_fragments_and_bonds(tmp_path):
    import meshio  # noqa: PLC0415 - an independent reader

    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    assert main([str(file), "--out", str(tmp_path / "run"), "--quiet"]) == 0
    first = meshio.read(tmp_path / "run" / "bodies_000000.vtu")
    last = meshio.read(tmp_path / "run" / "bodies_000004.vtu")
    bonds = meshio.read(tmp_path / "run" / "contacts_000000.vtu").point_data["bonded"]

    assert {int(v) for block in first.cell_data["fragment"] for v in block} == {0}
    assert len({int(v) for block in last.cell_data["fragment"] for v in block}) > 1
    assert bonds.tolist() == [1] * 8
