"""The scarring layer: soil that a rock digs into before it meets the hard ground.

Lu et al. (2019), doi:10.1007/s10346-019-01238-z.
"""

import warp as wp
from warpdem.kernels.fall_views import Rocks
from warpdem.kernels.precision import wide, wide3, wide33
from warpdem.kernels.variant import inlined

# C_f and the density of the soil [kg/m^3]
FRICTION_PART = wp.constant(wide(1.0))
SOIL_DENSITY = wp.constant(wide(1700.0))


@wp.func
def scar_depth(mass: wide, modulus: wide, sinking: wide) -> wide:
    """d_max = 0.1 M^(1/3) M_E^(-0.4) |v_vert|^0.8 of an impact [m]; kg, kN/m^2, m/s.

    No depth without a modulus.
    """
    depth = wide(0.0)
    if modulus > wide(0.0):
        depth = wide(0.1) * wp.cbrt(mass) * wp.pow(modulus, wide(-0.4))
        depth = depth * wp.pow(wp.abs(sinking), wide(0.8))
    return depth


@wp.func
def part_below(a: wide, b: wide, c: wide) -> wide:
    """Part of a triangle's area below zero, whose corners lie at a, b, c above it."""
    low = wp.min(a, wp.min(b, c))
    high = wp.max(a, wp.max(b, c))
    middle = a + b + c - low - high
    part = wide(0.0)
    if high <= wide(0.0):
        part = wide(1.0)
    elif middle <= wide(0.0):
        part = wide(1.0) - high * high / ((high - middle) * (high - low))
    elif low < wide(0.0):
        part = low * low / ((middle - low) * (high - low))
    return part


@inlined()
def frontal_area(
    rocks: Rocks, rock: int, turn: wide33, centre: wide3, plane: wide3, direction: wide3
) -> wide:
    """Area of the immersed surface that looks along ``direction``, projected across it [m^2].

    The ground is the plane of height plane[0] and slopes plane[1], plane[2] under the centre.
    """
    area = wide(0.0)
    for k in range(rocks.facet_count[rock]):
        corner = rocks.facet[rock, k]
        a = turn @ rocks.skin[rock, corner[0]]
        b = turn @ rocks.skin[rock, corner[1]]
        c = turn @ rocks.skin[rock, corner[2]]
        facing = wide(0.5) * wp.dot(wp.cross(b - a, c - a), direction)
        if facing > wide(0.0):
            above = centre[2] - plane[0]
            area += facing * part_below(
                above + a[2] - plane[1] * a[0] - plane[2] * a[1],
                above + b[2] - plane[1] * b[0] - plane[2] * b[1],
                above + c[2] - plane[1] * c[0] - plane[2] * c[1],
            )
    return area


@wp.func
def soil_drag(coefficient: wide, area: wide, speed: wide, mass: wide) -> wide:
    """1/2 (C_f + C_s) rho A |v| / m: the rate at which the layer slows a rock [1/s]."""
    return wide(0.5) * (FRICTION_PART + coefficient) * SOIL_DENSITY * area * speed / mass
