"""Counting: exact in any order, quantiles within their bins."""

from dataclasses import replace

import numpy as np
import pytest
from fields import flights, site

from warpdem.errors import UnstableError
from warpdem.rockfall.tally import BIN_ERROR, QUANTITIES, UNIT, Tally, total

SITE = site(rows=8, columns=8)
BUNDLES = [flights(40, visits=900, seed=1, first=40 * n, where=SITE) for n in range(7)]


def same(one, other):
    mine, theirs = one.arrays(), other.arrays()
    return all(
        mine[name].dtype == theirs[name].dtype and mine[name].tobytes() == theirs[name].tobytes()
        for name in mine
    )


def samples(bundles):
    """The largest values of each trajectory in each cell, by cell."""
    largest = {}
    for bundle in bundles:
        v = bundle.visits
        values = np.stack([getattr(v, name) for name in QUANTITIES], axis=-1)
        for who, cell, row in zip(v.id, v.cell, values, strict=True):
            old = largest.get((cell, who))
            largest[cell, who] = row if old is None else np.maximum(old, row)
    found = {}
    for (cell, _), row in largest.items():
        found.setdefault(cell, []).append(row)
    return {cell: np.sort(np.array(rows), axis=0) for cell, rows in found.items()}


@pytest.mark.parametrize("seed", range(5))
def test_sums_know_neither_order_nor_grouping_to_the_bit(seed):
    draw = np.random.default_rng(seed)
    parts = [Tally.of(bundle, SITE) for bundle in BUNDLES]
    expected = total(parts)
    while len(parts) > 1:
        a, b = draw.choice(len(parts), 2, replace=False)
        parts = [*(p for n, p in enumerate(parts) if n not in (a, b)), parts[a] + parts[b]]
    assert same(parts[0], expected)


def test_an_empty_tally_is_neutral():
    one = Tally.of(BUNDLES[0], SITE)
    assert same(one + Tally.empty(), one)
    assert same(total([]), Tally.empty())


def test_arrays_return_the_tally():
    one = Tally.of(BUNDLES[0], SITE)
    assert same(Tally.from_arrays(one.arrays() | {"other": np.zeros(1)}), one)


def test_a_trajectory_counts_once_in_each_cell():
    found, tally = samples(BUNDLES), total(Tally.of(b, SITE) for b in BUNDLES)
    known = tally.passages > 0
    assert {*tally.cell[known].tolist()} == {*found}
    for cell, n in zip(tally.cell[known], tally.passages[known], strict=True):
        assert n == len(found[cell])


def test_means_are_exact_to_the_unit_and_the_largest_are_exact():
    found, tally = samples(BUNDLES), total(Tally.of(b, SITE) for b in BUNDLES)
    mean = tally.mean()
    for row in np.flatnonzero(tally.passages):
        exact = found[tally.cell[row]]
        np.testing.assert_allclose(mean[row], exact.mean(0, float), rtol=1e-14, atol=UNIT)
        np.testing.assert_array_equal(tally.largest[row], exact[-1])


def test_quantiles_are_within_half_a_bin_of_the_ordered_samples():
    found, tally = samples(BUNDLES), total(Tally.of(b, SITE) for b in BUNDLES)
    permille = [1, 500, 900, 950, 990, 1000]
    quantiles = tally.quantiles(permille)
    for row in np.flatnonzero(tally.passages):
        exact = found[tally.cell[row]]
        for q, values in zip(permille, quantiles, strict=True):
            expected = exact[-(-q * len(exact) // 1000) - 1]
            np.testing.assert_allclose(values[row], expected, rtol=BIN_ERROR)
            assert (values[row] <= tally.largest[row]).all()


def test_deposits_are_counted_where_trajectories_stop():
    tally = total(Tally.of(b, SITE) for b in BUNDLES)
    stopped = np.concatenate([b.position[np.isin(b.fate, (1, 4))] for b in BUNDLES])
    cells = SITE.results.index(stopped[:, 0], stopped[:, 1])
    assert tally.deposits.sum() == (cells >= 0).sum()
    assert tally.trajectories == 280


def test_a_value_that_is_not_finite_is_told_with_its_trajectory():
    bundle = flights(3, visits=3, where=SITE)
    energy = bundle.visits.energy.copy()
    energy[1] = np.nan
    broken = replace(bundle, visits=replace(bundle.visits, energy=energy))
    with pytest.raises(UnstableError, match=rf"trajectory {bundle.visits.id[1]}: energy nan"):
        Tally.of(broken, SITE)
