"""Runs inside YADE: balls over a plane; blocks are balls that may not turn. Prints JSON.

Hooke with dashpot and Coulomb friction (ViscElPhys, Basic), no other damping; materials act in
series there, hence the factors.
"""

import json
import sys
import time
from math import atan, pi, sqrt
from pathlib import Path

import yade
from yade import utils, wrapper

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
block = problem.get("block")
radius = 0.5 * block[2] if block else problem["radius"]
mass = problem.get("mass", 1.0)
gravity = problem.get("gravity") or [0.0, 0.0, -problem["g"]]
sunk = -mass * gravity[2] / problem["kn"] if block else 0.0
world = yade.O


def build(dt):
    """Bodies and engines."""
    world.reset()
    stone = world.materials.append(
        wrapper.ViscElMat(
            density=mass / (4.0 / 3.0 * pi * radius**3),
            frictionAngle=atan(problem["mu"]),
            kn=2.0 * problem["kn"],
            ks=2.0 * problem["kt"],
            cn=4.0 * problem["zeta"] * sqrt(problem["kn"] * mass),
            cs=0.0,
        )
    )
    spins = problem.get("spin") or [[0.0] * 3] * len(problem["position"])
    rows = zip(problem["position"], problem["velocity"], spins)  # noqa: B905 - its Python may be 3.9
    for place, velocity, spin in rows:
        x, y, z = place
        ball = utils.sphere((x, y, radius - sunk if block else z), radius, material=stone)
        ball.state.vel, ball.state.angVel = velocity, spin
        if block:
            ball.state.blockedDOFs = "XYZ"
        world.bodies.append(ball)
    world.bodies.append(utils.wall(0.0, axis=2, sense=0, material=stone))
    world.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()]),
        wrapper.InteractionLoop(
            [wrapper.Ig2_Sphere_Sphere_ScGeom(), wrapper.Ig2_Wall_Sphere_ScGeom()],
            [wrapper.Ip2_ViscElMat_ViscElMat_ViscElPhys()],
            [wrapper.Law2_ScGeom_ViscElPhys_Basic()],
        ),
        wrapper.NewtonIntegrator(gravity=gravity, damping=0.0),
    ]
    world.dt = dt


found = []
for steps in problem["steps"]:
    build(problem["until"] / steps)
    # of all its threads: the wait for them, which may last 40 ms too long, costs none
    begin = time.process_time()
    world.run(steps, True)
    row = {"steps": steps, "seconds": time.process_time() - begin}
    states = [world.bodies[k].state for k in range(len(problem["position"]))]
    for name, key in (("position", "pos"), ("velocity", "vel"), ("spin", "angVel")):
        row[name] = [list(getattr(state, key)) for state in states]
    found.append(row)
print(json.dumps(found))
