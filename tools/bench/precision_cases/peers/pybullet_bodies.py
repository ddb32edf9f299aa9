"""Runs where pybullet is: balls or blocks over a plane. Prints JSON.

Sequential impulses, its 50 iterations, restitution at all speeds, no damping in the air.
"""

import json
import sys
import time
from pathlib import Path

import pybullet

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
block = problem.get("block")
gravity = problem.get("gravity") or [0.0, 0.0, -problem["g"]]
pybullet.connect(pybullet.DIRECT)


def build(dt):
    """All bodies over the plane."""
    pybullet.resetSimulation()
    pybullet.setGravity(*gravity)
    pybullet.setTimeStep(dt)
    pybullet.setPhysicsEngineParameter(restitutionVelocityThreshold=0.0)
    kept = 0.0 if block else problem["e"]
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, planeNormal=[0, 0, 1])
    ground = pybullet.createMultiBody(0.0, plane)
    # both products of the two materials
    pybullet.changeDynamics(ground, -1, lateralFriction=1.0, restitution=1.0)
    if block:
        extent = [0.5 * edge for edge in block]
        shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=extent)
    else:
        shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=problem["radius"])
    spins = problem.get("spin") or [[0.0] * 3] * len(problem["position"])
    made = []
    rows = zip(problem["position"], problem["velocity"], spins, strict=True)
    for (x, y, z), velocity, spin in rows:
        place = [x, y, 0.5 * block[2] if block else z]
        body = pybullet.createMultiBody(problem.get("mass", 1.0), shape, basePosition=place)
        keys = {"lateralFriction": problem["mu"], "restitution": kept}
        keys |= {"linearDamping": 0.0, "angularDamping": 0.0}
        pybullet.changeDynamics(body, -1, **keys)
        pybullet.resetBaseVelocity(body, velocity, spin)
        made.append(body)
    return made


found = []
for steps in problem["steps"]:
    bodies = build(problem["until"] / steps)
    begin = time.process_time()
    for _ in range(steps):
        pybullet.stepSimulation()
    spent = time.process_time() - begin
    motions = [pybullet.getBaseVelocity(body) for body in bodies]
    places = [pybullet.getBasePositionAndOrientation(body)[0] for body in bodies]
    row = {"steps": steps, "seconds": spent, "position": places}
    row |= {"velocity": [v for v, _ in motions], "spin": [w for _, w in motions]}
    found.append(row)
print(json.dumps(found))
