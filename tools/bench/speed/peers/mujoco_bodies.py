"""Runs where mujoco is: cubes among planes, implicit soft constraints; prints a line of JSON.

Newton's solver, implicit integration in velocity, elliptic friction cones, contacts as stiff as the
step allows (time constant of two steps), critically damped. Cubes are sharp there.
"""

import json
import sys
import time
from pathlib import Path

import mujoco
import numpy as np

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
dt, mu, mass = problem["dt"], problem["law"]["mu"], problem["mass"]
half = 0.5 * problem["solid"]["size"]


def row(values):
    """Numbers of an attribute."""
    return " ".join(repr(float(value)) for value in values)


def plane(wall):
    """A fixed half-space."""
    place, normal = row(wall["point"]), row(wall["normal"])
    return f'<geom type="plane" size="0 0 1" pos="{place}" zaxis="{normal}"/>'


def cube(place, turn):
    """A free body."""
    return (
        f'<body pos="{row(place)}" quat="{row(turn)}"><freejoint/>'
        f'<geom type="box" size="{half} {half} {half}" mass="{mass}"/></body>'
    )


bodies = zip(problem["position"], problem["orientation"], strict=True)
model = mujoco.MjModel.from_xml_string(
    f'<mujoco><option timestep="{dt}" integrator="implicitfast" cone="elliptic" '
    f'gravity="{row(problem["gravity"])}"/><size memory="400M"/>'
    f'<default><geom friction="{mu} 0 0" solref="{2.0 * dt} 1"/></default><worldbody>'
    f"{''.join(map(plane, problem['walls']))}{''.join(cube(*each) for each in bodies)}"
    "</worldbody></mujoco>"
)
data = mujoco.MjData(model)
for _ in range(problem["warm"]):
    mujoco.mj_step(model, data)
wall_time, cpu_time = time.perf_counter(), time.process_time()
mujoco.mj_step(model, data, problem["steps"])
wall_time, cpu_time = time.perf_counter() - wall_time, time.process_time() - cpu_time
velocity = data.qvel.reshape(-1, 6)[:, :3]
print(
    json.dumps(
        {
            "wall": wall_time,
            "cpu": cpu_time,
            "steps": problem["steps"],
            "bodies": len(velocity),
            "contacts": int(data.ncon),
            "height": float(data.qpos.reshape(-1, 7)[:, 2].mean()),
            "speed_rms": float(np.sqrt((velocity**2).sum(axis=1).mean())),
        }
    )
)
