"""What is measured on the device: the stiffness that bounds the time step."""

import functools

import warp as wp
from warpdem.kernels.precision import mat66, real, vec3, vec6
from warpdem.kernels.variant import variant
from warpdem.kernels.views import Bodies, Candidates, Incidence, Inertia, Material, Pairs


@wp.func
def direction(e: vec3, arm: vec3, inverse_mass: real, inverse_moment: vec3) -> vec6:
    """Mass-scaled row of the contact Jacobian along ``e`` at ``arm``, in the principal frame."""
    turn = wp.cross(arm, e)
    s = wp.sqrt(inverse_mass)
    return vec6(
        e[0] * s,
        e[1] * s,
        e[2] * s,
        turn[0] * wp.sqrt(inverse_moment[0]),
        turn[1] * wp.sqrt(inverse_moment[1]),
        turn[2] * wp.sqrt(inverse_moment[2]),
    )


@functools.cache
def frequency_bound(partnership: str) -> wp.Kernel:
    """Kernel of the bound on each body's frequencies."""

    @variant
    def frequency_bound(
        # model
        inertia: Inertia,
        materials: wp.array(dtype=Material),
        # in
        bodies: Bodies,
        pairs: Pairs,
        candidates: Candidates,
        incidence: Incidence,
        # out
        square: wp.array(dtype=real),
    ):
        """Upper bound of the square of the highest frequency that each body takes part in [1/s^2].

        B = sum phi K, 6x6, phi = 2 where both bodies move; lambda_max(M^-1 B) <= trace(A^8)^(1/8).
        """
        body = wp.tid()
        inverse_mass = inertia.inverse_mass[body]
        square[body] = real(0.0)
        if inverse_mass == real(0.0):
            return
        inverse_moment = inertia.inverse_moment[body]
        inverse = wp.transpose(bodies.rotation[body])
        b = mat66()
        for k in range(incidence.start[body], incidence.start[body + 1]):
            code = incidence.pair[k]
            pair = code >> 1
            law = materials[pairs.material[pair]]
            i = pairs.owner[pair]
            j = pairs.partner[pair]
            shift = vec3()
            if (code & 1) == 0:
                shift = bodies.position[j] - bodies.position[i]
            phi = real(1.0)
            if inertia.inverse_mass[i] > real(0.0) and inertia.inverse_mass[j] > real(0.0):
                phi = real(2.0)
            start = pairs.start[pair]
            for slot in range(start, start + pairs.touching[pair]):
                arm = inverse * (candidates.point[slot] + shift)
                n = inverse * candidates.normal[slot]
                kn = real(law.kn)
                soft = real(1.0)
                if wp.static(partnership != "sum"):
                    soft = candidates.share[candidates.which[slot]]
                    if wp.static(partnership == "pnorm"):
                        if pairs.touching[pair] > 1:
                            kn *= law.exponent - real(1.0)
                kn *= soft
                kt = law.kt * soft
                kr = law.kr * soft
                for axis in range(3):
                    # I kt + n n (kn - kt), as rows along the axes and along n
                    e = vec3()
                    e[axis] = real(1.0)
                    row = direction(e, arm, inverse_mass, inverse_moment)
                    b += wp.outer(row, row) * (phi * kt)
                    b[3 + axis, 3 + axis] += phi * kr * inverse_moment[axis]
                row = direction(n, arm, inverse_mass, inverse_moment)
                b += wp.outer(row, row) * (phi * wp.max(kn - kt, real(0.0)))
        size = wp.trace(b)
        if size > real(0.0):
            b = b / size
            b = b * b
            b = b * b
            b = b * b
            square[body] = size * wp.pow(wp.trace(b), real(0.125))

    return frequency_bound
