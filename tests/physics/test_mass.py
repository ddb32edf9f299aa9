"""Volume and inertia of rounded solids against integrals over their cross-sections."""

from math import acos, pi, sqrt

import numpy as np
import pytest

from warpdem.geometry.polyhedron import build
from warpdem.geometry.shapes import box


def moments_of_height(a, b, c, r):
    """Volume and integral of z^2 of a box a b c rounded by r, from its sections at heights z.

    The section of the rounding at c/2 + r sin(t) is the face rounded by r cos(t).
    """
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def section(rho):
        return a * b + 2.0 * rho * (a + b) + pi * rho**2

    t = 0.25 * pi * (nodes + 1.0)
    height, thickness = 0.5 * c + r * np.sin(t), 0.25 * pi * weights * r * np.cos(t)
    volume = section(r) * c + 2.0 * np.sum(thickness * section(r * np.cos(t)))
    second = section(r) * c**3 / 12.0
    second += 2.0 * np.sum(thickness * section(r * np.cos(t)) * height**2)
    return volume, second


@pytest.mark.parametrize(
    ("core", "r"),
    [
        ((1.0, 1.0, 1.0), 0.0),
        ((0.2, 0.3, 0.5), 0.02),
        ((1.0, 0.01, 0.01), 0.002),
        ((1.0, 1.0, 0.0), 0.05),
        ((1.0, 0.0, 0.0), 0.1),
        ((0.0, 0.0, 0.0), 0.3),
    ],
)
def test_rounded_box_has_the_mass_of_its_sections(core, r):
    a, b, c = core
    volume, zz = moments_of_height(a, b, c, r)
    xx, yy = moments_of_height(b, c, a, r)[1], moments_of_height(c, a, b, r)[1]
    solid = box("box", np.array(core) + 2.0 * r, r)
    assert solid.volume == pytest.approx(volume, rel=1e-12)
    got = solid.volume * solid.inertia_over_mass
    assert got == pytest.approx([yy + zz, zz + xx, xx + yy], rel=1e-12)


def test_box_given_as_a_convex_solid_has_the_same_mass():
    solid = box("box", (0.24, 0.34, 0.54), 0.02)
    faces = [face.loops[0].tolist() for face in solid.faces]
    again = build(solid.vertices, faces, name="box", radius=0.02)
    assert again.volume == pytest.approx(solid.volume, rel=1e-12)
    assert again.inertia_over_mass == pytest.approx(solid.inertia_over_mass, rel=1e-12)


def test_rounded_tetrahedron_has_the_volume_of_steiners_formula():
    edge, r = 1.0, 0.1
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * edge / sqrt(8.0)
    faces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]
    volume = edge**3 / (6.0 * sqrt(2.0)) + r * sqrt(3.0) * edge**2
    volume += 6.0 * edge * (pi - acos(1.0 / 3.0)) / 2.0 * r**2 + 4.0 / 3.0 * pi * r**3
    solid = build(corners, faces, name="tetra", radius=r)
    assert solid.volume == pytest.approx(volume, rel=1e-12)
