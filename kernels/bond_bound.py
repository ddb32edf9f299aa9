"""What the bonds add to the stiffness that bounds the time step."""

import warp as wp
from warpdem.kernels.measures import largest_eigenvalue, pressed
from warpdem.kernels.precision import mat66, real, vec3, wide
from warpdem.kernels.variant import plain
from warpdem.kernels.views import Bodies, Bonds, Inertia, Joints


@plain
def bond_bound(
    # model
    inertia: Inertia,
    joined: Joints,
    # in
    bodies: Bodies,
    bonds: Bonds,
    # in and out
    square: wp.array(dtype=real),
):
    """Add the bound of the bonds to that of the contacts of each body, see frequency_bound [1/s^2].

    The largest eigenvalue of a sum is no larger than the sum of the largest ones.
    """
    body = wp.tid()
    inverse_mass = real(inertia.inverse_mass[body])
    if inverse_mass == real(0.0):
        return
    inverse_moment = vec3(inertia.inverse_moment[body])
    inverse = wp.transpose(bodies.rotation[body])
    b = mat66()
    for m in range(joined.start[body], joined.start[body + 1]):
        code = joined.interface[m]
        k = code >> 1
        if bonds.state[k] != 0:
            law = bonds.law[k]
            i = bonds.owner[k]
            j = bonds.partner[k]
            shift = vec3()
            if (code & 1) == 0:
                shift = vec3(bodies.position[j] - bodies.position[i])
            phi = real(1.0)
            if inertia.inverse_mass[i] > wide(0.0) and inertia.inverse_mass[j] > wide(0.0):
                phi = real(2.0)
            for bond in range(bonds.start[k], bonds.start[k + 1]):
                arm = inverse * (vec3(bonds.point[bond]) + shift)
                n = inverse * vec3(bonds.normal[bond])
                kn = phi * real(law.kn)
                kt = phi * real(law.kt)
                kr = phi * real(law.kr)
                b = pressed(b, arm, n, kn, kt, kr, inverse_mass, inverse_moment)
    square[body] = square[body] + largest_eigenvalue(b)
