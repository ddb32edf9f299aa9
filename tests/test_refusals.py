"""Scenes that cannot mean anything are refused when they are read, with place, value and rule."""

import pytest

from warpdem.checks.check import check
from warpdem.errors import SceneError
from warpdem.input import decode

TEXT = """
run = {duration = 1.0, dt = 1e-4}
gravity = {vector = [0, 0, -9.81]}
shape = [{kind = "box", name = "b", size = [1, 1, 1], rounding = 0.1}]
body = [{shape = "b", position = [0, 0, 0], density = 1.0}]
contact = [{groups = ["default", "default"], kn = 1e6, kt = 1e6, en2 = 0.25, mu = 0.5}]
"""
NUMBERS = (
    "run.duration=",
    "run.dt=",
    "gravity.vector=[0, 0, ]",
    "body.0.position=[0, 0, ]",
    "body.0.velocity=[0, 0, ]",
    "body.0.spin=[0, 0, ]",
    "body.0.orientation=[1, 0, 0, ]",
    "body.0.density=",
    "body.0.scale=",
    "contact.0.kn=",
    "contact.0.kt=",
    "contact.0.mu=",
    "contact.0.en2=",
    "shape.0.rounding=",
    "shape.0.size=[1, 1, ]",
)
IMPOSSIBLE = {
    "body.0.density=0": "must be greater than 0",
    "body.0.density=-1": "must be greater than 0",
    "body.0.scale=0": "must be greater than 0",
    "body.0.orientation=[2, 0, 0, 0]": "its length is 2",
    "body.0.orientation=[0, 0, 0, 0]": "its length is 0",
    "contact.0.kn=0": "must be greater than 0",
    "contact.0.kt=-1": "must be at least 0",
    "contact.0.mu=-0.1": "must be at least 0",
    "contact.0.en2=0": r"must lie in \(0, 1\]",
    "contact.0.kr=-1": "must be at least 0",
    "run.dt=0": "must be greater than 0",
    "shape.0.rounding=0": "must be greater than 0",
    "shape.0.size=[1, 0, 1]": "must be greater than 0",
    "body.0.velocity=[1e200, 0, 0]": "too large to compute with",
}
TETRA = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
SIDES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def solid(vertices, faces):
    lines = TEXT.strip().splitlines()
    lines[2] = (
        f'shape = [{{kind = "polyhedron", name = "b", vertices = {vertices}, faces = {faces}, '
        "rounding = 0.05}]"
    )
    return check(decode.loads("\n".join(lines)))


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
@pytest.mark.parametrize("key", NUMBERS)
def test_no_number_of_a_scene_is_nan_or_infinite(key, value):
    setting = key.replace("]", f"{value}]") if "]" in key else key + value
    with pytest.raises(SceneError, match=r"must (be|lie)") as caught:
        decode.loads(TEXT, overrides=[setting])
    assert value in str(caught.value)


@pytest.mark.parametrize("setting", IMPOSSIBLE)
def test_what_no_body_or_law_can_be_is_refused(setting):
    with pytest.raises(SceneError, match=IMPOSSIBLE[setting]):
        decode.loads(TEXT, overrides=[setting])


@pytest.mark.parametrize(
    ("vertices", "faces", "rule"),
    [
        ([*TETRA[:3], [1, 1, 0]], SIDES, "encloses no volume"),
        ([[0, 0, 0]] * 4, SIDES, "no facet has an area"),
        ([*TETRA, [1, 1, 1]], [*SIDES, [0, 1, 4]], "more than two facets share the edge"),
    ],
)
def test_what_is_no_solid_is_refused_with_the_cause(vertices, faces, rule):
    with pytest.raises(SceneError, match=rf'shape\[0\]: shape "b": .*{rule}'):
        solid(vertices, faces)


@pytest.mark.parametrize(
    ("vertices", "faces", "note"),
    [
        ([*TETRA, [0, 0, 0]], [[4, 2, 1], *SIDES[1:]], "welded 1 duplicate vertex"),
        (TETRA, [[0, 1, 2], *SIDES[1:]], "turned 1 facet outward"),
        (TETRA, [face[::-1] for face in SIDES], "turned 4 facets outward"),
    ],
)
def test_what_can_be_mended_is_mended_and_told(vertices, faces, note):
    report = solid(vertices, faces)
    assert f'shape "b": {note}' in report.notes
    assert report.shapes[0].volume == pytest.approx(solid(TETRA, SIDES).shapes[0].volume)


def test_an_open_surface_is_a_plate_of_its_rounding():
    assert solid(TETRA, SIDES[:1]).shapes[0].volume == pytest.approx(
        0.5 * 0.1 + 0.5 * 3.1416 * 0.05**2 * (2.0 + 2.0**0.5) + 4.0 / 3.0 * 3.1416 * 0.05**3,
        rel=1e-4,
    )
