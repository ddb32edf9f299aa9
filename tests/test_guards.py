"""What ends a run that is no longer physical: no numbers, bodies that go through each other."""

import numpy as np
import pytest
from colliding import FLOOR, LAW, heap, run, scene

from warpdem.errors import SceneError, UnstableError
from warpdem.input.scene import Scene
from warpdem.simulation import Simulation

SPEEDS = (1e2, 1e3, 1e4)
CUBE = {"shape": "cube", "name": "cube", "position": [0.0, 0.0, 3.0]}


def start(bodies, **keys):
    return Simulation(scene(bodies, **keys), device="cpu", threads=1)


def bullet(speed, kn, *, shape="ball", wall="wall", dt="auto"):
    """A bullet of radius .01 before a wall .02 thick, or a sheet of as much rounding."""
    shapes = [
        {"kind": "sphere", "name": "ball", "radius": 0.01},
        {"kind": "box", "name": "block", "size": [0.02] * 3, "rounding": 1e-3},
        {"kind": "box", "name": "wall", "size": [0.02, 0.5, 0.5], "rounding": 1e-3},
        {
            "kind": "polyhedron",
            "name": "sheet",
            "vertices": [[0.0, -0.2, -0.2], [0.0, 0.2, -0.2], [0.0, 0.2, 0.2], [0.0, -0.2, 0.2]],
            "faces": [[0, 1, 2, 3]],
            "rounding": 0.01,
        },
    ]
    flying = {"name": "bullet", "shape": shape, "density": 7800.0, "velocity": [speed, 0.0, 0.0]}
    return Scene.model_validate(
        {
            "run": {"duration": 1.0, "dt": dt},
            "gravity": {"vector": [0.0] * 3},
            "shape": shapes,
            "body": [
                {**flying, "position": [-0.1, 0.003, 0.001]},
                {"name": "wall", "shape": wall, "position": [0.0] * 3, "fixed": True},
                # so that all share their kernels
                {"shape": "sheet", "position": [9.0, 0.0, 0.0], "fixed": True},
                {"shape": "block", "position": [9.0, 9.0, 0.0], "fixed": True},
            ],
            "contact": [{**LAW, "kn": kn, "kt": kn, "en2": 0.8}],
            "output": {"energy": False},
        }
    )


def shot(speed, kn, **keys):
    """Where a bullet is after twice the time to the wall, and its velocity."""
    simulation = Simulation(bullet(speed, kn, **keys), device="cpu", threads=1)
    simulation.advance(0.2 / speed)
    now = simulation.snapshot()
    return now.position[0, 0], now.velocity[0, 0]


@pytest.mark.parametrize("wall", ["wall", "sheet"])
@pytest.mark.parametrize("shape", ["ball", "block"])
@pytest.mark.parametrize("speed", SPEEDS)
def test_a_bullet_that_a_wall_can_stop_rebounds(speed, shape, wall):
    kn = 3e3 * speed**2  # sinks in by a tenth of the wall, or of the roundings
    place, velocity = shot(speed, kn, shape=shape, wall=wall)
    assert place < -0.02
    assert velocity == pytest.approx(-np.sqrt(0.8) * speed, rel=0.02)


@pytest.mark.parametrize("wall", ["wall", "sheet"])
@pytest.mark.parametrize("shape", ["ball", "block"])
@pytest.mark.parametrize("speed", SPEEDS)
def test_a_bullet_too_strong_for_a_wall_is_named_before_it_is_through(speed, shape, wall):
    with pytest.raises(UnstableError, match=r'"bullet" and "wall".*through') as caught:
        shot(speed, 3.0 * speed**2, shape=shape, wall=wall)
    assert caught.value.body == "bullet"
    assert caught.value.exit_code == 3
    assert caught.value.time < 0.12 / speed


def test_a_bullet_too_fast_for_a_given_step_is_told_the_step_that_would_do():
    with pytest.raises(UnstableError, match="bullet") as caught:
        shot(1e3, 1e8, dt=1e-5)
    limit = float(str(caught.value).split(" s) to ")[1].split(" s")[0])
    assert limit < 1e-5
    place, velocity = shot(1e3, 1e10, dt=0.2 * limit)
    assert place < -0.02
    assert velocity < 0.0


def test_a_step_chosen_by_the_program_follows_speeds_that_no_start_shows():
    """A ball falls onto a thin sheet so far that the first step is too long at the end."""
    sheet = {
        "kind": "polyhedron",
        "name": "sheet",
        "vertices": [[-2.0, -2.0, 0.0], [2.0, -2.0, 0.0], [2.0, 2.0, 0.0], [-2.0, 2.0, 0.0]],
        "faces": [[0, 1, 2, 3]],
        "rounding": 1e-3,
    }
    pea = {"kind": "sphere", "name": "pea", "radius": 1e-3}
    bodies = [
        {"shape": "pea", "position": [0.0, 0.0, 0.3], "velocity": [0.0, 0.0, -1.0]},
        {"shape": "sheet", "position": [0.0, 0.0, 0.0], "fixed": True},
    ]
    simulation = start(
        bodies,
        shapes=[sheet, pea],
        dt="auto",
        law={"kn": 0.05, "kt": 0.05, "kr": 1e-12},
        gravity=(0.0, 0.0, -500.0),
        overlap="note",
    )
    first = simulation.dt
    simulation.advance(0.0328)
    assert simulation.dt < first
    assert any("bodies are faster" in note for note in simulation.notes)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("position", "position"),
        ("orientation", "orientation of length one"),
        ("momentum", "momentum"),
        ("angular_momentum", "angular momentum"),
        ("force", "force"),
        ("torque", "torque"),
    ],
)
@pytest.mark.parametrize("body", [0, 1])
def test_a_number_that_is_none_is_named_within_one_look(name, words, body):
    simulation = start([CUBE, {**FLOOR, "name": "floor"}])
    simulation.advance(0.01)
    array = getattr(simulation._state.bodies, name)
    values = array.numpy().copy()
    values[body, 1] = np.nan
    array.assign(values)
    before = simulation.step_count
    with pytest.raises(UnstableError, match="NaN") as caught:
        simulation.advance(simulation.time + 10 * simulation.dt)
    assert caught.value.body == ["cube", "floor"][body]
    assert simulation.step_count <= before + 10
    if body == 1:  # that of a free body spreads in a step
        assert f"no finite {words}" in str(caught.value)


def test_an_orientation_that_is_no_rotation_is_named():
    simulation = start([CUBE, FLOOR])
    array = simulation._state.bodies.orientation
    array.assign(np.array([[0.0, 0.0, 0.1, 1.0], [0.0, 0.0, 0.0, 1.0]]))
    with pytest.raises(UnstableError, match='"cube" has no finite orientation'):
        simulation.advance(0.1)


def test_bodies_that_overlap_by_half_at_the_start_are_listed_with_their_depths():
    pile = [{"shape": "ball", "name": f"b{k}", "position": [0.3 * k, 0.0, 9.0]} for k in range(4)]
    with pytest.raises(SceneError) as caught:
        start(pile)
    assert caught.value.exit_code == 2
    told = [str(problem) for problem in caught.value.problems]
    assert len(told) == 3
    assert all("overlap by 0.7 m at the start" in text and "[run.relax]" in text for text in told)
    assert '"b0" and "b1"' in "".join(told)


def test_solids_that_overlap_by_half_of_the_thinner_at_the_start_are_refused():
    places = {"a": [0.0, 0.0, 3.0], "b": [0.3, 0.3, 3.7]}
    cubes = [{**CUBE, "name": name, "position": place} for name, place in places.items()]
    with pytest.raises(SceneError, match=r'"a" and "b" overlap by 0\.3 m'):
        start(cubes)
    apart = [cubes[0], {**cubes[1], "position": [0.3, 0.3, 3.75]}]
    assert "more than their roundings" in start(apart).notes[-1]


def test_overlaps_may_be_noted_alone():
    pile = [{"shape": "ball", "name": f"b{k}", "position": [0.3 * k, 0.0, 9.0]} for k in range(2)]
    simulation = start(pile, overlap="note")
    simulation.advance(0.01)
    soft = [CUBE, {**FLOOR, "name": "floor"}]
    simulation = start(soft, overlap="note", law={"kn": 1.0})
    simulation.advance(2.0)
    assert any('"cube" and "floor" overlap' in note for note in simulation.notes)


def test_contacts_too_soft_for_what_rests_on_them_end_the_run():
    with pytest.raises(UnstableError, match=r'"cube" and "floor" overlap by .* m, .*raise kn'):
        start([CUBE, {**FLOOR, "name": "floor"}], law={"kn": 1.0}).advance(3.0)


def test_what_holds_is_left_alone():
    simulation = run(heap(2, 5), 1.5)
    assert simulation.notes == []
