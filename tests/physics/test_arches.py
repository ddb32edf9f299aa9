"""Semicircular arches of ten voussoirs: they stand and fall where limit analysis says."""

import pytest
from arches import Arch, thrust_bounds

COUNT = 10
FRICTION = 0.381386275
"""Least friction of ten voussoirs of thickness .12 R: linear program of statics, corner forces
that push and stay within the cone of friction (Livesley 1978, doi:10.1002/nme.1620121207)."""


def least_thickness(count):
    """Of an arch that stands, over its radius: least and largest thrust are the same."""
    low, high = 0.05, 0.2
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        least, largest = thrust_bounds(middle, 0.0, count)
        low, high = (middle, high) if least > largest else (low, middle)
    return low


def test_least_thickness_is_that_of_milankovitch():
    assert least_thickness(COUNT) == pytest.approx(0.1074601099, abs=1e-9)


def test_arch_a_little_thicker_than_the_least_stands():
    thickness = 1.04 * least_thickness(COUNT)
    arch = Arch(count=COUNT, thickness=thickness, mu=2.0).watch(3.0)
    assert arch.moved() < 1e-4
    assert arch.kinetic() < 1e-7
    least, largest = thrust_bounds(thickness, 0.0, COUNT)
    assert least - 1e-3 < arch.thrust() < largest + 1e-3


def test_arch_a_little_thinner_than_the_least_falls_by_hinges_at_its_haunches():
    arch = Arch(count=COUNT, thickness=0.96 * least_thickness(COUNT), mu=2.0).watch(3.0)
    assert arch.sunk() > 0.05
    assert arch.haunch() == pytest.approx(54.0)


def test_arch_on_a_little_more_than_the_least_friction_stands():
    arch = Arch(count=COUNT, thickness=0.12, mu=1.05 * FRICTION).watch(3.0)
    assert arch.moved() < 1e-3
    assert arch.kinetic() < 1e-7


def test_arch_on_less_than_the_least_friction_slides_down():
    arch = Arch(count=COUNT, thickness=0.12, mu=0.9 * FRICTION).watch(3.0)
    assert arch.sunk() > 0.05
