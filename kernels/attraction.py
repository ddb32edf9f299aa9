"""Attraction of a scene's contacts: in overlap, at a distance, and when it ends."""

import functools

import warp as wp
from warpdem.kernels.codes import kind_of
from warpdem.kernels.cohesion import (
    adhesion,
    at_distance,
    at_distance_energy,
    curvature_radius,
)
from warpdem.kernels.kinematics import Kinematics
from warpdem.kernels.laws import Laws
from warpdem.kernels.normal import onset
from warpdem.kernels.precision import real, wide, wide4
from warpdem.kernels.variant import inlined
from warpdem.kernels.views import Candidates, Geometry, Material


@functools.cache
def attraction(laws: Laws) -> wp.Function:
    """Function of the pull of a sub-contact in overlap, and of its potential [N, J]."""

    @wp.func
    def attraction(law: Material, gap: real, radius: real, lasted: real):
        pull = real(0.0)
        energy = real(0.0)
        constant = law.fc
        if wp.static(laws.reaching):
            if law.dncut > real(0.0):
                # it was there before they touched
                constant = real(0.0)
                if wp.static(laws.documented):
                    energy = at_distance_energy(law.fc, real(0.0), law.dncut)
                else:
                    pull = law.fc
                    energy = at_distance_energy(law.fc, gap, law.dncut)
        if wp.static(laws.adhesion):
            constant += adhesion(radius, law.gamma)
        pull += constant * lasted
        return pull, energy + constant * gap

    return attraction


@functools.cache
def forget(laws: Laws) -> wp.Function:
    """Function that ends a contact, and tells the energies its springs give up [J]."""

    @inlined()
    def forget(candidates: Candidates, law: Material, c: int):
        account = wide4()
        if wp.static(laws.account):
            past = candidates.past[c]
            share = real(1.0)
            if wp.static(laws.moving):
                share = candidates.share[c]
            if law.kt > real(0.0) and share > real(0.0):
                held = past[0] * past[0] + past[1] * past[1] + past[2] * past[2]
                account[2] = held / wide(real(2.0) * law.kt * share)
            if wp.static(laws.rolling):
                if law.kr > real(0.0) and share > real(0.0):
                    rolled = candidates.rolled[c]
                    account[3] = wp.dot(rolled, rolled) / wide(real(2.0) * law.kr * share)
        candidates.past[c] = wide4(wide(0.0), wide(0.0), wide(0.0), wide(-1.0))
        if wp.static(laws.rolling):
            candidates.rolled[c] = wide4()
        return account

    return forget


@functools.cache
def apart(laws: Laws) -> wp.Function:
    """Function of two features that do not touch: attraction at a distance, or just ended."""
    end = forget(laws)

    @inlined()
    def apart(
        geometry: Geometry,
        candidates: Candidates,
        law: Material,
        i: int,
        j: int,
        c: int,
        gap: real,
        motion: Kinematics,
        dt: real,
    ):
        pull = real(0.0)
        touched = candidates.past[c][3] >= wide(0.0)
        account = end(candidates, law, c)
        constant = law.fc
        if wp.static(laws.reaching):
            if law.dncut > real(0.0):
                constant = real(0.0)
                if gap < law.dncut:
                    pull = -at_distance(law.fc, gap, law.dncut)
                    account[0] = wide(at_distance_energy(law.fc, gap, law.dncut))
        if wp.static(laws.sticky):
            if touched:
                if wp.static(laws.adhesion):
                    kind = kind_of(candidates.code[c])
                    radius = curvature_radius(kind, geometry.radius[i], geometry.radius[j])
                    constant += adhesion(radius, law.gamma)
                # it acted before the gap opened, and half a step of it has been paid
                lasted = real(1.0) - onset(gap, -motion.approach, dt)
                pull += constant * (lasted - real(0.5))
        return pull, account

    return apart
