"""Runs where pybullet is: cubes among planes, implicit impulses; prints a line of JSON.

Sequential impulses with its default of 50 iterations, no restitution, no damping in the air. Its
boxes keep their size, with a collision margin inside.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np
import pybullet

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
half = 0.5 * problem["solid"]["size"]

pybullet.connect(pybullet.DIRECT)
pybullet.setGravity(*problem["gravity"])
pybullet.setTimeStep(problem["dt"])
contact = {"lateralFriction": problem["law"]["mu"], "restitution": 0.0}
for wall in problem["walls"]:
    shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=wall["normal"])
    body = pybullet.createMultiBody(0.0, shape, basePosition=wall["point"])
    pybullet.changeDynamics(body, -1, **contact)
box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[half] * 3)
cubes = []
for place, (w, x, y, z) in zip(problem["position"], problem["orientation"], strict=True):
    body = pybullet.createMultiBody(
        problem["mass"], box, basePosition=place, baseOrientation=[x, y, z, w]
    )
    pybullet.changeDynamics(body, -1, linearDamping=0.0, angularDamping=0.0, **contact)
    cubes.append(body)


def advance(steps):
    """So many steps; the wall clock's and CPU time's seconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    for _ in range(steps):
        pybullet.stepSimulation()
    return time.perf_counter() - wall, time.process_time() - cpu


advance(problem["warm"])
wall_time, cpu_time = advance(problem["steps"])
velocity = np.array([pybullet.getBaseVelocity(cube)[0] for cube in cubes])
heights = [pybullet.getBasePositionAndOrientation(cube)[0][2] for cube in cubes]
print(
    json.dumps(
        {
            "wall": wall_time,
            "cpu": cpu_time,
            "steps": problem["steps"],
            "bodies": len(cubes),
            "contacts": len(pybullet.getContactPoints()),
            "height": float(np.mean(heights)),
            "speed_rms": float(np.sqrt((velocity**2).sum(axis=1).mean())),
        }
    )
)
