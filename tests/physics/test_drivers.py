"""Driven bodies against closed forms: motion, forces of walls, work, repeatability."""

import numpy as np
import pytest

from warpdem.input.scene import Scene
from warpdem.running.runner import run
from warpdem.simulation import Simulation

PLATE = {"name": "plate", "kind": "box", "size": [2.0, 2.0, 0.2], "rounding": 0.02}
SIDE = {"name": "side", "kind": "box", "size": [0.2, 2.0, 2.0], "rounding": 0.02}
CUBE = {"name": "cube", "kind": "box", "size": [0.2, 0.2, 0.2], "rounding": 0.02}
BALL = {"name": "ball", "kind": "sphere", "radius": 0.1}
GROUND = {"shape": "plate", "name": "plate", "group": "wall", "fixed": True, "density": 1000.0}
LAW = {"kn": 1e5, "kt": 8e4, "en2": 0.3, "mu": 0.5}
FLOOR = {**GROUND, "position": [0.0, 0.0, -0.1]}
DENSITY = 1000.0
W = 2.0 * np.pi * 5.0
SHAKE = {
    "kind": "sine",
    "bodies": ["plate"],
    "frequency": 5.0,
    "translation": [0.01, 0.0, 0.005],
    "rotation": [0.0, 0.02, 0.0],
    "point": [1.0, 0.0, 0.0],
}


def free(shape, position, **keys):
    return {"shape": shape, "group": "free", "position": position, "density": DENSITY, **keys}


def start(drivers, bodies, *, threads=1, law=LAW, gravity=-9.81, **run):
    some = any(body["group"] == "free" for body in bodies)
    scene = {
        "run": {"duration": 10.0, "dt": 1e-4, "device": "cpu", **run},
        "gravity": {"vector": [0.0, 0.0, gravity]},
        "shape": [PLATE, SIDE, CUBE, BALL],
        "body": bodies,
        "contact": [{"groups": ["free", group], **law} for group in ("free", "wall")] * some,
        "driver": drivers,
    }
    return Simulation(Scene.model_validate(scene), device="cpu", threads=threads)


@pytest.mark.parametrize("contacts", [False, True])
def test_shaken_plate_is_where_its_driver_says_at_every_instant(contacts):
    bodies = [FLOOR, free("cube", [0.1, 0.05, 0.0999])] if contacts else [FLOOR]
    simulation = start([SHAKE], bodies)
    for instant in (0.0, 0.0437, 0.1023, 0.2):  # across blocks of steps too
        simulation.advance(instant)
        now = simulation.snapshot()
        s, c = np.sin(W * now.time), W * np.cos(W * now.time)
        angle = 0.02 * s
        arm = np.array(
            [-np.cos(angle) - 0.1 * np.sin(angle), 0, np.sin(angle) - 0.1 * np.cos(angle)]
        )
        place = np.array([1.0 + 0.01 * s, 0.0, 0.005 * s]) + arm
        spin = np.array([0.0, 0.02 * c, 0.0])
        velocity = np.array([0.01 * c, 0.0, 0.005 * c]) + np.cross(spin, arm)
        assert now.position[0] == pytest.approx(place, abs=1e-13)
        assert now.velocity[0] == pytest.approx(velocity, abs=1e-12)
        assert now.spin[0] == pytest.approx(spin, abs=1e-12)
        turn = [np.cos(angle / 2), 0.0, np.sin(angle / 2), 0.0]
        assert now.orientation[0] == pytest.approx(turn, abs=1e-14)


def test_ball_on_a_spinning_plate_feels_the_speed_of_the_plate_under_it():
    # far below the cap of friction the tangential force is the spring's: kt times the slip
    spin = {"kind": "constant", "bodies": ["plate"], "spin": [0.0, 0.0, 0.3], "start": 0.05}
    ball = free("ball", [0.5, 0.0, 0.0999])
    dt = 1e-5
    simulation = start([spin], [FLOOR, ball], dt=dt, law={**LAW, "kt": 1e3, "mu": 1e3})
    simulation.advance(0.05)
    simulation.advance(0.05 + 20 * dt)
    now = simulation.snapshot(contacts=True)
    expected = 1e3 * 0.3 * 0.5 * 20 * dt
    assert np.abs(now.contacts.tangential_force[0]) == pytest.approx(
        [0, expected, 0], rel=1e-2, abs=1e-6
    )
    assert now.velocity[1, 1] > 0.0


def test_wall_that_follows_a_force_swings_on_a_contact_with_its_period():
    # wall of mass M on a ball that rests on the floor: two springs kn in series, the ball light
    mass, kn, force = 200.0, 1e5, -300.0
    lid = {**GROUND, "name": "lid", "position": [0.0, 0.0, 0.3]}
    ball = {**free("ball", [0.0, 0.0, 0.1]), "density": 1e-3}
    control = {"kind": "control", "bodies": ["lid"], "force": {"z": force}, "mass": mass}
    law = {"kn": kn, "kt": 0.0, "mu": 0.0, "en2": 1.0}
    simulation = start([control], [FLOOR, lid, ball], law=law, gravity=0.0, dt=2e-6)
    omega = np.sqrt(0.5 * kn / mass)
    for part in (0.13, 0.37, 0.81):
        simulation.advance(part * 2 * np.pi / omega)
        now = simulation.snapshot()
        sunk = force / (0.5 * kn) * (1.0 - np.cos(omega * now.time))
        assert now.position[1, 2] - 0.3 == pytest.approx(sunk, rel=1e-3, abs=1e-6)
        speed = force / (0.5 * kn) * omega * np.sin(omega * now.time)
        assert now.velocity[1, 2] == pytest.approx(speed, rel=5e-3, abs=2e-4)


def test_free_wall_accelerates_with_its_mass_and_damping():
    control = {"kind": "control", "bodies": ["plate"], "force": {"x": 50.0}, "mass": 2.0}
    simulation = start([{**control, "damping": 3.0, "velocity": {"y": 0.1}}], [FLOOR])
    simulation.advance(1.0)
    now = simulation.snapshot()
    rate = 3.0 / 2.0
    assert now.velocity[0, 0] == pytest.approx(50.0 / 3.0 * (1.0 - np.exp(-rate)), rel=1e-8)
    away = 50.0 / 3.0 * (1.0 - (1.0 - np.exp(-rate)) / rate)
    assert now.position[0] == pytest.approx([away, 0.1, -0.1], rel=1e-8)


def test_moment_turns_a_wall_with_its_own_inertia():
    control = {"kind": "control", "bodies": ["plate"], "moment": {"z": 30.0}}
    simulation = start([control], [FLOOR])
    simulation.advance(0.5)
    now = simulation.snapshot()
    shape = simulation.polyhedra["plate"]
    rate = 30.0 / (1000.0 * shape.volume * shape.inertia_over_mass[2])
    assert now.spin[0] == pytest.approx([0.0, 0.0, 0.5 * rate], rel=1e-9)
    angle = 0.5 * rate * 0.25
    assert now.orientation[0, 3] == pytest.approx(np.sin(angle / 2), rel=1e-9)


def test_wall_outside_its_time_is_held_and_a_ramp_is_followed():
    control = {"kind": "control", "bodies": ["plate"], "force": {"x": 1.0}, "mass": 1.0}
    ramp = [[0.0, 0.0], [1.0, 10.0]]
    simulation = start([{**control, "start": 0.2, "stop": 0.6, "ramp": ramp}], [FLOOR], dt=1e-3)
    simulation.advance(0.2)
    assert simulation.snapshot().position[0, 0] == 0.0
    simulation.advance(0.5)
    now = simulation.snapshot()
    assert now.velocity[0, 0] == pytest.approx(5.0 * (0.5**2 - 0.2**2), rel=1e-6)
    simulation.advance(0.7)
    there = simulation.snapshot()
    assert there.velocity[0, 0] == 0.0
    away = 5.0 / 3.0 * (0.6**3 - 0.2**3) - 5.0 * 0.04 * 0.4
    assert there.position[0, 0] == pytest.approx(away, rel=1e-3)


def box_of_walls(**keys):
    """A floor, a lid and four sides around one cube each of whose faces meets a wall."""
    side = {**keys, "shape": "side", "group": "wall", "fixed": True, "density": 1000.0}
    turn = [np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]
    return [
        FLOOR,
        {**GROUND, "name": "lid", "position": [0.0, 0.0, 0.3]},
        {**side, "name": "west", "position": [-0.2, 0.0, 0.0]},
        {**side, "name": "east", "position": [0.2, 0.0, 0.0]},
        {**side, "name": "south", "position": [0.0, -0.2, 0.0], "orientation": turn},
        {**side, "name": "north", "position": [0.0, 0.2, 0.0], "orientation": turn},
        free("cube", [0.0, 0.0, 0.1]),
    ]


PRESSURES = [
    {"kind": "pressure", "bodies": ["lid"], "axis": "z", "sign": -1, "pressure": 4e3, "mass": 20.0,
     "damping": 4e3, "between": [["west", "east"], ["north", "south"]]},
    {"kind": "pressure", "bodies": ["east"], "axis": "x", "sign": -1, "pressure": 3e3, "mass": 20.0,
     "damping": 4e3, "between": [["plate", "lid"], ["south", "north"]]},
]  # fmt: skip


def test_pressed_walls_come_to_rest_where_contacts_carry_pressure_times_area():
    simulation = start(PRESSURES, box_of_walls(), gravity=0.0, law={**LAW, "mu": 0.0})
    simulation.advance(0.5)
    now = simulation.snapshot()
    x, z = now.position[3, 0] - now.position[2, 0] - 0.2, now.position[1, 2] + 0.1 - 0.2
    assert x < 0.1999
    assert z < 0.1999
    y = 0.2
    assert now.force[1, 2] == pytest.approx(4e3 * x * y, rel=1e-6)
    assert now.force[3, 0] == pytest.approx(3e3 * z * y, rel=1e-6)
    assert now.velocity == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    "driver",
    [
        # both start smoothly: a jump of the velocity has an error of first order, once
        {
            "kind": "expression",
            "x": "0.02 * (1 - cos(2 * pi * 3 * t))",
            "z": "0.002 * (1 - cos(2 * pi * 5 * t))",
            "ry": "0.003 * (1 - cos(2 * pi * 4 * t))",
        },
        {
            "kind": "control",
            "force": {"z": 600.0, "x": 5.0},
            "moment": {"y": 3.0},
            "mass": 60.0,
            "damping": 50.0,
            "ramp": [[0.0, 0.0], [0.02, 1.0]],
        },
    ],
    ids=["imposed", "follows a force"],
)
def test_work_of_drivers_closes_the_energy_account_to_second_order(driver):
    overlap = 20.0 * 9.81 * 0.4 / 4.0 / 1e5  # about that of a cube of 8 kg on four corners
    cube = free("cube", [0.1, 0.05, 0.1 - overlap])
    errors = []
    for dt in (1e-4, 2.5e-5):
        simulation = start([{**driver, "bodies": ["plate"]}], [FLOOR, cube], dt=dt)
        simulation.advance(0.2)
        energy = simulation.snapshot().energy
        errors.append(abs(energy.balance / energy.work))
    assert energy.work > 0.1
    assert errors[1] < errors[0] / 8.0
    assert errors[1] < 1e-6


def everything():
    """A shaken, force-controlled and pressed run, cubes in motion."""
    bodies = box_of_walls()
    bodies += [free("cube", [0.05, 0.03 * k, 1.0 + 0.25 * k]) for k in range(3)]
    bodies += [{**GROUND, "name": "anvil", "position": [0.0, 0.0, 0.75]}]
    shake = {**SHAKE, "bodies": ["anvil"]}
    turn = {"kind": "control", "bodies": ["anvil"], "moment": {"z": 5.0}, "force": {"y": 20.0}}
    del shake["rotation"], shake["point"]
    return [*PRESSURES, shake, turn], bodies


def state(simulation):
    now = simulation.snapshot()
    return [getattr(now, name) for name in ("position", "orientation", "velocity", "spin", "work")]


def test_driven_run_resumes_bitwise():
    drivers, bodies = everything()
    whole, first, resumed = (start(drivers, bodies) for _ in range(3))
    whole.advance(0.25)
    first.advance(0.1337)
    resumed.restore(first.checkpoint())
    assert all(map(np.array_equal, state(first), state(resumed)))
    resumed.advance(0.25)
    assert all(map(np.array_equal, state(whole), state(resumed)))
    assert whole.snapshot().energy == resumed.snapshot().energy


def test_driven_run_is_the_same_for_two_threads(monkeypatch):
    monkeypatch.setattr("warpdem.simulation.CREW_BODIES", 2)
    monkeypatch.setattr("warpdem.crews.WORTH", 1e9)  # two, though one be faster
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    drivers, bodies = everything()
    one, two = (start(drivers, bodies, threads=threads) for threads in (1, 2))
    one.advance(0.15)
    two.advance(0.15)
    assert two.report()["cycles_by_threads"][2] > 0
    assert all(map(np.array_equal, state(one), state(two)))


def test_light_wall_bounds_the_step():
    drivers, bodies = everything()
    heavy = start(drivers, bodies)
    light = start(
        [{**driver, "mass": 1.0} if "mass" in driver else driver for driver in drivers], bodies
    )
    assert light.step_bound() < 0.8 * heavy.step_bound()


def test_run_writes_force_and_work_of_its_drivers(tmp_path):
    drivers, bodies = everything()
    scene = start(drivers, bodies, duration=0.02).scene
    assert run(scene, tmp_path / "run", threads=1, quiet=True) == 0
    table = np.genfromtxt(tmp_path / "run" / "drivers.csv", delimiter=",", names=True, dtype=None)
    assert table["name"][:3].tolist() == ["lid", "east", "anvil"]
    last = table[-3:]
    whole = Simulation(scene, device="cpu", threads=1)
    whole.advance(0.02)
    now = whole.snapshot()
    place = [whole.placement.names.index(name) for name in last["name"]]
    assert last["z"] == pytest.approx(now.position[place, 2], abs=0.0)
    assert last["fz"] == pytest.approx(now.force[place, 2], abs=0.0)
    assert last["work"] == pytest.approx(now.work[place], abs=0.0)
