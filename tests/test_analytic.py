"""Analytic surfaces: their formulas, how they are drawn, what fills and checks make of them."""

import numpy as np
import pytest
import warp as wp
from gates import gate
from warpdem.kernels.codes import BALL, CYLINDER, PLANE
from warpdem.kernels.narrow import vertex_surface
from warpdem.kernels.precision import mat33, real, vec3, wide3
from warpdem.kernels.surfaces import height_over

from warpdem.checks.check import build_shapes, check
from warpdem.errors import SceneError
from warpdem.features import features_of
from warpdem.filling.placement import place
from warpdem.geometry.analytic import Analytic
from warpdem.geometry.orientation import matrix
from warpdem.geometry.shapes import polyhedron_of
from warpdem.input.decode import loads
from warpdem.input.scene_shapes import CapsuleShape
from warpdem.output.surfaces import Surfaces

TURN = matrix(np.array([0.5, 0.5, 0.5, 0.5]))  # z, x, y become x, y, z
KINDS = {"plane": PLANE, "cylinder": CYLINDER, "ball": BALL}


def height(kind, radius, point):
    found, normal = height_over(
        wp.int32(int(KINDS[kind])), real(radius), mat33(*TURN.ravel()), wide3(*point)
    )
    return float(found), np.array(normal)


@pytest.mark.parametrize(
    ("kind", "radius", "distance", "normal"),
    [
        ("plane", 0.0, 2.0, [1.0, 0.0, 0.0]),
        ("cylinder", 6.0, 1.0, [0.0, -0.6, -0.8]),
        ("ball", 6.0, 6.0 - np.sqrt(29.0), -np.array([2.0, 3.0, 4.0]) / np.sqrt(29.0)),
    ],
)
def test_heights_are_over_the_free_side_and_normals_point_there(kind, radius, distance, normal):
    found, direction = height(kind, radius, [2.0, 3.0, 4.0])
    assert found == pytest.approx(distance, rel=gate(1e-14, mixed=2e-7))
    near = {"rel": gate(1e-14, mixed=2e-7), "abs": 1e-15}
    assert direction == pytest.approx(np.array(normal), **near)
    on_host = Analytic(kind, radius, None).height(np.array([[2.0, 3.0, 4.0]]) @ TURN)
    assert on_host == pytest.approx([distance], rel=1e-14)


def test_the_middle_of_a_container_has_no_direction():
    found, normal = height("ball", 2.0, [0.0, 0.0, 0.0])
    assert found == 2.0
    assert not normal.any()


def test_a_contact_lies_in_the_middle_of_the_overlap_however_deep():
    hit = vertex_surface(real(-0.5), vec3(0.0, 0.0, 1.0), vec3(1.0, 2.0, -0.5), real(0.1))
    assert hit.outside == 0.0
    assert hit.gap == pytest.approx(-0.6)
    # between the lowest point of the body, z = -0.6, and the plane
    assert np.array(hit.point) == pytest.approx([1.0, 2.0, -0.3])


def test_a_capsule_has_the_mass_and_inertia_of_the_books():
    r, length = 0.3, 0.8
    shape = CapsuleShape(kind="capsule", name="pill", radius=r, length=length)
    pill = polyhedron_of(shape, None)
    tube, ends = np.pi * r**2 * length, 4.0 / 3.0 * np.pi * r**3
    assert pill.volume == pytest.approx(tube + ends, rel=1e-14)
    along = tube * r**2 / 2.0 + ends * 0.4 * r**2
    across = tube * (r**2 / 4.0 + length**2 / 12.0)
    across += ends * (0.4 * r**2 + length**2 / 4.0 + 0.375 * length * r)
    expected = np.array([across, across, along]) / (tube + ends)
    assert np.sort(pill.inertia_over_mass) == pytest.approx(np.sort(expected), rel=1e-13)
    assert len(pill.vertices) == 2
    assert len(pill.edges) == 1


CONTAINER = """
run = {duration = 1.0}
shape = [
    {name = "ball", kind = "sphere", radius = 0.05},
    {name = "floor", kind = "plane"},
    {name = "tube", kind = "cylinder", radius = 0.5},
    {name = "dome", kind = "ball", radius = 1.0},
]
body = [
    {shape = "floor", position = [0.0, 0.0, 0.1], fixed = true},
    {shape = "tube", position = [0.2, 0.0, 0.0], fixed = true},
    {shape = "dome", position = [0.0, 0.0, 0.0], fixed = true},
]
contact = [{groups = ["default", "default"], kn = 1e4, kt = 1e4, en2 = 0.5, mu = 0.5}]
[[fill]]
name = "sand"
kind = "random"
shapes = ["ball"]
count = 400
density = 1.0
region = {min = [-2.0, -2.0, -2.0], max = [2.0, 2.0, 2.0]}
"""


def placed(text):
    scene = loads(text)
    shapes = build_shapes(scene)
    return scene, shapes, place(scene, shapes)


def test_fills_keep_off_surfaces_and_out_of_what_lies_beyond():
    _, _, placement = placed(CONTAINER)
    centres = placement.position[~placement.fixed]

    assert len(centres) > 50
    assert centres[:, 2].min() >= 0.15
    assert np.hypot(centres[:, 0] - 0.2, centres[:, 1]).max() <= 0.45
    assert np.linalg.norm(centres, axis=1).max() <= 0.95


def test_surfaces_are_drawn_where_the_bodies_are_or_as_large_as_asked():
    scene, shapes, placement = placed(CONTAINER)
    drawn = Surfaces(shapes, placement)
    corners = dict(zip(shapes, drawn._corners, strict=True))

    assert np.ptp(corners["floor"][:, 0]) > 1.0
    assert not corners["floor"][:, 2].any()
    assert np.hypot(*corners["tube"][:, :2].T) == pytest.approx(0.5)
    assert np.linalg.norm(corners["dome"], axis=1) == pytest.approx(1.0)
    patch = Analytic("plane", 0.0, 3.0).drawn(10.0)
    assert np.ptp(patch.points, axis=0).tolist() == [3.0, 3.0, 0.0]
    tube = Analytic("cylinder", 0.5, 4.0).drawn(10.0)
    assert np.ptp(tube.points[:, 2]) == 4.0
    assert check(scene).problems == ()


@pytest.mark.parametrize("kind", ["cylinder", "ball"])
def test_drawn_containers_show_their_inside(kind):
    surface = Analytic(kind, 2.0, None).drawn(1.0)
    corners = surface.points[surface.connectivity.reshape(-1, 4)]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])

    assert (np.einsum("ij,ij->i", normal, corners.mean(axis=1)) < 0.0).all()


def test_check_names_what_lies_beyond_a_surface():
    scene = loads(
        CONTAINER.replace(
            "body = [",
            'body = [{shape = "ball", name = "lost", position = [0, 0, 0], density = 1},',
        )
    )
    assert any('"lost" and "body[1]" overlap by 0.15 m' in line for line in check(scene).warnings)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("radius = 0.5}", "radius = 0.5, inside = false}"), 'kind = "capsule"'),
        (("radius = 1.0}", "radius = 1.0, inside = false}"), 'kind = "sphere"'),
        (("0.1], fixed = true", "0.1], density = 1.0"), "a plane has no mass"),
        (('shapes = ["ball"]', 'shapes = ["tube"]'), "a cylinder cannot be strewn"),
    ],
)
def test_what_surfaces_cannot_be_is_said_with_the_way_out(change, message):
    with pytest.raises(SceneError, match=message):
        loads(CONTAINER.replace(*change))


def test_scene_of_balls_and_surfaces_needs_no_polyhedra():

    scene, shapes, placement = placed(CONTAINER)
    has = features_of(scene, placement, shapes)
    assert has.surfaces
    assert not has.polyhedra
    assert not has.large
