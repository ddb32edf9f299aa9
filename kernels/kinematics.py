"""Motion at a contact point, and the lengths its laws need."""

import functools

import warp as wp
from warpdem.kernels.precision import real, vec3, wide, wide3
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Bodies, Inertia


@wp.struct
class Kinematics:
    """Motion at one contact; approach and sliding are of the owner against the partner."""

    approach: real  # at the half step [m/s]
    approach_end: real  # predicted for the end of the step [m/s]
    sliding: vec3  # at the half step [m/s]
    sliding_end: vec3  # predicted for the end of the step [m/s]
    turn: real  # angle of the frame about its normal over the step [rad]
    spin: vec3  # of the partner relative to the owner, at the half step [rad/s]
    spin_end: vec3  # predicted for the end of the step [rad/s]


@wp.struct
class Flow:
    """Velocity of an image beyond that of its body, where the periodic cell deforms [m/s]."""

    half: wide3  # at the half step
    end: wide3  # predicted for the end of the step


@functools.cache
def kinematics(*, predicted: bool, deforming: bool, central: bool = False) -> wp.Function:
    """Function of the motion at a contact point; ``flow`` is that of the partner's image.

    ``central``: the normal goes through the centres of all bodies that turn, as between spheres;
    then turning does not make them approach.
    """

    @inlined()
    def between_centres(
        bodies: Bodies,
        flow: Flow,
        i: int,
        j: int,
        d: vec3,
        normal: vec3,
        point: vec3,
        dt: real,
    ) -> Kinematics:
        motion = Kinematics()
        # distances of the contact from the centres
        own = wp.dot(d - point, normal)
        other = wp.dot(point, normal)
        moving = bodies.velocity[j] - bodies.velocity[i]
        ending = moving
        if wp.static(predicted):
            ending = bodies.velocity_end[j] - bodies.velocity_end[i]
        if wp.static(deforming):
            moving += flow.half
            ending += flow.end
        relative = vec3(moving)
        end = vec3(ending)
        motion.approach = wp.dot(relative, normal)
        motion.approach_end = wp.dot(end, normal)
        turning = wp.cross(vec3(bodies.spin[j]) * other + vec3(bodies.spin[i]) * own, normal)
        motion.sliding = relative - normal * motion.approach + turning
        motion.spin = vec3(bodies.spin[j] - bodies.spin[i])
        motion.turn = real(0.5) * dt * wp.dot(vec3(bodies.spin[i] + bodies.spin[j]), normal)
        motion.sliding_end = motion.sliding
        motion.spin_end = motion.spin
        if wp.static(predicted):
            turns_j = vec3(bodies.spin_end[j])
            turns_i = vec3(bodies.spin_end[i])
            turning = wp.cross(turns_j * other + turns_i * own, normal)
            motion.sliding_end = end - normal * motion.approach_end + turning
            motion.spin_end = vec3(bodies.spin_end[j] - bodies.spin_end[i])
        return motion

    @inlined()
    def kinematics(
        bodies: Bodies,
        flow: Flow,
        i: int,
        j: int,
        d: vec3,
        normal: vec3,
        point: vec3,
        dt: real,
    ) -> Kinematics:
        arm = point - d
        motion = Kinematics()
        moving = bodies.velocity[j] + wide3(wp.cross(vec3(bodies.spin[j]), point))
        moving -= bodies.velocity[i] + wide3(wp.cross(vec3(bodies.spin[i]), arm))
        if wp.static(deforming):
            moving += flow.half
        relative = vec3(moving)
        motion.approach = wp.dot(relative, normal)
        motion.sliding = relative - normal * motion.approach
        motion.spin = vec3(bodies.spin[j] - bodies.spin[i])
        motion.turn = real(0.5) * dt * wp.dot(vec3(bodies.spin[i] + bodies.spin[j]), normal)
        motion.approach_end = motion.approach
        motion.sliding_end = motion.sliding
        motion.spin_end = motion.spin
        if wp.static(predicted):
            ending = bodies.velocity_end[j] + wide3(wp.cross(vec3(bodies.spin_end[j]), point))
            ending -= bodies.velocity_end[i] + wide3(wp.cross(vec3(bodies.spin_end[i]), arm))
            if wp.static(deforming):
                ending += flow.end
            end = vec3(ending)
            motion.approach_end = wp.dot(end, normal)
            motion.sliding_end = end - normal * motion.approach_end
            motion.spin_end = vec3(bodies.spin_end[j] - bodies.spin_end[i])
        return motion

    return between_centres if central else kinematics


@inlined()
def branch(inertia: Inertia, i: int, j: int, d: vec3, point: vec3) -> real:
    """Branch length: from centre to centre, or from the only free body to the contact [m]."""
    if inertia.inverse_mass[i] == wide(0.0):
        return wp.length(point)
    if inertia.inverse_mass[j] == wide(0.0):
        return wp.length(point - d)
    return wp.length(d)
