import json
import random

import pytest

from warpdem.errors import SceneError
from warpdem.input import decode
from warpdem.input.lines import line_of, lines_of

GOOD = """\
title = "a ball on a floor"
[run]
duration = 1.0
[[shape]]
kind = "sphere"
name = "ball"
radius = 0.1
[[shape]]
kind = "box"
name = "floor"
size = [
    2.0,
    2.0,
    0.5,
]
[[body]]
shape = "ball"
group = "rock"
position = [0, 0, 1]
density = 2600
[[body]]
shape = "floor"
position = [0, 0, -0.25]
fixed = true
[[contact]]
groups = ["rock", "default"]
kn = 1e6
kt = 1e6
en2 = 0.25
mu = 0.5
"""


def problems(text, overrides=()):
    with pytest.raises(SceneError) as caught:
        decode.loads(text, "hopper.toml", overrides)
    return [str(problem) for problem in caught.value.problems]


def changed(old, new):
    assert old in GOOD
    return GOOD.replace(old, new)


def test_a_good_scene_has_no_problems():
    scene = decode.loads(GOOD)
    assert scene.shape[1].rounding == 0.05 * 0.5
    assert scene.body[0].position == (0.0, 0.0, 1.0)


def test_an_error_counts_and_lists_all_problems_in_the_order_of_the_file():
    text = changed("mu = 0.5", "fricton = 0.5").replace("en2 = 0.25", "en2 = 1.5")
    with pytest.raises(SceneError) as caught:
        decode.loads(text, "hopper.toml")
    assert str(caught.value) == (
        "hopper.toml: 3 problems\n"
        "  hopper.toml:25  contact[0].mu: missing: friction coefficient [-]\n"
        "  hopper.toml:29  contact[0].en2 = 1.5: must lie in (0, 1]\n"
        '  hopper.toml:30  contact[0].fricton: unknown key; did you mean "mu"?'
    )
    assert caught.value.exit_code == 2


def test_faults_of_keys_and_between_keys_come_together():
    text = changed('shape = "ball"', 'shape = "bal"').replace("kn = 1e6", 'kn = "stiff"')
    assert problems(text) == [
        'hopper.toml:17  body[0].shape = "bal": no shape has this name; did you mean "ball"?',
        'hopper.toml:27  contact[0].kn = "stiff": must be a number, not text',
    ]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("radius = 0.1", "radius = nan", "7  shape[0].radius = nan: must be finite"),
        ("radius = 0.1", "radius = inf", "7  shape[0].radius = inf: must be finite"),
        ("radius = 0.1", "radius = -1", "7  shape[0].radius = -1: must be greater than 0"),
        (
            "radius = 0.1",
            "radius = true",
            "7  shape[0].radius = true: must be a number, not true or false",
        ),
        ("radius = 0.1", "radius = 1" + "0" * 400, "7  shape[0].radius = inf: must be finite"),
        (
            "    0.5,\n",
            '    "a",\n',
            '14  shape[1].size[2] = "a": must be a number, not text',
        ),
        ("    0.5,\n", "", "11  shape[1].size = [2.0, 2.0]: must have 3 entries, not 2"),
        (
            "[run]\nduration = 1.0",
            "run = 3",
            "2  run = 3: must be written as [run], not a whole number",
        ),
        (
            "[run]\n",
            "[[run]]\n",
            "2  run = [{duration = 1.0}]: must be written as [run], not [[run]]",
        ),
        ("[[contact]]", "[contact]", "25  contact: must be written as [[contact]], not [contact]"),
        (
            "duration = 1.0",
            'duration = 1.0\ndt = "fast"',
            '4  run.dt = "fast": must be "auto" or a number',
        ),
        ("duration = 1.0", "duration = 1.0\ndt = 0", "4  run.dt = 0: must be greater than 0"),
        (
            "duration = 1.0",
            'duration = 1.0\ndevice = "gpu"',
            '4  run.device = "gpu": must be "auto", "cpu", "cuda" or "cuda:N"',
        ),
        (
            "duration = 1.0",
            "duration = 1.0\nseed = 1.0",
            "4  run.seed = 1.0: must be a whole number, not a number",
        ),
        (
            "position = [0, 0, 1]",
            "position = [0, 0, 1]\nmass = 3",
            '20  body[0].mass: unknown key; did you mean "density"?',
        ),
        (
            "radius = 0.1",
            "radius = 0.1\nkn = 3",
            "8  shape[0].kn: unknown key here; it belongs to [[contact]], [[bond]]",
        ),
        (
            'kind = "sphere"',
            'kind = "spere"',
            (
                '5  shape[0].kind = "spere": must be one of "box", "sphere", "capsule", "plane", '
                '"cylinder", "ball", "mesh", "polyhedron", "shp", "terrain"; did you mean "sphere"?'
            ),
        ),
        (
            'kind = "sphere"\n',
            "",
            (
                '4  shape[0].kind: missing: one of "box", "sphere", "capsule", "plane", '
                '"cylinder", "ball", "mesh", "polyhedron", "shp", "terrain"'
            ),
        ),
        (
            "en2 = 0.25",
            "en2 = 0",
            (
                "29  contact[0].en2 = 0: must lie in (0, 1]: no finite dashpot takes all energy "
                "out of a rebound; 1e-4 comes near"
            ),
        ),
        (
            "position = [0, 0, 1]",
            "position = [0, 0, 1]\norientation = [1, 1, 0, 0]",
            (
                "20  body[0].orientation = [1, 1, 0, 0]: must be a unit quaternion w, x, y, z; its "
                "length is 1.41421356, divide it by that: [0.707106781187, 0.707106781187, 0, 0]"
            ),
        ),
        (
            "radius = 0.1",
            "radius = 0.1\nextent = 2.0",
            "8  shape[0].extent: unknown key here; it belongs to [[shape]]",
        ),
    ],
)
def test_a_problem_says_line_key_value_and_rule(old, new, expected):
    found = problems(changed(old, new))
    assert f"hopper.toml:{expected}" in found


def test_a_file_that_is_not_there_is_a_problem():
    text = changed('kind = "sphere"\nname = "ball"\nradius = 0.1', "").replace(
        "[[shape]]\n\n", '[[shape]]\nkind = "mesh"\nname = "ball"\nfile = "no.stl"\nrounding = 1\n'
    )
    (found,) = problems(text)
    assert found.startswith('hopper.toml:7  shape[0].file = "no.stl": there is no such file in /')


def test_values_are_shown_short_and_on_one_line():
    (found,) = problems(changed('"a ball on a floor"', '["""a\nb""", ' + "1, " * 100 + "]"))
    assert found.startswith(r'hopper.toml:1  title = ["a\nb", 1, 1, ')
    assert len(found) < 140


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a = [1,\nb = 2", "x.toml:2: not TOML, column 1: Invalid value"),
        ("a = 1\na = 2", "x.toml:2: not TOML: Cannot overwrite a value"),
        ("a = 1\na = 2\n", "x.toml:2: not TOML, column 6: Cannot overwrite a value"),
        ("a = " + "[" * 5000 + "]" * 5000, "x.toml: is nested too deeply"),
        ("a = " + "9" * 5000, "x.toml: not TOML: a whole number has thousands of digits"),
    ],
)
def test_what_is_no_toml_is_one_line(text, expected):
    with pytest.raises(SceneError) as caught:
        decode.loads(text, "x.toml")
    assert [str(problem) for problem in caught.value.problems] == [expected]


def test_what_cannot_be_read_is_one_line(tmp_path):
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"a = 1\n\xff\xfe")
    for path, reason in [
        (tmp_path / "none.toml", "cannot be read: no such file or directory"),
        (tmp_path, "cannot be read: is a directory"),
        (binary, "is not UTF-8 text: byte 0xff on line 2"),
        ("a\0b", "cannot be read: embedded null byte"),
    ]:
        with pytest.raises(SceneError) as caught:
            decode.load(path)
        assert [str(problem) for problem in caught.value.problems] == [f"{path}: {reason}"]


def test_an_empty_file_lacks_only_the_run():
    assert problems("") == ["hopper.toml  run: missing: [run]: duration, time step and method"]


def test_a_byte_order_mark_and_windows_lines_are_read(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode())
    scene = decode.load(path)
    assert scene.title == "a ball on a floor"
    assert scene.directory == tmp_path
    assert scene.source == path


def test_a_long_list_of_problems_is_cut_but_kept():
    text = GOOD + '[[body]]\nshape = "ball"\nposition = 1\ndensity = 1\n' * 100
    with pytest.raises(SceneError) as caught:
        decode.loads(text)
    assert len(caught.value.problems) == 100 + 1  # and the contact of two balls
    assert str(caught.value).endswith("\n  ... and 61 more")


def test_set_changes_keys_and_entries():
    overrides = [
        "contact.0.mu=0.3",
        "contact[0].kr = 5",
        "contact.0.mur=.1",
        "run.device=cpu",
        "gravity.vector=[0, 0, 0]",
        'title="x=1"',
        "shape.1.size.2=1",
    ]
    scene = decode.loads(GOOD, overrides=overrides)
    law = scene.contact[0]
    assert (law.mu, law.kr, law.mur) == (0.3, 5.0, 0.1)
    assert scene.run.device == "cpu"
    assert scene.gravity.vector == (0.0, 0.0, 0.0)
    assert scene.title == "x=1"
    assert scene.shape[1].size == (2.0, 2.0, 1.0)


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("contact.0.mu=-1", "  contact[0].mu = -1: must be at least 0"),
        (
            "contact.0.fricton=1",
            (
                ': contact[0] has no key fricton; did you mean "mu"? its keys are groups, law, kn, '
                "kt, en2, damping_ratio, mu, kr, mur, fc, dncut, gamma, file, normal, parameters"
            ),
        ),
        ("contact.3.mu=1", ": contact has the entries 0 to 0, not 3"),
        ("contact.mu=1", ": contact has the entries 0 to 0, not mu"),
        ("fill.0.count=1", ": fill has no entries, not 0"),
        ("run.duration.x=1", ": run.duration is a value, it has no keys"),
        ("run.duration", ": write it as key.path=value, such as contact.0.mu=0.3"),
        (
            "gravity.vectr=1",
            ': gravity has no key vectr; did you mean "vector"? its keys are vector',
        ),
    ],
)
def test_a_bad_set_names_itself_and_the_legal_keys(override, expected):
    assert problems(GOOD, [override]) == [f"--set {override}{expected}"]


def test_no_input_ends_in_a_traceback():
    """Text cut, doubled, overwritten at random: a scene or its problems, nothing else."""
    dice = random.Random(1)  # noqa: S311 - not a secret
    pieces = [
        "[",
        "]",
        "[[",
        '"',
        "\n",
        "=",
        "{",
        "}",
        '"""',
        "'''",
        ".",
        "#",
        "a.b",
        "\0",
        "é",
        "1e999",
    ]
    count = 0
    for _ in range(300):
        text = GOOD
        for _ in range(dice.randint(1, 6)):
            place = dice.randrange(len(text))
            cut = dice.choice([0, 0, 1, 20])
            text = text[:place] + dice.choice([*pieces, ""]) + text[place + cut :]
        try:
            decode.loads(text, overrides=[dice.choice(["body.0.scale=2", "shape.0=1", "run=2"])])
        except SceneError as error:
            count += len(error.problems)
    assert count > 0


def test_a_value_of_any_type_anywhere_is_a_problem_or_fine():
    values = [
        "1",
        "1.5",
        "true",
        '""',
        "[]",
        "{}",
        "[[]]",
        "[{}]",
        "2024-01-01",
        "nan",
        '{kind = ""}',
    ]
    keys = ["title", "run", "gravity", "shape", "group", "body", "fill", "contact", "output"]
    inner = [
        "shape.0.name",
        "body.0.shape",
        "body.0.group",
        "contact.0.groups",
        "contact.0.groups.1",
    ]
    inner += ["shape.1.size", "shape.0.kind", "body.0.fixed", "body.1.density", "run.compat"]
    count = 0
    for key in keys + inner:
        for value in values:
            try:
                decode.loads(GOOD, overrides=[f"{key}={value}"])
            except SceneError as error:
                count += len(error.problems)
    assert count > 0


def test_lines_are_found_in_every_way_of_writing():
    lines = lines_of(
        "# [no]\n"
        'a."b c".d = 1 # x = 1\n'
        "[t]\n"
        't = """\n[x]\n""" \n'
        "list = [ # c\n 1,\n [2,\n  3], {p = 1, q = {r = 2}}]\n"
        "[[u.v]]\n"
        "k = 1\n"
        "[[u.v]]\n"
        "[u.v.w]\n"
        "k = '#'\n"
    )
    assert lines["a", "b c", "d"] == 2
    assert lines["t", "t"] == 4
    assert lines["t", "list", 0] == 8
    assert lines["t", "list", 1, 1] == 10
    assert lines["t", "list", 2, "q", "r"] == 10
    assert lines["u", "v", 0, "k"] == 12
    assert lines["u", "v", 1] == 13
    assert lines["u", "v", 1, "w", "k"] == 15
    assert line_of(lines, ("u", "v", 0, "missing")) == 11
    assert line_of(lines, ("nothing",)) is None


def test_a_later_problem_finds_its_line(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(GOOD)
    scene = decode.load(path)
    problem = decode.problem_at(scene, ("shape", 1, "size"), "too small", 3)
    assert str(problem) == f"{path}:11  shape[1].size = 3: too small"
    path.unlink()
    assert decode.problem_at(scene, ("run",), "x").place == str(path)
    assert decode.problem_at(decode.loads(GOOD), ("run",), "x").place == "scene"


def test_the_schema_documents_every_key():
    schema = json.loads(decode.schema_text())
    tables = schema, *schema["$defs"].values()
    keys = [value for table in tables for value in table.get("properties", {}).values()]
    assert len(keys) > 80
    assert all("description" in key or key.get("const") for key in keys)
