"""Runs where mujoco is: balls or blocks over a plane. Prints JSON.

Implicit in velocity, elliptic cones, Newton's solver. Balls: contacts are given stiffness and
damping by themselves, so that they rebound as asked; blocks: as stiff as the step allows.
"""

import json
import sys
import time
from math import sqrt
from pathlib import Path

import mujoco
import numpy as np

problem = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
block = problem.get("block")
count = len(problem["position"])
gravity = problem.get("gravity") or [0.0, 0.0, -problem["g"]]


def row(values):
    """Numbers of an attribute."""
    return " ".join(repr(float(value)) for value in values)


def geometry():
    """Of a body, and how contacts answer."""
    if block:
        size = row(0.5 * np.array(block))
        return f'type="box" size="{size}" mass="{problem["mass"]}"', None
    damping = 2.0 * problem["zeta"] * sqrt(problem["kn"])
    kind = f'type="sphere" size="{problem["radius"]}" mass="1"'
    return kind, f'solref="{-problem["kn"]} {-damping}" solimp=".9999 .9999 .001"'


def model_of(dt):
    """All bodies over the plane; they do not meet each other."""
    kind, answer = geometry()
    answer = answer or f'solref="{2.0 * dt} 1"'
    low = 0.5 * block[2] if block else None
    bodies = "".join(
        f'<body pos="{row([x, y, low if block else z])}"><freejoint/>'
        f'<geom {kind} contype="0" conaffinity="1"/></body>'
        for x, y, z in problem["position"]
    )
    return mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{dt}" integrator="implicitfast" cone="elliptic" '
        f'gravity="{row(gravity)}"/><size memory="400M"/>'
        f'<default><geom condim="3" friction="{problem["mu"]} 0 0" {answer}/></default><worldbody>'
        f'<geom type="plane" size="0 0 1" contype="1" conaffinity="0"/>{bodies}'
        "</worldbody></mujoco>"
    )


found = []
for steps in problem["steps"]:
    model = model_of(problem["until"] / steps)
    data = mujoco.MjData(model)
    motion = data.qvel.reshape(count, 6)
    motion[:, :3] = problem["velocity"]
    if "spin" in problem:
        motion[:, 3:] = problem["spin"]
    begin = time.process_time()
    mujoco.mj_step(model, data, steps)
    spent = time.process_time() - begin
    motion = data.qvel.reshape(count, 6)
    turns = [np.empty(9) for _ in range(count)]
    pose = data.qpos.reshape(count, 7)
    for k in range(count):
        mujoco.mju_quat2Mat(turns[k], pose[k, 3:])
    spin = [turns[k].reshape(3, 3) @ motion[k, 3:] for k in range(count)]
    state = {"position": pose[:, :3], "velocity": motion[:, :3], "spin": np.array(spin)}
    state = {key: value.tolist() for key, value in state.items()}
    found.append({"steps": steps, "seconds": spent} | state)
print(json.dumps(found))
