"""Attraction between bodies: constant in contact, linear at a distance, or of adhesion.

Symbols: gap dn [m], range dncut [m], strength fc [N]; forces are positive when they repel.
"""

import warp as wp
from warpdem.kernels.codes import FV, VF
from warpdem.kernels.precision import real


@wp.func
def at_distance(fc: real, gap: real, dncut: real) -> real:
    """fc (dn/dncut - 1) for 0 <= dn < dncut [N]: -fc at touch, 0 at the end of its reach."""
    return fc * (gap / dncut - real(1.0))


@wp.func
def at_distance_energy(fc: real, gap: real, dncut: real) -> real:
    """Potential of ``at_distance`` and of -fc in overlap, 0 at dncut [J]."""
    if gap < real(0.0):
        return fc * (gap - real(0.5) * dncut)
    return real(-0.5) * fc * (dncut - gap) * (dncut - gap) / dncut


@wp.func
def documented(gap: real, dncut: real, fc: real, free: real) -> real:
    """The law as exaDEM's page has it, ``free`` = -kn dn + cn vn [N].

    max(-fc, free) down to dn = -dncut, free beyond; it jumps by fc at touch.
    """
    if gap > -dncut:
        return wp.max(-fc, free)
    return free


@wp.func
def curvature_radius(kind: int, radius_i: real, radius_j: real) -> real:
    """R of 1/R = 1/R_i + 1/R_j at a contact, faces being flat [m]."""
    if kind == VF:
        return radius_i
    if kind == FV:
        return radius_j
    return radius_i * radius_j / (radius_i + radius_j)


@wp.func
def adhesion(radius: real, gamma: real) -> real:
    """Pull of two touching bodies, 2 pi R gamma [N].

    Derjaguin, Muller & Toporov (1975), doi:10.1016/0021-9797(75)90018-1.
    """
    return real(2.0 * 3.141592653589793) * radius * gamma
