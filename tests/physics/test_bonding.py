"""The laws of a bond against their formulas, number by number."""

import numpy as np
import pytest
from warpdem.kernels.bonding import (
    BENDING,
    SHEAR,
    TENSION,
    cracking,
    glued,
    glued_across,
    implicit_share,
    leading,
    yielding,
)
from warpdem.kernels.precision import wide, wide3


def numbers(*values):
    return [wide(value) for value in values]


def test_a_bond_pulls_as_it_pushes():
    pulling = glued(*numbers(-50.0, 3.0, -2.0, 0.0, 0.0))

    assert float(pulling) == -56.0


def test_force_of_a_bond_solves_its_implicit_equation():
    elastic, cn, vn, beta, before = 40.0, 3.0, 2.0, 0.25, 10.0
    # vn is predicted with the old force; f = elastic + cn (vn + (before - f) beta / cn)
    f = float(glued(*numbers(elastic, cn, vn, beta, before)))

    assert f == pytest.approx(elastic + cn * (vn + (before - f) * beta / cn), rel=1e-15)


def test_shear_of_a_bond_solves_the_same_equation():
    u, old = wide3(1.0, 2.0, 0.0), wide3(4.0, 0.0, 1.0)
    f = np.array(glued_across(wide3(1.0, 0.0, 2.0), wide(3.0), u, wide(0.5), old))

    expected = np.array([1.0, 0.0, 2.0]) + np.array([3.0, 6.0, 0.0]) + np.array([2.0, 0.0, 0.5])
    assert np.allclose(f, expected / 1.5)


@pytest.mark.parametrize("x", [0.1, 1.0, 30.0])
def test_dashpots_are_stable_however_fast_they_decay(x):
    beta = float(implicit_share(*numbers(0.01 * x, x, 1.0)))

    assert x < 1.0 + 2.0 * beta
    assert beta >= 0.01 * x


def test_yield_surface_is_met_at_each_strength_alone():
    fn0, ft0, m0 = 30.0, 20.0, 5.0
    for fn, ft, moment in ((-fn0, 0.0, 0.0), (0.0, ft0, 0.0), (0.0, 0.0, m0)):
        excess = yielding(*numbers(fn, ft, moment, fn0, ft0, m0, 3.0))
        assert float(excess) == pytest.approx(0.0, abs=1e-15)


def test_yield_surface_adds_powers_and_compression_strengthens():
    excess = yielding(*numbers(15.0, 18.0, 2.0, 30.0, 20.0, 5.0, 2.0))

    assert float(excess) == pytest.approx(0.9**2 + 0.4**2 - 0.5 - 1.0, rel=1e-14)


def test_absent_strengths_never_yield():
    excess = yielding(*numbers(-1e30, 1e30, 1e30, np.inf, np.inf, np.inf, 2.0))

    assert float(excess) == -1.0


@pytest.mark.parametrize(
    ("fn", "ft", "moment", "mode"),
    [(-9.0, 1.0, 1.0, TENSION), (1.0, 9.0, 1.0, SHEAR), (1.0, 1.0, 9.0, BENDING)],
)
def test_the_largest_part_names_the_mode(fn, ft, moment, mode):
    assert int(leading(*numbers(fn, ft, moment, 10.0, 10.0, 10.0, 2.0))) == int(mode)


def test_energies_are_compared_apart_and_together():
    def cracks(stretching, shearing, both):
        return bool(cracking(*numbers(2.0, 3.0, stretching, shearing, both)))

    assert not cracks(np.inf, np.inf, 5.0)
    assert cracks(np.inf, np.inf, 4.9)
    assert cracks(1.9, np.inf, np.inf)
    assert cracks(np.inf, 2.9, np.inf)
