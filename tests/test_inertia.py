"""Volume, centre and inertia of rounded solids against formulas, and against points at random."""

import json
from pathlib import Path

import numpy as np
import pytest
from solids import (
    CUBE_CORNERS,
    CUBE_FACES,
    CUP_FACES,
    ELL,
    TETRA_CORNERS,
    TETRA_FACES,
    frame,
    prism,
    rotation,
)

from warpdem.filling.clearance import Elements, Obstacle
from warpdem.geometry.inertia import rounded_box
from warpdem.geometry.polyhedron import build

REFERENCE = Path(__file__).resolve().parents[2] / "shared" / "reference" / "analytic"
# core, rounding, volume, inertia about x, y, z over the density
BOXES = [
    ((1, 1, 1), 0, 1.0, (1 / 6, 1 / 6, 1 / 6)),
    (
        (0.2, 0.3, 0.5),
        0.02,
        0.04369014738307421,
        (0.0014692782753669288, 0.0012601848840691004, 0.00062353226134169),
    ),
    (
        (1, 0, 0),
        0.1,
        0.03560471674068433,
        (0.00017383479349863528, 0.003917566039026473, 0.003917566039026473),
    ),
    (
        (1, 1, 0),
        0.05,
        0.11623156204354727,
        (0.011357294196606171, 0.011357294196606171, 0.022527763173685142),
    ),
    (
        (1, 0.01, 0.01),
        0.002,
        0.00019325120834828467,
        (6.126445300522981e-09, 1.6222109484871793e-05, 1.6222109484871793e-05),
    ),
]


def core_of(extent):
    """Vertices, faces and edges of a box, rectangle or segment about the origin."""
    half = 0.5 * np.array(extent, float)
    flat = int(np.sum(half > 0.0))
    if flat == 3:
        return (2.0 * np.array(CUBE_CORNERS) - 1.0) * half, CUBE_FACES, None
    if flat == 2:
        return (2.0 * np.array(CUBE_CORNERS[:4]) - 1.0) * half, [[0, 1, 2, 3]], None
    return np.array([-half, half]), [], [[0, 1]]


def points_inside(solid, count, seed):
    """Volume by points at random, and its standard deviation; the points inside."""
    low, high = solid.core_min - solid.radius, solid.core_max + solid.radius
    points = low + np.random.default_rng(seed).random((count, 3)) * (high - low)
    pose = Obstacle(solid, Elements(solid), np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), 1.0)
    inside = pose.touched(points, np.zeros(count))
    share = inside.mean()
    box = np.prod(high - low)
    return box * share, box * np.sqrt(share * (1.0 - share) / count), points[inside]


@pytest.mark.parametrize(("extent", "radius", "volume", "inertia"), BOXES)
def test_boxes_plates_and_capsules_in_closed_form(extent, radius, volume, inertia):
    mass = rounded_box(np.array(extent, float), radius)

    assert mass.volume == pytest.approx(volume, rel=1e-12)
    assert np.diag(mass.inertia_over_mass) * volume == pytest.approx(inertia, rel=1e-12)


@pytest.mark.parametrize(("extent", "radius", "volume", "inertia"), BOXES)
def test_cores_of_faces_and_edges_agree_with_the_closed_form(extent, radius, volume, inertia):
    vertices, faces, edges = core_of(extent)
    solid = build(vertices, faces, name="box", radius=radius, edges=edges)

    assert solid.volume == pytest.approx(volume, rel=1e-12)
    assert solid.inertia_over_mass * solid.volume == pytest.approx(inertia, rel=1e-12)
    assert solid.volume_error == 0.0


def test_a_rounded_tetrahedron_has_steiners_volume():
    solid = build(TETRA_CORNERS, TETRA_FACES, name="tetra", radius=0.1)

    assert solid.volume == pytest.approx(0.3525639982469026, rel=1e-12)


@pytest.mark.parametrize("family", ["sphero_box_mass", "sphero_tetra_mass"])
def test_every_reference_case(family):
    file = REFERENCE / f"{family}.json"
    if not file.exists():
        pytest.skip(f"{file} is not here")
    for case in json.loads(file.read_text())["cases"]:
        given, expected = case["params"], case["expected"]
        if "edge" in given:
            corners = given["edge"] * TETRA_CORNERS
            solid = build(corners, TETRA_FACES, name="tetra", radius=given["r"])
            assert solid.volume == pytest.approx(expected["volume"], rel=1e-12)
            continue
        mass = rounded_box(np.array(given["core"], float), given["r"])
        moments = [expected[f"I{axis}{axis}_over_rho"] for axis in "xyz"]
        assert mass.volume == pytest.approx(expected["volume"], rel=1e-12)
        assert np.diag(mass.inertia_over_mass) * mass.volume == pytest.approx(moments, rel=1e-12)


def test_mass_does_not_depend_on_the_pose():
    straight = build(TETRA_CORNERS * [1.0, 2.0, 3.0], TETRA_FACES, name="t", radius=0.2)
    corners = TETRA_CORNERS * [1.0, 2.0, 3.0] @ rotation(2).T + [100.0, -50.0, 20.0]
    turned = build(corners, TETRA_FACES, name="t", radius=0.2)

    assert turned.volume == pytest.approx(straight.volume, rel=1e-12)
    assert sorted(turned.inertia_over_mass) == pytest.approx(
        sorted(straight.inertia_over_mass), rel=1e-12
    )


def test_a_convex_solid_agrees_with_points_at_random():
    corners = np.concatenate([TETRA_CORNERS[:3] * [1.0, 1.5, 0.5], [[0.2, 0.1, 0.9]]])
    solid = build(corners, TETRA_FACES, name="tetra", radius=0.3)
    volume, deviation, inside = points_inside(solid, 200_000, 1)

    assert volume == pytest.approx(solid.volume, abs=4.0 * deviation)
    assert inside.mean(axis=0) == pytest.approx([0.0] * 3, abs=0.01)
    square = (inside**2).mean(axis=0)
    assert square.sum() - square == pytest.approx(solid.inertia_over_mass, rel=0.02)
    assert abs((inside[:, 0] * inside[:, 1]).mean()) < 0.005


def test_a_sharp_solid_that_is_not_convex_is_exact():
    solid = build(*prism(ELL, 1.0), name="ell", radius=0.0)

    assert solid.volume == pytest.approx(3.0, rel=1e-14)
    assert solid.frame_origin == pytest.approx([5 / 6, 5 / 6, 0.5])
    assert solid.inertia_over_mass.max() == pytest.approx(11 / 18, rel=1e-13)
    assert solid.volume_error == 0.0


@pytest.mark.parametrize("radius", [0.01, 0.15, 0.3])
def test_a_rounded_ell_counts_its_inner_corner_once(radius):
    solid = build(*prism(ELL, 1.0), name="ell", radius=radius)
    # sections of the plan widened by s: five corners turn outward, one inward
    corner = 5 * np.pi / 4 - 1
    section = 3 + 8 * radius + corner * radius**2
    ends = 2 * (3 * radius + 2 * np.pi * radius**2 + corner * 2 / 3 * radius**3)

    assert solid.volume == pytest.approx(section + ends, rel=2e-7)
    assert 0.0 < solid.volume_error < 1e-5


@pytest.mark.parametrize("distance", [0.3, 1.0, 1.9, 2.5])
def test_two_balls_share_their_lens_once(distance):
    solid = build([[0, 0, 0], [distance, 0, 0]], [], name="balls", radius=1.0)
    height = max(1.0 - distance / 2.0, 0.0)
    volume = 2.0 * np.pi * (4.0 / 3.0 - height**2 * (3.0 - height) / 3.0)

    assert solid.volume == pytest.approx(volume, rel=solid.volume_error + 1e-12)
    assert solid.volume_error < 1e-5


def test_two_boxes_far_apart_are_two_boxes():
    vertices = np.concatenate([CUBE_CORNERS, np.add(CUBE_CORNERS, [4.0, 0.0, 0.0])])
    faces = [*CUBE_FACES, *([corner + 8 for corner in face] for face in CUBE_FACES)]
    solid = build(vertices, faces, name="pair", radius=0.2)
    one = rounded_box(np.ones(3), 0.2)
    own = one.inertia_over_mass[0, 0]

    assert solid.volume == pytest.approx(2.0 * one.volume, rel=1e-12)
    assert solid.inertia_over_mass == pytest.approx([own, own + 4.0, own + 4.0], rel=1e-12)


def test_a_cavity_is_filled_by_its_rounding():
    outer, inner = 2.0 * np.array(CUBE_CORNERS) - 1.0, np.array(CUBE_CORNERS) - 0.5
    faces = [*CUBE_FACES, *([corner + 8 for corner in face] for face in CUBE_FACES)]
    for radius in (0.1, 0.6):
        solid = build(np.concatenate([outer, inner]), faces, name="hollow", radius=radius)
        void = max(0.0, 1.0 - 2.0 * radius) ** 3
        volume = rounded_box(np.full(3, 2.0), radius).volume - void
        assert solid.volume == pytest.approx(volume, rel=2e-7)


@pytest.mark.parametrize("name", ["cup", "frame", "bent plate", "wires"])
def test_solids_that_are_not_convex_agree_with_points_at_random(name):
    radius = 0.15
    if name == "wires":
        edges = [[0, 1], [1, 2], [2, 6], [0, 4]]
        solid = build(CUBE_CORNERS, [], name=name, radius=radius, edges=edges)
    else:
        corners, faces = {
            "cup": (CUBE_CORNERS, CUP_FACES),
            "frame": frame(),
            "bent plate": (CUBE_CORNERS, CUP_FACES[:2]),
        }[name]
        solid = build(corners, faces, name=name, radius=radius)
    volume, deviation, inside = points_inside(solid, 100_000, 7)

    assert solid.volume_error < 1e-5
    assert volume == pytest.approx(solid.volume, abs=4.0 * deviation)
    assert inside.mean(axis=0) == pytest.approx([0.0] * 3, abs=0.02)
    square = (inside**2).mean(axis=0)
    assert square.sum() - square == pytest.approx(solid.inertia_over_mass, rel=0.03)


def test_the_error_estimate_covers_a_tighter_quadrature(monkeypatch, tmp_path):
    monkeypatch.setenv("WARPDEM_CACHE_PATH", str(tmp_path / "rough"))
    rng = np.random.default_rng(4)
    corners, faces = prism([[r * np.cos(t), r * np.sin(t)] for t, r in star(rng)], 0.8)
    rough = build(corners, faces, name="star", radius=0.1)
    monkeypatch.setenv("WARPDEM_CACHE_PATH", str(tmp_path / "fine"))
    monkeypatch.setattr("warpdem.geometry.quadrature._SHARES", 20_000)
    fine = build(corners, faces, name="star", radius=0.1)

    assert rough.volume == pytest.approx(fine.volume, rel=rough.volume_error)
    assert fine.volume_error < rough.volume_error


def star(rng):
    """Angles and radii of a star with five tips."""
    return [(np.pi * k / 5.0, (0.5 if k % 2 else 1.0) + 0.1 * rng.random()) for k in range(10)]
