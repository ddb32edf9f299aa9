"""The [cell] of a scene: what is refused, how fills and checks see it, what a run writes."""

import csv

import numpy as np
import pytest
from pydantic import ValidationError

from warpdem.checks.check import build_shapes, check
from warpdem.checks.overlap import overlaps_at_start
from warpdem.errors import SceneError, UnstableError
from warpdem.filling.placement import place
from warpdem.input.scene import Scene
from warpdem.running.runner import run
from warpdem.simulation import Simulation

BALL = {"kind": "sphere", "name": "ball", "radius": 0.1}
LAW = {"groups": ["default", "default"], "kn": 1e5, "kt": 0.0, "en2": 0.9, "mu": 0.0}
FLOOR = {"kind": "box", "name": "floor", "size": [1.0, 1.0, 0.2], "rounding": 0.01}
FREE = {"shape": "ball", "position": [0.5, 0.5, 0.5], "density": 1000.0}
STANDING = {"shape": "floor", "position": [0.5, 0.5, -0.1], "fixed": True}


def scene(cell, *, gravity=(0.0, 0.0, 0.0), body=(FREE,), floor=(1.0, 1.0, 0.2), **more):
    return Scene.model_validate(
        {
            "run": {"duration": 0.02, "dt": 1e-4},
            "gravity": {"vector": list(gravity)},
            "cell": {"size": [1.0, 1.0, 1.0], **cell},
            "shape": [BALL, {**FLOOR, "size": list(floor)}],
            "body": list(body),
            "contact": [LAW],
            **more,
        }
    )


def fill(count, *, kind="random", low=0.0, high=1.0):
    return {
        "name": "many",
        "shapes": ["ball"],
        "density": 1000.0,
        "kind": kind,
        "count": count,
        "region": {"min": [low] * 3, "max": [high] * 3},
    }


DRAG = {"kind": "drag"}
BOND = {"between": "inner", "rule": "vertices", "tolerance": 1e-4, "kn": 1e5, "kt": 1e5}
SHEAR = {"strain_rate": [[0, 1.0, 0], [0, 0, 0], [0, 0, 0]]}


@pytest.mark.parametrize(
    ("cell", "more", "rule"),
    [
        ({"periodic": [False, False, False]}, {}, "periodic along no axis"),
        ({**SHEAR, "periodic": [True, False, True]}, {}, "component xy deforms the cell along"),
        ({**SHEAR, "stress": {"xy": 1.0}}, {}, "component xy has a rate and a stress"),
        ({**SHEAR, "damping": 1.0}, {}, "only with stress"),
        ({"start": 1.0}, {}, "has no use for it"),
        ({**SHEAR, "start": 2.0, "stop": 1.0}, {}, "must come after start = 2"),
        (SHEAR, {"body": (FREE, STANDING)}, "nothing fixed can stand in a cell that deforms"),
        ({}, {"gravity": (0, 0, -9.81)}, "they would fall for ever"),
        ({}, {"fill": [fill(3, low=-0.5)]}, "reaches out of the periodic cell"),
        (SHEAR, {"force": [DRAG]}, "differ between images of a body"),
        (SHEAR, {"bond": [BOND]}, "bonds do not enter the stress"),
        (
            {},
            {"force": [{"kind": "fluid", "file": "u.npz"}]},
            "not repeated with the periodic cell",
        ),
    ],
)
def test_cells_that_make_no_sense_are_refused(cell, more, rule):
    with pytest.raises(ValidationError, match=rule):
        scene(cell, **more)


def test_body_alone_in_a_cell_needs_a_law_for_its_own_images():
    with pytest.raises(ValidationError, match="groups that can meet lack"):
        scene({}, contact=[])


def test_floor_that_ends_at_the_boundary_is_refused_and_a_longer_one_is_infinite():
    open_above = {"periodic": [True, True, False]}
    down = {"gravity": (0.0, 0.0, -9.81)}
    tight = scene(open_above, body=(FREE, STANDING), **down)
    with pytest.raises(SceneError, match="must reach beyond it by a body's radius"):
        Simulation(tight, device="cpu")
    assert "feel its rim" in str(check(tight))
    # resting on the boundary: the wall and its images would press twice
    sunk = 1000.0 * 4 / 3 * np.pi * 0.1**3 * 9.81 / 1e5
    rests = {**FREE, "position": [0.0, 1.0, 0.1 - sunk]}
    wide = scene(open_above, body=(rests, STANDING), floor=(3.0, 3.0, 0.2), **down)
    shot = Simulation(wide, device="cpu").snapshot(contacts=True)
    assert len(shot.contacts.gap) == 1
    assert np.abs(shot.force[0]).max() < 1e-6
    # the wall presses at the contact point, in the middle of the overlap
    stress = sunk * 1e5 * (0.1 - 0.5 * sunk)
    assert shot.cell.contact_stress[2, 2] == pytest.approx(stress, rel=1e-6)
    assert np.abs(shot.cell.contact_stress[:2]).max() < 1e-9


def test_cell_far_narrower_than_its_bodies_is_refused_by_name():
    with pytest.raises(UnstableError, match=r"0\.04 m wide along x, less than a quarter"):
        Simulation(scene({"size": [0.04, 1.0, 1.0]}), device="cpu")


@pytest.mark.parametrize("kind", ["random", "lattice"])
def test_fills_keep_clear_of_the_images_of_bodies(kind):
    far = {**FREE, "position": [3.02, 0.03, -1.0]}
    built = scene({}, body=(far,), fill=[fill(60 if kind == "random" else 150, kind=kind)])
    placement = place(built, build_shapes(built))
    x = placement.position
    assert len(x) > 50
    apart = x[:, None] - x[None]
    apart -= np.round(apart)
    distance = np.linalg.norm(apart, axis=2) + 10.0 * np.eye(len(x))
    assert distance.min() > 0.2 - 1e-12
    # bodies do lie across the boundary
    if kind == "random":
        assert (np.abs(x[1:] - 0.5).max(axis=1) > 0.45).any()
    else:
        assert len(x) > 110  # of 125 sites, some are taken by the body from afar


def test_check_names_bodies_that_overlap_across_the_boundary():
    pair = [{**FREE, "position": [0.03, 0.5, 0.5]}, {**FREE, "position": [2.9, 0.5, 0.5]}]
    built = scene({}, body=pair)
    found = overlaps_at_start(place(built, build_shapes(built)), build_shapes(built), built.cell)
    assert found.warnings == ('"body[0]" and "body[1]" overlap by 0.07 m at the start',)
    open_space = overlaps_at_start(place(built, build_shapes(built)), build_shapes(built))
    assert open_space.warnings == ()


def test_cell_so_light_that_the_step_misses_its_swing_is_doubted():
    light = {"stress": {"xx": 1e3}, "inertia": 1e-3}
    assert any("the cell swings" in warning for warning in check(scene(light)).warnings)
    heavy = check(scene({"stress": {"xx": 1e3}})).warnings
    assert not any("the cell swings" in warning for warning in heavy)


def test_run_writes_the_cell_and_shows_bodies_inside_it(tmp_path):
    import pyvista  # noqa: PLC0415 - slow to load

    body = {**FREE, "position": [2.95, 0.5, 0.95], "velocity": [1.0, 0.0, 0.0]}
    partner = {**FREE, "position": [0.13, 0.5, 0.95]}
    output = {"every": 0.01, "contacts": True, "table": True}
    built = scene(SHEAR, body=(body, partner), output=output)
    assert run(built, tmp_path / "out", quiet=True, device="cpu") == 0
    with (tmp_path / "out" / "cell.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3
    assert float(rows[-1]["edge_xy"]) == pytest.approx(0.02, rel=1e-9)
    assert float(rows[-1]["deformation_xy"]) == pytest.approx(0.02, rel=1e-9)
    assert float(rows[-1]["rate_xy"]) == 1.0
    assert float(rows[0]["stress_xx"]) > 0.0
    surface = pyvista.PVDReader(tmp_path / "out" / "bodies.pvd").read()[0]
    assert surface.bounds[1] < 1.2
    reader = pyvista.PVDReader(tmp_path / "out" / "cell.pvd")
    reader.set_active_time_point(2)
    box = reader.read()[0]
    assert np.allclose(box.bounds, [-0.01, 1.01, 0.0, 1.0, 0.0, 1.0], atol=1e-6)
    points = pyvista.PVDReader(tmp_path / "out" / "contacts.pvd").read()[0]
    assert 0.0 <= points.points[0, 0] <= 1.0


def test_stress_of_a_chain_that_hangs_by_its_bonds_is_its_weight_in_tension():
    """A ball under a fixed one: sigma_zz V = -f h, f the weight of the lower one."""
    upper = {**FREE, "fixed": True}
    lower = {"shape": "ball", "position": [0.5, 0.5, 0.3], "density": 1000.0}
    hung = scene(
        {"periodic": [True, True, False]},
        gravity=(0.0, 0.0, -9.81),
        body=(upper, lower),
        bond=[{**BOND, "walls": True, "damping_ratio": 0.7, "rule": "clusters"}],
        run={"duration": 1.0, "dt": 1e-4},
    )
    simulation = Simulation(hung, device="cpu", threads=1)
    simulation.advance(0.5)
    cell = simulation.snapshot().cell
    weight = 1000.0 * 4.0 / 3.0 * np.pi * 0.1**3 * 9.81
    assert cell.contact_stress[2, 2] * cell.volume == pytest.approx(-weight * 0.1, rel=2e-2)
