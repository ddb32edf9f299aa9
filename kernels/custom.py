"""What the normal force of a contact law sees, and how to write one's own.

In a Python file beside the scene::

    import warp as wp
    from warpdem.kernels.custom import Kinematics, Parameters, Touch, real

    @wp.func
    def hertz(touch: Touch, motion: Kinematics, parameters: Parameters) -> real:
        return parameters[0] * wp.pow(touch.overlap, real(1.5))

and in the scene ``law = "custom", file = "laws.py", normal = "hertz", parameters = [1e9]``. It
gives the force that repels the two bodies [N] (negative attracts; friction is cut by mu times its
positive part). kn bounds the time step: give the largest slope of the force. Its work counts as
dissipated by the dashpot in the energy account, since what is stored is not known.

A custom law has no en2: touch.tau and touch.beta are 0. dt = "auto" knows of kn alone, so that a
dashpot of one's own is not bounded by it: give run.dt. Numbers are written real(1.5): a bare 1.5
is of single precision and does not mix with the others.
"""

import warp as wp
from warpdem.kernels.kinematics import Kinematics
from warpdem.kernels.precision import real, vec3, vec8

Parameters = vec8

__all__ = ["Kinematics", "Parameters", "Touch", "real", "vec3"]


@wp.struct
class Touch:
    """One sub-contact in overlap."""

    overlap: real  # -gap > 0 [m]
    stiffness: real  # w kn [N/m]
    share: real  # w, 1 but for run.partnership [-]
    radius: real  # R of 1/R = 1/R_i + 1/R_j, faces being flat [m]
    mass: real  # m of 1/m = 1/m_i + 1/m_j [kg]
    before: real  # normal force of the last step, 0 if it did not touch [N]
    last: real  # gap of the last step, where a law of the scene keeps it [m]
    tau: real  # time of the dashpot [s]
    beta: real  # implicit share of the dashpot [-]
    fresh: bool  # it did not touch before
    dt: real  # time step [s]
