"""Stand-ins for the simulation and its shapes: cubes in free fall, without Warp."""

from types import SimpleNamespace

import numpy as np

from warpdem.snapshot import Contacts, Energy, Snapshot

SCENE = """
title = "falling"
run = {duration = 1.0, dt = 0.01}
shape = [{name = "cube", kind = "box", size = [1.0, 1.0, 1.0]}]
body = [
    {shape = "cube", position = [0.0, 0.0, 0.0], density = 2.0},
    {shape = "cube", position = [3.0, 0.0, 0.0], density = 2.0, scale = 0.5},
    {shape = "cube", position = [0.0, 0.0, -50.0], fixed = true},
]
contact = [{groups = ["default", "default"], kn = 1e4, kt = 1e4, en2 = 0.5, mu = 0.5}]
output = {every = 0.1, table = true, contacts = true}
"""

CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
DT = 0.01


def cube(name="cube", frame_rotation=(1.0, 0.0, 0.0, 0.0)):
    surface = SimpleNamespace(
        points=CORNERS,
        connectivity=np.ravel(SIDES),
        offsets=np.arange(0, 25, 4),
    )
    return SimpleNamespace(
        name=name,
        surface=surface,
        volume=1.0,
        inertia_over_mass=np.full(3, 1.0 / 6.0),
        bound=0.75**0.5,
        frame_rotation=np.array(frame_rotation),
        notes=(),
        analytic=None,
    )


def placement(position, *, scale=1.0, fixed=False):
    position = np.array(position, float)
    count = len(position)
    return SimpleNamespace(
        shape=np.zeros(count, np.int32),
        scale=np.broadcast_to(scale, count).astype(float),
        position=position,
        velocity=np.zeros((count, 3)),
        spin=np.zeros((count, 3)),
        group=np.zeros(count, np.int32),
        cluster=np.arange(count, dtype=np.int32),
        density=np.full(count, 2.0),
        fixed=np.broadcast_to(fixed, count),
        groups=("default",),
    )


def contacts(count=1):
    return Contacts(
        bonded=np.zeros(count, dtype=bool),
        bodies=np.tile(np.array([[0, 2]], np.int32), (count, 1)),
        kind=np.full(count, 3, np.int32),
        features=np.zeros((count, 2), np.int32),
        point=np.tile([0.0, 0.0, -0.5], (count, 1)),
        normal=np.tile([0.0, 0.0, 1.0], (count, 1)),
        gap=np.full(count, -1e-3),
        normal_force=np.full(count, 5.0),
        tangential_force=np.tile([1.0, 0.0, 0.0], (count, 1)),
        moment=np.zeros((count, 3)),
    )


def snapshot(position, *, orientation=None, at=0.0, step=0, velocity=None, touching=None):
    position = np.array(position, float)
    count = len(position)
    identity = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    return Snapshot(
        time=at,
        step=step,
        position=position,
        orientation=identity if orientation is None else np.array(orientation, float),
        velocity=np.zeros((count, 3)) if velocity is None else velocity,
        spin=np.full((count, 3), 0.1),
        force=np.full((count, 3), 2.0),
        torque=np.zeros((count, 3)),
        contacts=touching,
        energy=Energy(
            kinetic=1.0 / 3.0,
            potential=at,
            elastic=0.0,
            dashpot=0.0,
            friction=0.0,
            rolling=0.0,
            work=0.0,
            external=0.0,
            balance=1e-17,
            contact_count=step,
            largest_overlap=0.0,
        ),
    )


class Falling:
    """The interface of ``Simulation``; ``on_step`` is called after each step."""

    @staticmethod
    def on_step(simulation):
        pass

    def __init__(self, scene, *, device=None, threads=None, progress=None):
        self.body_count = len(scene.body)
        self.dt = DT
        self.step_count = 0
        self.polyhedra = {"cube": cube()}
        self.notes = ['fill "none": 0 of 0 fit']
        self.placement = placement(
            [body.position for body in scene.body],
            scale=[body.scale for body in scene.body],
            fixed=[body.fixed for body in scene.body],
        )
        self._position = self.placement.position.copy()
        self._velocity = np.zeros_like(self._position)
        if progress:
            progress("compiling nothing")

    @property
    def time(self):
        return self.step_count * self.dt

    def advance(self, until, *, stop=None):
        while (until - self.time) / self.dt > 0.5:
            free = ~self.placement.fixed
            self._velocity[free, 2] -= 9.81 * self.dt
            self._position += self.dt * self._velocity
            self.step_count += 1
            self.on_step(self)
            if stop and stop():
                return

    def snapshot(self, *, contacts=False):
        return snapshot(
            self._position,
            at=self.time,
            step=self.step_count,
            velocity=self._velocity.copy(),
            touching=globals()["contacts"](self.step_count % 3) if contacts else None,
        )

    def checkpoint(self):
        return {
            "position": self._position.copy(),
            "velocity": self._velocity.copy(),
            "step": np.array(self.step_count),
        }

    def restore(self, state):
        self._position = state["position"].copy()
        self._velocity = state["velocity"].copy()
        self.step_count = int(state["step"])

    def report(self):
        return {
            "features": ["gravity"],
            "stages": ["drift"],
            "rebuilds": 0,
            "candidates": 0,
            "compile_seconds": 0.0,
            "loop_seconds": 0.1,
            "device": "cpu",
            "threads": 1,
        }
