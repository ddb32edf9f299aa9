import subprocess
import sys

import numpy as np
import pytest

from warpdem.checks.check import check
from warpdem.checks.overlap import overlaps
from warpdem.errors import SceneError
from warpdem.input.decode import load, loads

SCENE = """
title = "blocks"
run = {duration = 1.0}
[[shape]]
kind = "box"
name = "block"
size = [0.1, 0.1, 0.2]
[[shape]]
kind = "sphere"
name = "ball"
radius = 0.05
[[shape]]
kind = "box"
name = "floor"
size = [4, 4, 0.2]
[[group]]
name = "rock"
density = 2600
[[body]]
shape = "floor"
group = "wall"
position = [0, 0, -0.1]
fixed = true
[[body]]
name = "first"
shape = "ball"
group = "rock"
position = [0, 0, 0.05]
[[body]]
name = "second"
shape = "ball"
group = "rock"
position = [0.2, 0, 0.05]
[[fill]]
name = "blocks"
shapes = ["block"]
group = "rock"
kind = "lattice"
count = 10
region = {min = [-1, -1, 0.1], max = [1, 1, 1]}
[[contact]]
groups = ["rock", "rock"]
kn = 1e6
kt = 1e6
en2 = 0.25
mu = 0.5
[[contact]]
groups = ["rock", "wall"]
kn = 1e6
kt = 1e6
en2 = 0.25
mu = 0.5
"""


def report(*overrides):
    return check(loads(SCENE, overrides=overrides))


def test_a_report_counts_bodies_features_and_groups():
    found = report()
    assert [(s.name, s.free, s.fixed, s.vertices, s.edges, s.faces) for s in found.shapes] == [
        ("block", 10, 0, 8, 12, 6),
        ("ball", 2, 0, 1, 0, 0),
        ("floor", 0, 1, 8, 12, 6),
    ]
    assert found.groups == (("rock", 12, 0), ("wall", 0, 1))
    block, ball = found.shapes[0].volume, 4.0 / 3.0 * np.pi * 0.05**3
    assert found.mass == pytest.approx(2600 * (10 * block + 2 * ball), rel=1e-12)
    assert found.frames == 51
    assert found.stages[-1] == "gather, kick and drift"
    assert not found.warnings
    assert not found.problems


def test_a_report_reads_well():
    lines = str(report()).splitlines()
    assert lines[0] == "scene: blocks"
    assert lines[1].startswith("bodies  12 free, 1 fixed, ")
    assert lines[2].split() == [
        *["shape", "kind", "free", "fixed", "vertices", "edges", "faces", "volume", "[m^3]"]
    ]
    assert any(line.startswith("step    ") and "(chosen)" in line for line in lines)


def test_an_unstable_step_is_a_problem_of_the_report():
    found = report("run.dt=0.01")
    assert found.step is None
    assert ["run.dt = 0.01: unstable" in str(problem) for problem in found.problems] == [True]
    assert "problems:" in str(found)


def test_a_step_above_the_bound_is_a_warning():
    dt = 1.1 * report().step.bound
    assert any("above the stability bound" in line for line in report(f"run.dt={dt}").warnings)


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("body.2.position=[0.05, 0, 0.05]", '"first" and "second" overlap by 0.05 m at the start'),
        ("contact.1.kt=0", "contact[1]: kt = 0 leaves no friction in spite of mu = 0.5"),
        (
            "output.every=2",
            "output.every is longer than run.duration: only the start and the end are written",
        ),
        ('body.1.shape="block"', None),
        (
            "contact.1.kn=100",
            (
                'contacts of "rock" and "wall": kn = 100 N/m lets "blocks[0]" sink in by 4.3 times '
                "its radius under its weight"
            ),
        ),
    ],
)
def test_doubts_are_warnings(override, expected):
    assert report(override).warnings == ((expected,) if expected else ())


@pytest.mark.parametrize(("faces", "doubted"), [(5, True), (6, False)])
def test_free_bodies_of_an_open_box_are_a_warning(faces, doubted):
    corners = [[x, y, z] for x in (0.0, 0.1) for y in (0.0, 0.1) for z in (0.0, 0.1)]
    sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    box = f'{{name="block", kind="polyhedron", vertices={corners}, faces={sides[:faces]}'
    found = report(f"shape.0={box}, rounding=0.01}}").warnings
    assert [line.startswith('shape "block" is open') for line in found] == [True] * doubted


@pytest.mark.parametrize(("kn", "doubted"), [(1e5, True), (1e8, False)])
def test_contacts_stiffer_than_what_breaks_are_a_warning(kn, doubted):
    bond = f'{{between="outer", rule="vertices", tolerance=1e-4, kn={kn}, kt=1e5, ft0=1.0}}'
    found = [line for line in report(f"bond=[{bond}]").warnings if "bond[0]: kn" in line]
    assert len(found) == (1 if doubted else 0)
    assert all("leaves more energy in the contact than it held" in line for line in found)


def test_what_no_body_uses_is_a_warning():
    assert report('group=[{name="rock", density=1e3}, {name="sand"}]').warnings == (
        'no body is in the group "sand"',
    )
    assert report("fill=[]").warnings == ('no body has the shape "block"',)


def test_a_scene_where_nothing_moves_or_nothing_is_runs_with_a_warning():
    assert report("body.1.fixed=true", "body.2.fixed=true", "fill=[]").warnings[0] == (
        "no body is free: nothing can change"
    )
    assert check(loads("run = {duration = 1.0}")).warnings == ("there are no bodies",)


def test_many_overlapping_balls_are_named_in_part():
    bodies = ", ".join(
        f'{{shape = "ball", position = [{k}, 0, 0.01], density = 1}}' for k in [*range(8)] * 2
    )
    found = report(
        f"body=[{bodies}]",
        "fill=[]",
        'contact=[{groups=["default", "default"], kn=1e6, kt=0, en2=1, mu=0}]',
    ).warnings
    named = [line for line in found if "overlap" in line]
    assert len(named) == 6
    assert named[-1] == "3 more pairs of balls overlap by over 10 % of a radius"


def test_bodies_whose_bounding_spheres_overlap_are_counted():
    block = '{{shape = "block", position = [{}, 0, 0.1], group = "rock"}}'
    found = report(
        f"body=[{block.format(0)}, {block.format(0.1)}]",
        "fill=[]",
        "contact=[{groups=['rock', 'rock'], kn=1e6, kt=0, en2=1, mu=0}]",
    )
    assert "bounding spheres that overlap at the start: 1 (pairs of bodies)" in found.notes


def test_shapes_that_are_no_solids_come_together_with_their_lines(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        "run = {duration = 1}\n"
        '[[shape]]\nkind = "mesh"\nname = "a"\nfile = "a.stl"\nrounding = 1\n'
        '[[shape]]\nkind = "terrain"\nname = "b"\nfile = "b.asc"\n'
    )
    (tmp_path / "a.stl").write_text("nothing")
    (tmp_path / "b.asc").write_text("nothing")
    with pytest.raises(SceneError) as caught:
        check(load(path))
    places = [problem.place for problem in caught.value.problems]
    assert places == [f"{path}:2", f"{path}:7"]


def test_overlaps_are_those_of_all_pairs():
    dice = np.random.default_rng(0)
    centres, radii = dice.uniform(-1, 1, (300, 3)), dice.uniform(0.02, 0.2, 300)
    fixed = dice.random(300) < 0.3
    apart = np.linalg.norm(centres[:, None] - centres, axis=2) < radii[:, None] + radii
    apart &= np.triu(np.ones_like(apart), 1) & ~(fixed[:, None] & fixed)
    found = overlaps(centres, radii, fixed)
    assert {tuple(pair) for pair in found.pairs} == {tuple(pair) for pair in np.argwhere(apart)}
    assert np.all(found.depths > 0.0)


def test_memory_grows_with_the_bodies():
    assert report("fill.0.count=100").memory.total > 3 * report("fill.0.count=10").memory.total


def test_checking_a_scene_needs_no_warp(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    program = (
        "import sys; from warpdem.input.decode import load; from warpdem.checks.check import check;"
        f"check(load({str(path)!r}));"
        "print([name for name in ('warp', 'pyvista', 'meshio', 'vtk') if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"
