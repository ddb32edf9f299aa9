"""Runs inside YADE: spheres and plane walls of a problem; prints a line of JSON.

Hooke with dashpot and Coulomb friction (ViscElPhys, Basic), no other damping. Materials act in
series there, hence the factors. The collider's margin ``verletDist``, when negative, is relative to
the smallest radius.
"""

import json
import sys
import time
from math import atan
from pathlib import Path

import yade
from yade import utils, wrapper

MARGIN = -0.5
"""Its default."""

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
law, radius = problem["law"], problem["solid"]["rounding"]
world = yade.O


def material(dashpot):
    """Of grains or walls."""
    return wrapper.ViscElMat(
        density=problem["density"],
        frictionAngle=atan(law["mu"]),
        kn=2.0 * law["kn"],
        ks=2.0 * law["kt"],
        cn=dashpot,
        cs=0.0,
    )


def build():
    """Bodies, walls and engines."""
    own = 2.0 * problem["dashpot_pair"]
    of_wall = problem["dashpot_wall"]
    grain = world.materials.append(material(own))
    hard = world.materials.append(material(own * of_wall / (own - of_wall)))
    world.bodies.append([utils.sphere(p, radius, material=grain) for p in problem["position"]])
    for wall in problem["walls"]:
        axis = next(k for k in range(3) if wall["normal"][k])
        world.bodies.append(utils.wall(wall["point"][axis], axis=axis, sense=0, material=hard))
    bounds = [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()]
    world.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider(bounds, verletDist=MARGIN),
        wrapper.InteractionLoop(
            [wrapper.Ig2_Sphere_Sphere_ScGeom(), wrapper.Ig2_Wall_Sphere_ScGeom()],
            [wrapper.Ip2_ViscElMat_ViscElMat_ViscElPhys()],
            [wrapper.Law2_ScGeom_ViscElPhys_Basic()],
        ),
        wrapper.NewtonIntegrator(gravity=problem["gravity"], damping=0.0),
    ]
    world.dt = problem["dt"]


def touching():
    """Contacts, and those between two grains."""
    count = len(problem["position"])
    real = [i for i in world.interactions if i.isReal]
    return len(real), sum(i.id1 < count and i.id2 < count for i in real)


build()
world.run(max(problem["warm"], 1), True)
wall_time, cpu_time = time.perf_counter(), time.process_time()
world.run(problem["steps"], True)
wall_time, cpu_time = time.perf_counter() - wall_time, time.process_time() - cpu_time
contacts, pairs = touching()
spent = {"wall": wall_time, "cpu": cpu_time, "steps": problem["steps"]}
found = {"bodies": len(problem["position"]), "contacts": contacts, "pair_contacts": pairs}
print(json.dumps(spent | found | {"kinetic": utils.kineticEnergy()}))
