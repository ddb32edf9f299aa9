"""Bodies that turn: free of torque, and a top on its tip."""

import functools

import numpy as np
import warp as wp
from warpdem.kernels.precision import quat, wide, wide3
from warpdem.kernels.rotation import free_drift, free_torque, inverse_inertia

from scenes import laboratory, law
from warpdem.geometry.orientation import product, turned


def angle_between(q, other):
    """Angle of the turn between two orientations w, x, y, z [rad]."""
    turn = product(q, np.asarray(other) * np.array([1.0, -1.0, -1.0, -1.0]))
    return 2.0 * np.arctan2(np.linalg.norm(turn[..., 1:], axis=-1), np.abs(turn[..., 0]))


def free_rotor(moments, spin, times, *, dt, **run):
    """Snapshots at ``times`` of a body of mass 1 that starts in its principal axes' orientation."""
    shape = {
        "name": "rotor",
        "kind": "polyhedron",
        "vertices": [[0.0, 0.0, 0.0]],
        "rounding": 0.05,
        "volume": 1.0,
        "inertia_over_mass": list(moments),
    }
    rotor = {
        "shape": "rotor",
        "group": "free",
        "position": [0.0, 0.0, 100.0],
        "density": 1.0,
        "spin": list(spin),
    }
    simulation = laboratory([shape], [rotor], law(1.0), dt=dt, **run)
    shots = []
    for t in times:
        simulation.advance(t)
        shots.append(simulation.snapshot())
    return shots


def principal_momentum(shots, moments):
    """Angular momenta of body 0 in its principal axes, shape [shot_count, 3]."""
    back = np.array([1.0, -1.0, -1.0, -1.0])
    spins = [turned(shot.orientation[0] * back, shot.spin[0]) for shot in shots]
    return np.array(spins) * moments


@functools.cache
def spin_top(drift, torque_of):
    """Kernel of kick-drift-kick of bodies pinned at a point of their third axis; z is up."""

    @wp.kernel(enable_backward=False, module="unique")
    def spin_top(
        moment: wide3,
        weight: wide,  # m g l [N m]
        dt: wide,
        steps: int,
        q: wp.array(dtype=quat),
        momentum: wp.array(dtype=wide3),
    ):
        top = wp.tid()
        down = wide3(wide(0.0), wide(0.0), -weight)
        axis = wide3(wide(0.0), wide(0.0), wide(1.0))
        pose = q[top]
        spun = momentum[top]
        spin = inverse_inertia(pose, moment, spun)
        torque = torque_of(wp.cross(wp.quat_rotate(pose, axis), down), spin, spun)
        for _ in range(steps):
            pose, spun = drift(pose, spun, torque, moment, dt)
            spin = inverse_inertia(pose, moment, spun)
            torque = torque_of(wp.cross(wp.quat_rotate(pose, axis), down), spin, spun)
            spun = spun + torque * (wide(0.5) * dt)
        q[top] = pose
        momentum[top] = spun

    return spin_top


def heavy_top(*, moments, weight, tilt, spin, times, dt, how=(free_drift, free_torque), copies=1):
    """Orientations w, x, y, z and angular momenta at ``times`` of a top let go with its spin.

    Moments about the pinned point; ``weight`` is m g l [N m]; ``how`` are a drift and a torque of
    kernels.rotation; ``copies`` are run for their cost.
    """
    start = np.array([np.cos(tilt / 2.0), np.sin(tilt / 2.0), 0.0, 0.0])
    axis = np.array([0.0, -np.sin(tilt), np.cos(tilt)])
    pose, spun = quat(*start[[1, 2, 3, 0]]), wide3(*(moments[2] * spin * axis))
    q = wp.array([pose] * copies, dtype=quat, device="cpu")
    momentum = wp.array([spun] * copies, dtype=wide3, device="cpu")
    orientations, momenta, done = [], [], 0
    for t in times:
        steps = round(t / dt) - done
        inputs = [wide3(*moments), weight, dt, steps]
        wp.launch(spin_top(*how), dim=copies, inputs=inputs, outputs=[q, momentum], device="cpu")
        done += steps
        orientations.append(q.numpy()[0, [3, 0, 1, 2]])
        momenta.append(momentum.numpy()[0])
    return np.array(orientations), np.array(momenta)


def euler_zxz(precession, nutation, rotation):
    """Quaternion w, x, y, z of the Euler angles z, x, z."""
    half = 0.5 * np.array([precession, nutation, rotation])
    (a, b, c), (s, t, u) = np.cos(half), np.sin(half)
    first, tilt, own = ([a, 0.0, 0.0, s], [b, t, 0.0, 0.0], [c, 0.0, 0.0, u])
    return product(product(first, tilt), own)
