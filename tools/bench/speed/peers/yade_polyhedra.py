"""Runs inside YADE: cubes among walls, forces from overlap volumes; prints a line of JSON.

The volumetric law of its manual with a stiffness per volume that gives a face as much as our four
corners, and the numerical damping of its examples (.3), for the law has no dashpot. Cubes are
sharp there.
"""

import json
import sys
import time
from itertools import product
from math import atan
from pathlib import Path

import yade
from yade import polyhedra_utils, utils, wrapper

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
size = problem["solid"]["size"]
world = yade.O


def build():
    """Bodies, walls and engines."""
    stone = wrapper.PolyhedraMat(
        density=problem["mass"] / size**3,
        young=4.0 * problem["law"]["kn"] / size**2,
        poisson=problem["law"]["kt"] / problem["law"]["kn"],
        frictionAngle=atan(problem["law"]["mu"]),
    )
    corners = [[size * (k - 0.5) for k in corner] for corner in product((0, 1), repeat=3)]
    for place, (w, x, y, z) in zip(problem["position"], problem["orientation"], strict=True):
        cube = polyhedra_utils.polyhedra(stone, v=corners)
        turn = yade.Quaternion(w, x, y, z)
        cube.state.pos, cube.state.ori = place, turn * cube.state.ori
        world.bodies.append(cube)
    for wall in problem["walls"]:
        axis = next(k for k in range(3) if wall["normal"][k])
        sense = int(wall["normal"][axis])
        world.bodies.append(utils.wall(wall["point"][axis], axis=axis, sense=sense, material=stone))
    world.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider([wrapper.Bo1_Polyhedra_Aabb(), wrapper.Bo1_Wall_Aabb()]),
        wrapper.InteractionLoop(
            [
                wrapper.Ig2_Wall_Polyhedra_PolyhedraGeom(),
                wrapper.Ig2_Polyhedra_Polyhedra_PolyhedraGeom(),
            ],
            [wrapper.Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
            [wrapper.Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
        ),
        wrapper.NewtonIntegrator(gravity=problem["gravity"], damping=0.3),
    ]
    world.dt = problem["dt"]


build()
world.run(max(problem["warm"], 1), True)
wall_time, cpu_time = time.perf_counter(), time.process_time()
world.run(problem["steps"], True)
wall_time, cpu_time = time.perf_counter() - wall_time, time.process_time() - cpu_time
cubes = [world.bodies[k].state for k in range(len(problem["position"]))]
speeds = [cube.vel.squaredNorm() for cube in cubes]
print(
    json.dumps(
        {
            "wall": wall_time,
            "cpu": cpu_time,
            "steps": problem["steps"],
            "bodies": len(cubes),
            "contacts": sum(i.isReal for i in world.interactions),
            "height": sum(cube.pos[2] for cube in cubes) / len(cubes),
            "speed_rms": (sum(speeds) / len(speeds)) ** 0.5,
        }
    )
)
