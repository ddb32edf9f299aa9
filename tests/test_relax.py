"""Bodies that overlap at the start are pushed apart; energy that grows is told."""

import numpy as np
import pytest
from colliding import FLOOR, same, scene, unit

from warpdem.energy_guard import EVERY
from warpdem.errors import SceneError, UnstableError
from warpdem.guards import measured_depths
from warpdem.input import decode
from warpdem.simulation import Simulation

CLOUDS = {"balls": (("ball",), 30), "blocks": (("cube", "brick", "tetra"), 10)}
SPEED = np.array([1.0, 2.0, 3.0])


def start(bodies, **keys):
    return Simulation(scene(bodies, **keys), device="cpu", threads=1)


def cloud(name, seed=3, box=0.9):
    """Bodies at random places in a box that is too small, over a floor."""
    kinds, count = CLOUDS[name]
    random = np.random.default_rng(seed)
    bodies = [
        {
            "shape": kinds[k % len(kinds)],
            "name": f"b{k}",
            "position": random.uniform(-box, box, 3) + np.array([0.0, 0.0, box + 0.8]),
            "orientation": unit(random.normal(size=4)),
            "velocity": SPEED,
        }
        for k in range(count)
    ]
    return [*bodies, {**FLOOR, "name": "floor"}]


@pytest.mark.parametrize("name", sorted(CLOUDS))
def test_random_overlaps_relax_without_an_explosion(name):
    with pytest.raises(SceneError, match=r"overlap by .* m at the start.*\[run.relax\]"):
        start(cloud(name), dt="auto")
    simulation = start(cloud(name), dt="auto", relax={"overlap": 3e-3})
    assert measured_depths(simulation._model, simulation._lists)[:, 0].max() <= 3e-3
    assert "pushed apart" in simulation.notes[0]
    now = simulation.snapshot()
    assert now.velocity[:-1] == pytest.approx(np.tile(SPEED, (len(now.velocity) - 1, 1)))
    assert now.energy.elastic < 0.15 * now.energy.kinetic
    given = np.array([body["position"] for body in cloud(name)])
    assert np.linalg.norm(now.position - given, axis=1).max() < 2.5
    simulation.advance(0.2)
    later = simulation.snapshot()
    assert np.linalg.norm(later.velocity, axis=1).max() < 2.0 * np.linalg.norm(SPEED)


def test_relaxing_is_repeatable_and_goes_on_from_a_checkpoint():
    first, second = (start(cloud("balls"), dt="auto", relax={}) for _ in range(2))
    assert same(first, second)
    first.advance(0.05)
    second.restore(first.checkpoint())
    for simulation in (first, second):
        simulation.advance(0.1)
    assert same(first, second)


def test_what_does_not_overlap_is_left_where_it_is():
    bodies = [{"shape": "ball", "position": [0.0, 0.0, 2.0]}, FLOOR]
    relaxed, plain = start(bodies, relax={}), start(bodies)
    assert same(relaxed, plain)
    assert relaxed.notes == []


def test_what_cannot_be_pushed_apart_is_listed():
    floor, ceiling = FLOOR, {**FLOOR, "position": [0.0, 0.0, 2.7]}
    ball = {"shape": "ball", "name": "stuck", "position": [0.0, 0.0, 0.4]}
    with pytest.raises(SceneError, match=r'"stuck".*still after 50 steps of \[run.relax\]'):
        start([ball, floor, ceiling], relax={"steps": 50})


COARSE = {
    "law": {"kn": 1e9, "kt": 7e8, "en2": 1.0, "mu": 1e-30, "mur": 1e-30},
    "dt": 3e-5,
    "gravity": (0.0, 0.0, 0.0),
}
"""A law so stiff that this step is close to its limit: fast impacts gain energy."""
FAST = [
    {
        "shape": "cube",
        "name": "bullet",
        "position": [0.0, 0.0, 1.0],
        "velocity": [0.0, 0.0, -100.0],
        "orientation": unit(np.array([0.9, 0.3, 0.2, 0.1])),
    },
    {**FLOOR, "name": "floor"},
]


def test_growing_energy_stops_a_run_and_names_who_gained_it():
    simulation = start(FAST, energy_guard={"growth": 0.02}, **COARSE)
    with pytest.raises(UnstableError, match="energy has grown by") as caught:
        simulation.advance(0.5)
    assert caught.value.body == "bullet"
    assert caught.value.exit_code == 3
    assert simulation.step_count % EVERY == 0
    noted = start(FAST, energy_guard={"growth": 0.02, "action": "note"}, **COARSE)
    noted.advance(0.5)
    assert sum("energy has grown" in note for note in noted.notes) == 1


def test_an_energy_guard_changes_nothing_and_lets_good_runs_pass():
    bodies = [{"shape": "cube", "position": [0.0, 0.0, 2.0], "spin": [1.0, 2.0, 0.0]}, FLOOR]
    watched, plain = start(bodies, energy_guard={}), start(bodies)
    for simulation in (watched, plain):
        simulation.advance(1.0)
    assert watched.notes == []
    assert np.allclose(watched.snapshot().position, plain.snapshot().position, atol=0.0, rtol=0.0)


def test_an_energy_guard_remembers_over_a_checkpoint():
    first, second = (start(FAST, energy_guard={"growth": 0.02}, **COARSE) for _ in range(2))
    first.advance(0.003)
    second.restore(first.checkpoint())
    told = []
    for simulation in (first, second):
        with pytest.raises(UnstableError, match="energy has grown") as caught:
            simulation.advance(0.5)
        told.append(str(caught.value))
    assert told[0] == told[1]


TEXT = """
run = {duration = 1.0}
shape = [{kind = "sphere", name = "ball", radius = 0.1}]
body = [{shape = "ball", position = [0, 0, 0], density = 1.0}]
contact = [{groups = ["default", "default"], kn = 1e6, kt = 1e6, en2 = 0.25, mu = 0.5}]
"""


def test_what_watches_energies_needs_their_account():
    with pytest.raises(SceneError, match=r"run\.energy_guard: needs the account of energies"):
        decode.loads(TEXT, overrides=["run.energy_guard.growth=0.1", "output.energy=false"])


@pytest.mark.parametrize(
    ("setting", "rule"),
    [
        ("cell.size=[1.0, 1.0, 1.0]", r"not in a periodic cell"),
        ('run.compat="rockable"', r"not with run\.compat"),
    ],
)
def test_bodies_are_pushed_apart_where_nothing_holds_them(setting, rule):
    with pytest.raises(SceneError, match=rf"run\.relax: {rule}"):
        decode.loads(TEXT, overrides=["run.relax.overlap=0.1", setting])
