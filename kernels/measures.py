"""What is measured on the device: the stiffness that bounds the time step."""

import functools
from typing import Any

import warp as wp
from warpdem.kernels.cell import real_vector
from warpdem.kernels.incidence import pair_at, pairs_of
from warpdem.kernels.precision import mat66, real, vec3, vec6, wide, wide3
from warpdem.kernels.variant import variant
from warpdem.kernels.views import Bodies, Candidates, Cell, Incidence, Inertia, Material, Pairs


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


@wp.func
def pressed(
    b: mat66,
    arm: vec3,
    n: vec3,
    kn: real,
    kt: real,
    kr: real,
    inverse_mass: real,
    inverse_moment: vec3,
) -> mat66:
    """``b`` with the mass-scaled stiffness of one more contact or bond: I kt + n n (kn - kt), kr.

    Arm and unit normal in the principal frame.
    """
    for axis in range(3):
        e = vec3()
        e[axis] = real(1.0)
        row = direction(e, arm, inverse_mass, inverse_moment)
        b += wp.outer(row, row) * kt
        b[3 + axis, 3 + axis] += kr * inverse_moment[axis]
    row = direction(n, arm, inverse_mass, inverse_moment)
    return b + wp.outer(row, row) * wp.max(kn - kt, real(0.0))


@wp.func
def largest_eigenvalue(b: Any) -> real:
    """Upper bound for a symmetric matrix without negative eigenvalues: trace(b^8)^(1/8)."""
    size = wp.trace(b)
    if size == real(0.0):
        return real(0.0)
    b = b / size
    b = b * b
    b = b * b
    b = b * b
    return size * wp.sqrt(wp.sqrt(wp.sqrt(wp.trace(b))))


@functools.cache
def frequency_bound(partnership: str, *, periodic: bool) -> wp.Kernel:
    """Kernel of a bound of each body's highest frequency."""

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
        cell: Cell,
        # out
        square: wp.array(dtype=real),
    ):
        """Upper bound of the square of the highest frequency that each body takes part in [1/s^2].

        B = sum phi K, 6x6, phi = 2 where both bodies move.
        """
        body = wp.tid()
        inverse_mass = real(inertia.inverse_mass[body])
        square[body] = real(0.0)
        if inverse_mass == real(0.0):
            return
        inverse_moment = vec3(inertia.inverse_moment[body])
        inverse = wp.transpose(bodies.rotation[body])
        b = mat66()
        first, others, count = pairs_of(incidence, body)
        for k in range(count):
            code = pair_at(incidence, body, first, others, k)
            pair = code >> 1
            law = materials[pairs.material[pair]]
            i = pairs.owner[pair]
            j = pairs.partner[pair]
            away = wide3()
            if (code & 1) == 0:
                away = bodies.position[j] - bodies.position[i]
                if wp.static(periodic):
                    away += cell.edges[0] * real_vector(pairs.image[pair])
            shift = vec3(away)
            phi = real(1.0)
            if inertia.inverse_mass[i] > wide(0.0) and inertia.inverse_mass[j] > wide(0.0):
                phi = real(2.0)
            start = pairs.start[pair]
            for slot in range(start, start + pairs.touching[pair]):
                arm = inverse * (candidates.point[slot] + shift)
                n = inverse * candidates.normal[slot]
                kn = real(law.kn)
                soft = real(1.0)
                if wp.static(partnership != "sum"):
                    soft = candidates.share[candidates.which[slot]]
                    if wp.static(partnership == "once"):
                        soft = wp.max(soft, real(1.0))
                    if wp.static(partnership == "pnorm"):
                        if pairs.touching[pair] > 1:
                            kn *= law.exponent - real(1.0)
                kn *= soft
                kt = law.kt * soft
                kr = law.kr * soft
                b = pressed(b, arm, n, phi * kn, phi * kt, phi * kr, inverse_mass, inverse_moment)
        square[body] = largest_eigenvalue(b)

    return frequency_bound
